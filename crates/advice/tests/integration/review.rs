//! Motions against assumptions.

use advice::{Backbone, Broken, Case, Detuning, Refusal, Review, advise};
use dynamics::{Effect, EffectMap, History, Initial, Method, Physics, Reached, Rows, Setup, Simulation, StepControl};

use crate::plate::{CORNER, clamped, plate, run, spinning};

#[test]
fn what_was_assumed_holds_and_what_was_not_is_named_with_its_time() {
    let zeta = [0.0; 10];
    let calm = Initial::at_rest(10);
    let loads = [plate().force(CORNER, [0.0, 0.0, 1.0], History::HalfSine { start: 0.1, duration: 0.02 })];
    let pushed = plate().case(&zeta, &loads, &calm, 0.3);
    let rows = run(&pushed, EffectMap::all());
    let review = |effects, case, advice: &advice::Advice, rows: &[dynamics::Observation]| {
        let mut review = Review::new(case, effects, advice);
        rows.iter().for_each(|row| review.observe(row).unwrap());
        review.broken().to_vec()
    };
    let without = EffectMap::all().without(Effect::Coriolis);
    assert_eq!(review(without, pushed, &advise(&pushed, 1e-3).unwrap(), &rows), []);
    // Advice on the same body without the load: both the spin and the deflection break at the pulse.
    let unpushed = plate().case(&zeta, &[], &calm, 0.3);
    let broken = review(without, pushed, &advise(&unpushed, 1e-3).unwrap(), &rows);
    // With all effects on, nothing rests on the estimates.
    assert_eq!(review(EffectMap::all(), pushed, &advise(&unpushed, 1e-3).unwrap(), &rows), []);
    let spin =
        broken.iter().find_map(|b| if let Broken::Spin { time, found, .. } = b { Some((*time, *found)) } else { None });
    let (time, found) = spin.unwrap();
    assert!((0.1..0.104).contains(&time), "{time}");
    assert_eq!(found, rows.iter().map(|row| row.omega_body.norm()).fold(0.0, f64::max));
    assert!(broken.iter().any(|b| matches!(b, Broken::Deflection { time, .. } if (0.1..0.104).contains(time))));
}

#[test]
fn a_deflection_above_a_tenth_and_a_spin_at_the_limit_are_named() {
    let zeta = [0.0; 10];
    let bare = EffectMap::all().without(Effect::GeometricStiffening);
    // Without stiffening the modes have no rest from 154.117 rad/s on.
    for (spin, is_beyond) in [(150.0, false), (160.0, true)] {
        let mut initial = spinning([0.0, spin, 0.0]);
        initial.modal_displacement[0] = 0.15 * plate().length / plate().peaks[0];
        let case = plate().case(&zeta, &[], &initial, 1e-3);
        let rows = run(&case, bare);
        let mut review = Review::new(case, bare, &advise(&case, 1e-3).unwrap());
        rows.iter().for_each(|row| review.observe(row).unwrap());
        println!("{:?}", review.broken());
        assert!(review.broken().iter().any(|b| matches!(b, Broken::Linear { found, .. } if *found >= 0.1499)));
        let limit = |b: &Broken| matches!(b, Broken::Limit { refusal: Refusal::Indefinite { .. }, .. });
        assert_eq!(review.broken().iter().any(limit), is_beyond);
    }
}

#[test]
fn rounding_is_no_deflection_and_the_help_names_what_is_off() {
    let zeta = [0.0; 10];
    let still = Initial::at_rest(10);
    let case = plate().case(&zeta, &[], &still, 1e-3);
    let mut row = run(&case, EffectMap::all()).pop().unwrap();
    let bare = EffectMap::all().without(Effect::Coriolis).without(Effect::GeometricStiffening);
    let advice = advise(&case, 1e-3).unwrap();
    assert_eq!(advice.deflection, 0.0);
    let mut broken = |deflection: f64| {
        row.modal_displacement[0] = deflection * plate().length / plate().peaks[0];
        let mut review = Review::new(case, bare, &advice);
        review.observe(&row).unwrap();
        review.broken()
    };
    assert_eq!(broken(1e-11), []);
    let text = broken(1e-9)[0].to_string();
    assert!(text.ends_with("set coriolis = true, geometric_stiffening = true in [effects]"), "{text}");
}

