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
    // Something must have been left out for the estimates to matter.
    let few = Effects { coriolis: false, ..Effects::default() };
    let review = |case, advice: &advice::Advice, rows: &[frames_rk4::Observation]| {
        let mut review = Review::new(case, few, advice);
        rows.iter().for_each(|row| review.observe(row).unwrap());
        review.broken().to_vec()
    };
    assert_eq!(review(pushed, &advise(&pushed, 1e-3).unwrap(), &rows), []);
    // Advice on the same body without the load: both the spin and the deflection break at the pulse.
    let unpushed = plate().case(&zeta, &[], &calm, 0.3);
    let broken = review(pushed, &advise(&unpushed, 1e-3).unwrap(), &rows);
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
