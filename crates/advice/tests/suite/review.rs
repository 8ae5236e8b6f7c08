//! What happened against what was assumed.

use advice::{Broken, Review, advise};
use frames_rk4::{Effects, History, Initial};

use crate::plate::{CORNER, plate, run, spinning};

#[test]
fn what_was_assumed_holds_and_what_was_not_is_named_with_its_time() {
    let zeta = [0.0; 10];
    let calm = Initial::at_rest(10);
    let loads = [plate().force(CORNER, [0.0, 0.0, 1.0], History::HalfSine { start: 0.1, duration: 0.02 })];
    let pushed = plate().case(&zeta, &loads, &calm, 0.3);
    let rows = run(&pushed, Effects::default());
    let review = |effects, case, advice: &advice::Advice, rows: &[frames_rk4::Observation]| {
        let mut review = Review::new(case, effects, advice);
        rows.iter().for_each(|row| review.observe(row).unwrap());
        review.broken().to_vec()
    };
    let without = Effects { coriolis: false, ..Effects::default() };
    assert_eq!(review(without, pushed, &advise(&pushed, 1e-3).unwrap(), &rows), []);
    // Advice on the same body without the load: both the spin and the deflection break at the pulse.
    let unpushed = plate().case(&zeta, &[], &calm, 0.3);
    let broken = review(without, pushed, &advise(&unpushed, 1e-3).unwrap(), &rows);
    // With all effects on, nothing rests on the estimates.
    assert_eq!(review(Effects::default(), pushed, &advise(&unpushed, 1e-3).unwrap(), &rows), []);
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
    let mut initial = spinning([0.0, 100.0, 0.0]);
    initial.modal_displacement[0] = 0.15 * plate().length / plate().peaks[0];
    let case = plate().case(&zeta, &[], &initial, 1e-3);
    let bare = Effects { geometric_stiffening: false, ..Effects::default() };
    let rows = run(&case, bare);
    let mut review = Review::new(case, bare, &advise(&case, 1e-3).unwrap());
    rows.iter().for_each(|row| review.observe(row).unwrap());
    println!("{:?}", review.broken());
    assert!(
        review.broken().iter().any(|b| matches!(b, Broken::Linear { time, found } if *time == 0.0 && *found >= 0.1499))
    );
    assert!(review.broken().iter().any(|b| matches!(b, Broken::Limit { .. })));
}

#[test]
fn rounding_is_no_deflection_and_the_cure_names_what_is_off() {
    let zeta = [0.0; 10];
    let still = Initial::at_rest(10);
    let case = plate().case(&zeta, &[], &still, 1e-3);
    let mut row = run(&case, Effects::default()).pop().unwrap();
    let bare = Effects { coriolis: false, geometric_stiffening: false, ..Effects::default() };
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

#[test]
fn what_the_modes_leave_out_of_the_spin_is_weighed_by_the_spin_that_there_is() {
    let zeta = [0.0; 10];
    let initial = spinning([0.0, 0.0, 2.0]);
    let remainders = [0.0, 0.0, 1e-6, 0.0, 0.0, 5e-7];
    let case = advice::Case { centrifugal_remainders: &remainders, ..plate().case(&zeta, &[], &initial, 1e-3) };
    let row = run(&case, Effects::default()).pop().unwrap();
    let advice = advise(&case, 1e-3).unwrap();
    let broken = |omega: [f64; 3], q: f64, effects: Effects| {
        let mut review = Review::new(case, effects, &advice);
        let mut row = row.clone();
        row.omega_body = omega.into();
        row.modal_displacement.fill(0.0);
        row.modal_displacement[0] = q;
        review.observe(&row).unwrap();
        review.broken()
    };
    let on = Effects::default();
    // 4e-6 about z, of it and a deformation of 3e-6: four fifths.
    let [Broken::Stretch { influence, held, .. }] = broken([0.0, 0.0, 2.0], 3e-6, on)[..] else { panic!() };
    assert!((influence - 0.8).abs() < 1e-12 && held < 1.0, "{influence} {held}");
    // Too little of a large deformation; no spin; no centrifugal force.
    assert_eq!(broken([0.0, 0.0, 2.0], 5e-3, on), []);
    assert_eq!(broken([0.0, 0.0, 0.0], 0.0, on), []);
    assert_eq!(broken([0.0, 0.0, 2.0], 3e-6, Effects { deformed_inertia: false, ..on }), []);
}