/// Closed form: the share of the remainder that was given.
#[test]
fn what_the_modes_leave_out_of_the_spin_is_weighed_by_the_spin_that_there_is() {
    let zeta = [0.0; 10];
    let initial = spinning([0.0, 0.0, 2.0]);
    let remainders = [0.0, 0.0, 1e-6, 0.0, 0.0, 5e-7];
    let case = advice::Case { centrifugal_remainders: &remainders, ..plate().case(&zeta, &[], &initial, 1e-3) };
    let row = run(&case, EffectMap::all()).pop().unwrap();
    let advice = advise(&case, 1e-3).unwrap();
    let broken = |omega: [f64; 3], q: f64, effects: EffectMap<bool>| {
        let mut review = Review::new(case, effects, &advice);
        let mut row = row.clone();
        row.omega_body = omega.into();
        row.modal_displacement.fill(0.0);
        row.modal_velocity.fill(0.0);
        row.modal_displacement[0] = q;
        review.observe(&row).unwrap();
        review.broken()
    };
    let on = EffectMap::all();
    // 4e-6 about z, of it and a deformation of 3e-6: four fifths.
    let [Broken::Stretch { influence, left_out, .. }] = broken([0.0, 0.0, 2.0], 3e-6, on)[..] else { panic!() };
    assert!((influence - 0.8).abs() < 1e-12 && left_out > 0.0, "{influence} {left_out}");
    // Too little of a large deformation; no spin; no centrifugal force.
    assert_eq!(broken([0.0, 0.0, 2.0], 5e-3, on), []);
    assert_eq!(broken([0.0, 0.0, 0.0], 0.0, on), []);
    assert_eq!(broken([0.0, 0.0, 2.0], 3e-6, on.without(Effect::DeformedInertia)), []);
}

/// Assumptions that break when every step of a run in steps of `step` is watched, with rows at multiples of `interval`.
fn watched(case: &Case, effects: EffectMap<bool>, step: f64, interval: f64) -> Vec<Broken> {
    let mut simulation = Simulation::new(&Setup {
        body: case.body,
        damping_ratios: case.damping_ratios,
        loads: case.loads,
        physics: &Physics { effects, ..Physics::default() },
        initial: case.initial,
        method: &Method::EXPONENTIAL,
        control: StepControl::Fixed(step),
        end: case.end,
        rows: Rows::Interval(interval),
        points: &[],
    })
    .unwrap();
    let mut review = Review::new(*case, effects, &advise(case, 1e-3).unwrap());
    let mut row = simulation.observation().unwrap();
    loop {
        simulation.observe([&mut row]).unwrap();
        review.observe(&row).unwrap();
        if simulation.advance_watched(u64::MAX, |_, moment| review.look(moment)).unwrap() == Reached::End {
            return review.broken();
        }
    }
}

/// A free plate whose first mode alone swings to this part of its length, through zero at time 0, for some half periods.
fn swinging(part: f64) -> (Initial, f64) {
    let omega = plate().body.circular_frequencies[0];
    let mut initial = Initial::at_rest(10);
    initial.modal_velocity[0] = part * omega * plate().length / plate().peaks[0];
    (initial, std::f64::consts::PI / omega)
}

const STILL: EffectMap<bool> = EffectMap::all()
    .without(Effect::Translation)
    .without(Effect::Rotation)
    .without(Effect::DeformedInertia)
    .without(Effect::Coriolis)
    .without(Effect::GeometricStiffening);

/// Closed form: the amplitude that the mode was given.
#[test]
fn a_deflection_between_two_rows_or_two_steps_is_seen() {
    let (zeta, (initial, half)) = ([0.0; 10], swinging(0.18));
    let case = plate().case(&zeta, &[], &initial, 8.0 * half);
    // Rows, and in the end the steps too, fall where the plate is straight. Measured: 0.17998, 0.18000.
    for (step, interval) in [(half / 50.0, half), (half, half), (2.0 * half, 2.0 * half)] {
        let broken = watched(&case, STILL, step, interval);
        let [Broken::Linear { found, .. }] = &broken[..] else { panic!("{step} {interval}: {broken:?}") };
        assert!((found / 0.18 - 1.0).abs() < 1e-3, "{found}");
    }
}

