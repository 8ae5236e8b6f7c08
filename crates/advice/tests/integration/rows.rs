//! Rows whose numbers are known.

use advice::{AdviceError, Case, StaticCompliance, advise, screen};
use dynamics::{Effect, EffectMap, History, Initial, Pattern, SharedLoad};
use nalgebra::Vector3;

use crate::plate::{CORNER, clamped, plate, run, spinning};

/// Closed form: (Ω/ω₁)², and the rise √(1 + Ω²K/ω₁²) − 1.
#[test]
fn the_stress_of_the_paper_s_plate_at_10_rad_per_s_is_not_called_0_4_per_cent() {
    let zeta = [0.0; 10];
    let initial = spinning([0.0, 10.0, 0.0]);
    let case = plate().case(&zeta, &[], &initial, 0.5);
    let row = screen(&case, 1e-3).unwrap();
    let advice = advise(&case, 1e-3).unwrap();
    let known = &advice.effects[Effect::GeometricStiffening];
    let omega = case.body.circular_frequencies[0];
    let matrix = &case.body.stress_stiffness.as_ref().unwrap()[1];
    // About y, in the first mode: (Ω/ω1)² and the rise of its frequency.
    let naive = (10.0 / omega).powi(2);
    let rise = (1.0 + 100.0 * matrix[(0, 0)] / (omega * omega)).sqrt() - 1.0;
    println!("{naive} {rise} {} {} {}", known.value, row.value, known.why);
    assert!((naive - 0.0042).abs() < 1e-4);
    // Measured 3.5 %.
    assert!((0.03..0.04).contains(&rise), "{rise}");
    assert!(known.on && row.on && known.value >= 100.0 * matrix[(0, 0)] / (omega * omega));
    assert!(row.value >= known.value);
}

/// Independent reference: the advice that knows the stiffness.
#[test]
fn the_screen_is_above_the_stiffness_of_each_mode_about_each_axis() {
    let zeta = [0.0; 10];
    for axis in 0..3 {
        let mut omega = [0.0; 3];
        omega[axis] = 7.0;
        let initial = spinning(omega);
        let case = plate().case(&zeta, &[], &initial, 0.1);
        let (bound, known) = (screen(&case, 1e-3).unwrap(), advise(&case, 1e-3).unwrap());
        let known = &known.effects[Effect::GeometricStiffening];
        println!("{axis}: {:.2e} {:.2e}", bound.value, known.value);
        // Measured: 0.27 about each axis, against 1.7e-4 along the plate and 0.035 across it.
        assert!(bound.value >= known.value && bound.influence >= known.influence);
    }
}

#[test]
fn a_body_at_rest_has_nothing_on_and_a_central_push_does_not_turn_it() {
    let zeta = [0.01; 10];
    let initial = Initial::at_rest(10);
    let rest = advise(&plate().case(&zeta, &[], &initial, 1.0), 1e-3).unwrap();
    assert!(rest.rows().all(|(_, row)| !row.on), "{rest:?}");
    // Static shapes and deflection have rows, too; that of the step is of a run, not of a case.
    assert_eq!((rest.keep, rest.rows().count()), (0, Effect::ALL.len() + 2));
    let moving = Initial { velocity: [1.0, 0.0, 0.0].into(), ..initial };
    let advice = advise(&plate().case(&zeta, &[], &moving, 1.0), 1e-3).unwrap();
    let on = [Effect::Translation, Effect::Rotation, Effect::Flexibility].map(|effect| advice.effects[effect].on);
    assert_eq!(on, [true, false, false]);
    let central = [plate().force([0.0, 0.0, 5.0], [0.0, 0.0, 1e-6], History::HalfSine { start: 0.0, duration: 0.5 })];
    let still = Initial::at_rest(10);
    let case = plate().case(&zeta, &central, &still, 1.0);
    let advice = advise(&case, 1e-3).unwrap();
    let row = &advice.effects[Effect::Rotation];
    println!("{row:?}");
    assert!(advice.effects[Effect::Translation].on && !row.on, "{row:?}");
    let turned = run(&case, EffectMap::all()).iter().map(|x| x.omega_body.norm()).fold(0.0, f64::max);
    assert!(turned <= advice.spin.max(1e-12), "{turned}");
}

