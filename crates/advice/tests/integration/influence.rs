//! Estimated influences against the real ones: an effect that is called negligible must be.

use advice::{Case, advise};
use dynamics::{Drive, DrivenMotion, DrivenSpeed, Effect, EffectMap, History, Initial, Observation};

use crate::plate::{CORNER, clamped, plate, run, spinning};

/// Largest difference of two runs where nothing differs.
const ROUNDING: f64 = 1e-11;

/// Largest relative difference of two motions: of the modal displacements, and of the attitude against the angle turned
/// (up to 1 rad).
fn difference(a: &[Observation], b: &[Observation]) -> f64 {
    let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    let turned = |a: &Observation, b: &Observation| {
        let change = a.attitude.global_to_body() * b.attitude.global_to_body().transpose();
        // Half the distance of the rotation from none: exact where the angle is small.
        (change - nalgebra::Matrix3::identity()).norm() / 2.0_f64.sqrt()
    };
    let size = a.iter().map(|x| norm(&mut x.modal_displacement.iter().copied())).fold(0.0, f64::max);
    let angle = a.iter().map(|x| turned(x, &a[0])).fold(0.0, f64::max).min(1.0);
    let apart = a.iter().zip(b).map(|(x, y)| {
        let mut change = x.modal_displacement.iter().zip(&y.modal_displacement).map(|(x, y)| x - y);
        let modes = norm(&mut change) / size.max(1e-300);
        let attitude = if angle > 1e-9 { (turned(x, y) - 1e-14).max(0.0) / angle } else { 0.0 };
        modes.max(attitude)
    });
    apart.fold(0.0, |largest, x| if x.is_nan() { f64::INFINITY } else { largest.max(x) })
}

fn compare(name: &str, case: &Case) {
    let advice = advise(case, 1e-3).unwrap();
    let on = run(case, EffectMap::all());
    for effect in [Effect::DeformedInertia, Effect::Coriolis, Effect::GeometricStiffening] {
        let real = difference(&on, &run(case, EffectMap::all().without(effect))).min(1.0);
        let row = &advice.effects[effect];
        println!(
            "{name} {}: value {:.2e} estimate {:.2e} real {real:.2e} {}",
            effect.name(),
            row.value,
            row.influence,
            row.why
        );
        assert!(row.influence >= real - ROUNDING, "{name} {}: {} {real}", effect.name(), row.influence);
    }
    let undamped = vec![0.0; case.body.flexible()];
    let real = difference(&on, &run(&Case { damping_ratios: &undamped, ..*case }, EffectMap::all())).min(1.0);
    let row = &advice.effects[Effect::Damping];
    println!("{name} damping: estimate {:.2e} real {real:.2e}", row.influence);
    assert!(row.influence >= real - ROUNDING, "{name} damping: {} {real}", row.influence);
    let largest = |k: usize| on.iter().map(|x| x.modal_displacement[k].abs()).fold(0.0, f64::max);
    for (k, mode) in advice.modes.iter().enumerate() {
        println!("{name} mode {k}: {:.3e} real {:.3e} share {:.1e}", mode.displacement, largest(k), mode.share);
        assert!(mode.displacement >= largest(k) * 0.999, "{name} {k}");
    }
    let spin = on.iter().map(|x| x.omega_body.norm()).fold(0.0, f64::max);
    println!("{name} spin {:.3e} real {spin:.3e}", advice.spin);
    assert!(advice.spin >= 0.99 * spin, "{name}: {} {spin}", advice.spin);
}

fn pulse(size: f64) -> [dynamics::SharedLoad; 1] {
    [plate().force(CORNER, [0.0, 0.0, size], History::HalfSine { start: 0.0, duration: 0.02 })]
}

// Measured, estimate against real, where neither is 1:
// pulse: inertia 5.6e-2 1.9e-4, Coriolis 1.4e-2 3.6e-4, stiffening 5.2e-2 1.0e-5;
// weak: inertia 5.3e-8 4.8e-11, Coriolis 3.6e-8 3.4e-9; damping 0.67 0.25;
// slow spin: inertia 7.53e-2 7.52e-2, Coriolis 3.0e-6 1.7e-6, stiffening 3.3e-4 1.6e-4;
// along: inertia 0.175 0.167, Coriolis 5.3e-2 5.0e-3, stiffening 2.1e-4 8.1e-5;
// gently driven: inertia 4.6e-4 3.8e-6, Coriolis 1.5e-5 2.1e-7, stiffening 2.5e-4 2.3e-5, damping 0.25 0.018.