/// Closed form: the shift of the given backbone, times the periods.
#[test]
fn the_warning_tells_frequency_and_phase_by_the_modes_own_backbone() {
    let (zeta, (initial, half)) = ([0.0; 10], swinging(0.05));
    let amplitude = 0.05 * plate().length / plate().peaks[0];
    // 1 % at this amplitude, half of it by inertia.
    let backbone = Backbone::new(1.0, 0.02 / amplitude.powi(2), 0.0, -0.08 / amplitude.powi(2));
    let backbones = [Some(backbone), None];
    let case = Case { backbones: &backbones, ..plate().case(&zeta, &[], &initial, 16.0 * half) };
    let broken = watched(&case, STILL, half / 20.0, 16.0 * half);
    let [Broken::Linear { found, modes, .. }] = &broken[..] else { panic!("{broken:?}") };
    let [Detuning { mode: 1, deflection, shift, phase, periods }] = modes[..] else { panic!("{modes:?}") };
    assert!((found / 0.05 - 1.0).abs() < 1e-3 && (deflection / 0.05 - 1.0).abs() < 1e-3);
    assert!((shift + 0.01).abs() < 1e-4 && (phase + 0.08).abs() < 1e-4, "{shift} {phase}");
    assert!((periods - 8.0).abs() < 1e-9);
    let text = broken[0].to_string();
    for words in ["reached 5.0 % of the length", "mode 1 is about 1.00 % too high", "0.08000", "after 8.0 periods"] {
        assert!(text.contains(words), "{text}");
    }
    // A fifth of the amplitude, a 25th of both: not worth a word.
    let (initial, _) = swinging(0.0099);
    let case = Case { initial: &initial, ..case };
    assert_eq!(watched(&case, STILL, half / 20.0, 16.0 * half), []);
}

/// Closed form: 22 (u/L)² of a bar.
#[test]
fn a_mode_that_moved_though_nobody_thought_that_it_would_is_looked_at() {
    let (zeta, (initial, half)) = ([0.0; 10], swinging(0.05));
    let case = Case { backbones: &[None, None], ..plate().case(&zeta, &[], &initial, 16.0 * half) };
    let broken = watched(&case, STILL, half / 20.0, 16.0 * half);
    let [Broken::Linear { modes, .. }] = &broken[..] else { panic!("{broken:?}") };
    let [Detuning { mode: 1, shift, phase, .. }] = modes[..] else { panic!("{modes:?}") };
    assert!((shift + 0.055).abs() < 1e-4 && (phase + 8.0 * 0.055).abs() < 1e-3, "{shift} {phase}");
}

#[test]
fn what_means_nothing_is_refused() {
    let zeta = [0.0; 10];
    let stop = |part: f64, backbones: &[Option<Backbone>]| {
        let (initial, half) = swinging(part);
        let case = Case { backbones, ..plate().case(&zeta, &[], &initial, half) };
        let mut review = Review::new(case, STILL, &advise(&case, 1e-3).unwrap());
        run(&case, STILL).iter().for_each(|row| review.observe(row).unwrap());
        (review.stop().map(|(_, refusal)| refusal), advice::limits(&case, &STILL).unwrap())
    };
    assert_eq!(stop(0.9, &[]), (None, None));
    let (Some(Refusal::Deflected { deflection }), Some(Refusal::Deflected { .. })) = stop(36.0, &[]) else { panic!() };
    assert!(deflection > 1.0);
    let amplitude = 0.3 * plate().length / plate().peaks[0];
    let backbones = [Some(Backbone::new(1.0, 0.0, 0.0, -4.0 / amplitude.powi(2)))];
    assert!(matches!(stop(0.31, &backbones), (Some(Refusal::Detuned { mode: 1, .. }), Some(Refusal::Detuned { .. }))));
    assert_eq!(stop(0.2, &backbones), (None, None));
}

/// Coriolis forces and the stress of a spin are nothing to a clamped body, whatever it bends by.
#[test]
fn a_body_that_cannot_turn_is_not_told_to_switch_on_what_turning_does() {
    let zeta = [0.0; 10];
    let still = Initial::at_rest(10);
    let case = clamped().case(&zeta, &[], &still, 1e-3);
    let mut row = run(&case, STILL).pop().unwrap();
    row.modal_displacement[0] = 0.05 * clamped().length / clamped().peaks[0];
    let mut review = Review::new(case, STILL, &advise(&case, 1e-3).unwrap());
    review.observe(&row).unwrap();
    assert_eq!(review.broken(), []);
}

#[test]
fn no_spin_is_written_as_zero() {
    let spin = Broken::Spin { time: 0.5, found: 3.2e-5, assumed: 1.1e-6, off: "coriolis".into() };
    let text = spin.to_string();
    assert!(text.contains("the spin was 3.200e-5, above the 1.100e-6"), "{text}");
    let stretch = Broken::Stretch { time: 0.5, left_out: 0.031, influence: 2e-3, of_drive: false };
    assert!(stretch.to_string().contains("left out 3.1 % of the static response"), "{stretch}");
}