#[test]
fn slow_loads_need_fewer_modes_than_fast_ones() {
    let zeta = [0.02; 10];
    let initial = Initial::at_rest(10);
    let keep = |duration: f64, tolerance: f64| {
        let loads = [plate().force(CORNER, [0.0, 0.0, 1e-3], History::HalfSine { start: 0.0, duration })];
        let advice = advise(&plate().case(&zeta, &loads, &initial, 1.0), tolerance).unwrap();
        println!("{duration}: keep {} {:?}", advice.keep, advice.modes.iter().map(|m| m.share).collect::<Vec<_>>());
        (advice.keep, advice.more_modes)
    };
    assert!(keep(0.5, 0.05).0 < keep(5e-4, 0.05).0);
    assert_eq!(keep(5e-4, 1e-6), (10, true));
}

/// Closed form: 1 − Σ (φᵀf)²/ω² over the whole compliance.
#[test]
fn the_static_answer_that_the_modes_leave_out_is_the_rest_of_the_compliance() {
    let zeta = [0.0; 10];
    let loads = [plate().force(CORNER, [0.0, 0.0, 2.0], History::Constant)];
    let initial = Initial::at_rest(10);
    let whole = 4.0 * plate().corner_compliance;
    let compliances = [StaticCompliance { at_start: whole, turned: Vec::new() }];
    let body = &plate().body;
    let case = Case { static_compliances: &compliances, ..plate().case(&zeta, &loads, &initial, 1e-3) };
    let advice = advise(&case, 1e-9).unwrap();
    assert_eq!(advice.keep, 10);
    let columns = loads[0].pattern().unwrap().columns;
    let carried: f64 = (0..10).map(|k| (2.0 * columns[6 + k].z / body.circular_frequencies[k]).powi(2)).sum();
    let rest = 1.0 - carried / whole;
    let row = &advice.static_correction;
    println!("{rest} {row:?}");
    assert!(rest > 0.0 && rest < 0.1, "{rest}");
    // Measured 0.9 %.
    assert!((row.value - rest).abs() < 1e-9, "{} {rest}", row.value);
}

/// Closed form: the rest of the compliance, by the square of the angle. The plate cannot be seen to stretch in ten
/// modes that bend it.
#[test]
fn other_directions_of_a_dead_load_count_as_far_as_the_body_may_turn() {
    let zeta = [0.0; 10];
    let force = Vector3::new(0.0, 0.0, 1e-9);
    let stretch = Vector3::new(1e-9, 0.0, 0.0);
    let loads = [plate().force(CORNER, force.into(), History::Constant)];
    let whole = 1e-18 * plate().corner_compliance;
    let columns = loads[0].pattern().unwrap().columns;
    let omega = &plate().body.circular_frequencies;
    let carried: f64 = (0..10).map(|k| (columns[6 + k].dot(&stretch) / omega[k]).powi(2)).sum();
    let value = |end: f64, turned: &[(Vector3<f64>, f64)]| {
        let compliances = [StaticCompliance { at_start: whole, turned: turned.to_vec() }];
        let initial = spinning([0.0, 10.0, 0.0]);
        let case = Case { static_compliances: &compliances, ..plate().case(&zeta, &loads, &initial, end) };
        advise(&case, 1e-9).unwrap().static_correction.value
    };
    let work = 4.0 * carried;
    let turned = [(stretch, work)];
    let (none, far) = (value(1.0, &[]), value(1.0, &turned));
    // By a bound of 0.2 and 0.4 rad.
    let (once, twice) = (value(1e-3, &turned), value(2e-3, &turned));
    println!("{none} {once} {twice} {far}");
    assert!(none < 0.01 && (far - 0.75).abs() < 1e-9, "{none} {far}");
    assert!(once > 0.02 && twice < 0.2 && (twice / once - 4.0).abs() < 0.05, "{once} {twice}");
}

/// Closed form: the formulas of each row.
#[test]
fn deflection_foreshortening_and_gravity_follow_from_their_formulas() {
    let zeta = [0.0; 10];
    let mut initial = Initial::at_rest(10);
    let body = &plate().body;
    initial.modal_displacement[0] = 0.2 * plate().length / plate().peaks[0];
    let weight = [plate().force([0.0, 0.0, 5.0], [0.0, 0.0, -9810.0 * body.mass], History::Constant)];
    let case = Case { is_gravity: &[true], ..plate().case(&zeta, &weight, &initial, 0.1) };
    let advice = advise(&case, 1e-3).unwrap();
    let (deflection, gravity) = (&advice.large_deflection, &advice.effects[Effect::Gravity]);
    assert!(deflection.value >= 0.2 && deflection.on);
    // Without backbones: 22 (u/L)², the frequency of a free bar.
    let large = &advice.effects[Effect::LargeDeflection];
    assert!(large.on && (large.value / (22.0 * deflection.value.powi(2)) - 1.0).abs() < 1e-12);
    assert!(gravity.on && (gravity.value - 1.0).abs() < 1e-12);
}