/// Independent reference: motions with and without the effect.
#[test]
fn estimates_are_above_what_an_effect_does_to_the_paper_s_pulse() {
    for (name, size, end, zeta) in [("pulse", 10.0, 0.2, 0.0), ("weak", 1e-4, 0.1, 0.02), ("faint", 1e-6, 0.05, 0.0)] {
        let (loads, zeta, initial) = (pulse(size), [zeta; 10], Initial::at_rest(10));
        compare(name, &plate().case(&zeta, &loads, &initial, end));
    }
}

/// Independent reference: motions with and without the effect.
#[test]
fn estimates_are_above_what_an_effect_does_to_a_spinning_plate() {
    let zeta = [0.0; 10];
    for (name, omega, q) in [
        ("transverse", [0.0, 10.0, 0.0], 1e-3),
        ("tumbling", [3.0, 8.0, 5.0], 1e-2),
        ("slow", [0.0, 0.0, 0.1], 1e-6),
        ("slower", [0.0, 1e-3, 0.0], 1e-6),
        ("along", [5.0, 0.0, 0.0], 1e-5),
    ] {
        let mut initial = spinning(omega);
        initial.modal_displacement[0] = q;
        initial.modal_displacement[2] = 0.3 * q;
        compare(name, &plate().case(&zeta, &[], &initial, 0.3));
    }
}

/// Independent reference: motions with and without the effect.
#[test]
fn estimates_are_above_what_an_effect_does_in_resonance() {
    let history = History::Sine {
        frequency: plate().body.circular_frequencies[1] / std::f64::consts::TAU,
        phase: 0.0,
        start: 0.0,
        duration: None,
    };
    for (name, zeta, size, omega) in
        [("resonant", 0.01, 1e-3, [0.0, 2.0, 0.0]), ("resonant, free", 0.0, 1e-5, [0.0, 0.0, 0.01])]
    {
        let (loads, zeta, initial) =
            ([plate().force(CORNER, [0.0, size, size], history.clone())], [zeta; 10], spinning(omega));
        compare(name, &plate().case(&zeta, &loads, &initial, 0.3));
    }
}

/// Independent reference: the motion with all modes.
#[test]
fn modes_that_are_not_worth_keeping_can_be_left_out() {
    let (zeta, initial) = ([0.02; 10], Initial::at_rest(10));
    for tolerance in [0.1, 0.02, 5e-3] {
        let loads = [plate().force(CORNER, [0.0, 0.0, 0.01], History::HalfSine { start: 0.0, duration: 0.1 })];
        let case = plate().case(&zeta, &loads, &initial, 0.3);
        let advice = advise(&case, tolerance).unwrap();
        let keep = advice.keep;
        let body = case.body.truncated(keep);
        let start = Initial::at_rest(keep);
        let short =
            Case { body: &body, damping_ratios: &zeta[..keep], initial: &start, peaks: &case.peaks[..keep], ..case };
        let mut rows = run(&short, EffectMap::all());
        rows.iter_mut().for_each(|row| row.modal_displacement.resize(10, 0.0));
        let real = difference(&run(&case, EffectMap::all()), &rows);
        println!("{tolerance}: {keep} modes, {real:.1e}");
        // Measured: 2, 3 and 5 modes; 3.4e-2, 4.7e-3 and 1.5e-3.
        assert!((1..10).contains(&keep) && real <= tolerance, "{tolerance}: {keep} modes, {real}");
    }
}

/// Independent reference: motions with and without the effect.
#[test]
fn estimates_are_above_what_an_effect_does_to_a_driven_plate() {
    let (zeta, initial) = ([0.01; 10], Initial::at_rest(10));
    // Seen from the middle of its clamped end, the plate is turned about its stiff and its weak direction.
    for (name, axis, speed) in [
        ("weak", nalgebra::Vector3::y(), 8.0),
        ("stiff", nalgebra::Vector3::z(), 8.0),
        ("gentle", nalgebra::Vector3::y(), 0.05),
    ] {
        let history = History::Ramp { start: 0.0, duration: 0.1 };
        let drive = Drive {
            motion: DrivenMotion::Turn { axis },
            speed: DrivenSpeed { amplitude: speed, history },
            added: None,
        };
        compare(name, &Case { drive: Some(&drive), ..clamped().case(&zeta, &[], &initial, 0.3) });
    }
}

/// Independent reference: the largest spin of the motion.
#[test]
fn the_spin_of_a_tumbling_plate_is_bounded_closely() {
    let (zeta, initial) = ([0.0; 10], spinning([3.0, 8.0, 5.0]));
    let case = plate().case(&zeta, &[], &initial, 0.3);
    let real = run(&case, EffectMap::all()).iter().map(|x| x.omega_body.norm()).fold(0.0, f64::max);
    let bound = advise(&case, 1e-3).unwrap().spin;
    println!("tumbling {bound} {real}");
    assert!(bound >= real && bound < 1.1 * real, "{bound} {real}");
}