#[test]
fn gravity_is_told_by_its_mark_wherever_it_stands_among_the_loads() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    let weight = plate().force([0.0, 0.0, 5.0], [0.0, 0.0, -9810.0 * plate().body.mass], History::Constant);
    let push = plate().force(CORNER, [0.0, 0.0, 3.0], History::Constant);
    let row = |loads: [&SharedLoad; 2], is_gravity: &[bool]| {
        let loads = loads.map(Clone::clone);
        let case = Case { is_gravity, ..plate().case(&zeta, &loads, &initial, 0.1) };
        advise(&case, 1e-3).unwrap().effects[Effect::Gravity].clone()
    };
    let (first, last) = (row([&weight, &push], &[true, false]), row([&push, &weight], &[false, true]));
    let other = row([&push, &weight], &[true, false]);
    println!("{} {} {}", first.value, last.value, other.value);
    assert!(first.value > 0.0 && (first.value / last.value - 1.0).abs() < 1e-12, "{first:?} {last:?}");
    // The push beside the weight: 3 % of the translation, and all of the rotation.
    assert!(last.value < 0.98 && other.value > 0.99, "{last:?} {other:?}");
    assert!(!row([&push, &weight], &[]).on);
}

/// Closed form: a velocity at the start changes nothing of what gravity does to a body, nor does a push that takes it further.
#[test]
fn what_gravity_moves_by_a_part_of_the_length_is_kept_however_fast_the_body_flies() {
    let zeta = [0.0; 10];
    let initial = Initial { velocity: Vector3::x() * 7.5e6, ..Initial::at_rest(10) };
    let weight = plate().force([0.0, 0.0, 5.0], [0.0, 0.0, -9810.0 * plate().body.mass], History::Constant);
    let push = plate().force(CORNER, [0.0, 0.0, 1e9 * plate().body.mass], History::Constant);
    let row = |end: f64| {
        let loads = [weight.clone(), push.clone()];
        let case = Case { is_gravity: &[true, false], ..plate().case(&zeta, &loads, &initial, end) };
        advise(&case, 1e-3).unwrap().effects[Effect::Gravity].clone()
    };
    let [short, long] = [1e-4, 0.1].map(row);
    // g T²/L of the long one; of the short one the share of its impulse is larger.
    assert!((long.value / (9810.0 * 0.1 * 0.1 / plate().length) - 1.0).abs() < 1e-6 && long.on, "{long:?}");
    assert!(short.value < 1e-4, "{short:?}");
}

#[test]
fn lists_of_another_length_and_numbers_out_of_range_are_refused() {
    let initial = Initial::at_rest(10);
    let short = [0.0; 9];
    let refused = advise(&plate().case(&short, &[], &initial, 1.0), 1e-3);
    assert_eq!(refused, Err(AdviceError::Length { what: "the list of damping ratios", found: 9, expected: 10 }));
    let zeta = [0.0; 10];
    let marked = advise(&Case { is_gravity: &[true], ..plate().case(&zeta, &[], &initial, 1.0) }, 1e-3);
    assert_eq!(marked, Err(AdviceError::Length { what: "the list that marks gravity", found: 1, expected: 0 }));
    assert!(matches!(advise(&plate().case(&zeta, &[], &initial, f64::NAN), 1e-3), Err(AdviceError::Value { .. })));
}

/// Independent reference: the accelerations of the motion.
#[test]
fn flexibility_is_what_the_modes_add_to_the_rigid_acceleration() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    for duration in [0.02, 1.0] {
        let loads = [plate().force(CORNER, [0.0, 0.0, 1e-4], History::HalfSine { start: 0.0, duration })];
        let case = plate().case(&zeta, &loads, &initial, duration);
        let Pattern { columns, vector, .. } = loads[0].pattern().unwrap();
        let rigid: f64 = columns[..6].iter().map(|column| column.dot(&vector).powi(2)).sum::<f64>().sqrt();
        let size = |row: &dynamics::Observation| row.modal_acceleration.iter().map(|a| a * a).sum::<f64>().sqrt();
        let real = run(&case, EffectMap::all()).iter().map(size).fold(0.0, f64::max) / rigid;
        let row = advise(&case, 1e-3).unwrap();
        let row = &row.effects[Effect::Flexibility];
        println!("{duration}: {row:?} real {real:.2e}");
        assert!(row.value >= real && row.influence >= real.min(1.0), "{duration}: {row:?} {real}");
        // Measured bound/real: 1.2 and 2.2.
        assert!(row.value < 10.0 * real, "{duration}: {row:?} {real}");
    }
}

/// Closed form: of forces F and −F from t₁ on, a mode has the force of an impulse: 2 F sin(ωt₁/2)/ω² at the most, and nothing
/// where both act from the beginning.
#[test]
fn loads_that_cancel_move_the_modes_together() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    let omega = &clamped().body.circular_frequencies;
    let late = 1.0 / omega[9];
    let moved = |other: History| {
        let loads = [
            clamped().force(CORNER, [0.0, 0.0, 1e-9], History::Constant),
            clamped().force(CORNER, [0.0, 0.0, -1e-9], other),
        ];
        let advice = advise(&clamped().case(&zeta, &loads, &initial, 20.0 / omega[0]), 1e-9).unwrap();
        let columns = loads[0].pattern().unwrap().columns;
        let force = move |k: usize| 1e-9 * columns[6 + k].z.abs();
        (0..10).map(|k| (advice.modes[k].displacement, force(k))).collect::<Vec<_>>()
    };
    for at in [0.0, -1.0] {
        let found = moved(if at < 0.0 { History::Step { at } } else { History::Constant });
        assert!(found.iter().all(|(displacement, force)| *displacement <= 1e-9 * force), "{found:?}");
    }
    for (k, (displacement, force)) in moved(History::Step { at: late }).into_iter().enumerate() {
        let expected = 2.0 * force * (0.5 * omega[k] * late).sin() / omega[k].powi(2);
        println!("{k}: {displacement:e} {expected:e}");
        assert!(
            displacement >= (1.0 - 1e-6) * expected && displacement <= 1.1 * expected,
            "{k}: {displacement:e} {expected:e}"
        );
    }
}

/// Forces on the corners of an end of the plate, and the opposite ones on the other, along z: pairs that twist it and turn nothing.
const TWIST: [([f64; 3], f64); 4] = [
    ([500.0, 25.0, 10.0], 1.0),
    ([500.0, -25.0, 10.0], -1.0),
    ([-500.0, 25.0, 10.0], -1.0),
    ([-500.0, -25.0, 10.0], 1.0),
];

/// Closed form: of moments M and −M that both act from the beginning nothing turns, and of which one comes t₁ later, M t₁ does. Without their
/// sum the spin was that of each alone, 4 F b T/J, and the centrifugal field of it bent modes that nothing moves.
#[test]
fn moments_that_cancel_turn_the_body_together() {
    let (zeta, initial) = ([0.0; 10], Initial::at_rest(10));
    let omega = &plate().body.circular_frequencies;
    let (end, force) = (40.0 / omega[0], 1e-3);
    let loads = |late: f64| -> Vec<SharedLoad> {
        let of = |(at, sign): ([f64; 3], f64)| {
            let history = if at[0] < 0.0 && late > 0.0 { History::Step { at: late } } else { History::Constant };
            plate().force(at, [0.0, 0.0, sign * force], history)
        };
        TWIST.into_iter().map(of).collect()
    };
    let twist = loads(0.0);
    let case = plate().case(&zeta, &twist, &initial, end);
    let advice = advise(&case, 1e-3).unwrap();
    let most = advice.modes.iter().map(|mode| mode.displacement).fold(0.0, f64::max);
    let pushed = |k: usize| {
        let patterns = twist.iter().map(|load| load.pattern().unwrap());
        patterns.map(|pattern| pattern.columns[6 + k].dot(&pattern.vector)).sum::<f64>().abs()
    };
    let strongest = (0..10).map(pushed).fold(0.0, f64::max);
    for k in 0..10 {
        let moved = advice.modes[k].displacement;
        println!("{k}: force {:.1e}, moved {moved:.1e}", pushed(k));
        assert!(pushed(k) > 1e-6 * strongest || moved < 1e-6 * most, "{k}: {moved}");
    }
    assert!(advice.spin < 1e-9 * most && !advice.effects[Effect::Rotation].on, "{}", advice.spin);
    // M about x is 2 F b with b = 25 mm.
    let late = 1.0 / omega[0];
    let loads = loads(late);
    let case = plate().case(&zeta, &loads, &initial, end);
    let found = advise(&case, 1e-3).unwrap().spin;
    let turned = 50.0 * force * late / case.body.inertia[(0, 0)];
    let actual = run(&case, EffectMap::all()).iter().map(|x| x.omega_body.norm()).fold(0.0, f64::max);
    println!("{found:e}, closed form {turned:e}, run {actual:e}");
    // The bound has the arms of a deformed body, a direction that turns and the axis of least inertia.
    assert!(found >= turned.max(actual) && found < 2.0 * turned, "{found} {turned} {actual}");
}
