//! Stretch by a steady spin: a free bar about its middle, whose lowest modes bend and hold nothing of it.

use advice::{Broken, Review};

use crate::{Body, DENSITY, LENGTH, YOUNG, bar, build, observations, point};

const SPIN: f64 = 1000.0;
/// ρΩ²a³/3E of a bar of half length a.
const EXACT: f64 = DENSITY * SPIN * SPIN * LENGTH * LENGTH * LENGTH / (24.0 * YOUNG);

/// Critically damped, so that what is stretched at once comes to rest; `time` ends with the scheme.
fn spinning(modes: &str, effects: &str, time: &str) -> Body {
    let rest = format!("[effects]\n{effects}\n[initial]\nangular_velocity = [0.0, 0.0, {SPIN:?}]");
    bar(&format!("{modes}\ndamping_ratio = 1.0"), &rest, &format!("end = 0.01\n{time}"))
}

/// Static shapes, how far the tip is from the middle beyond its place at the end, over that by theory, what the review
/// says, and the reason in the row of static shapes.
fn stretched(body: &Body) -> (usize, f64, Vec<Broken>, String) {
    let model = build(body);
    let initial = model.initial(body);
    let mut review = Review::new(model.case(body, &initial), model.physics.effects, &model.advice);
    let rows = observations(body, &model);
    rows.iter().for_each(|row| review.observe(row).unwrap());
    let last = rows.last().unwrap();
    let place = |name: &str| point(&model, last, name).displacement;
    let arm = nalgebra::Vector3::x() * (0.5 * LENGTH);
    let stretch = (arm + place("tip") - place("middle")).norm() - arm.norm();
    let why = model.advice.static_correction.why.clone();
    (model.static_shapes(), stretch / EXACT, review.broken(), why)
}

/// Closed form: ρΩ²a³/(3E).
#[test]
fn the_default_scheme_takes_static_shapes_for_it_with_and_without_stiffening() {
    for effects in ["", "geometric_stiffening = false", "geometric_stiffening = false\ndeformed_inertia = true"] {
        let (shapes, found, broken, why) = stretched(&spinning("flexible = 6", effects, "step = 1e-4"));
        println!("{effects:?} {shapes} {found} {broken:?} {why}");
        // Measured: 0.99934 stiffened, 0.99950 without.
        assert!(shapes > 0 && (found - 1.0).abs() < 1e-2, "{effects:?}: {shapes} shapes, {found}");
        assert!(broken.is_empty() && !why.contains("lacks"), "{effects:?}: {broken:?} {why}");
    }
}

/// Closed form: ρΩ²a³/(3E), of which nothing is there.
#[test]
fn where_the_scheme_does_not_take_them_advice_and_review_say_that_the_answer_lacks_it() {
    for scheme in ["scheme = \"rkmk4\"", "formulation = \"paper\"\nscheme = \"rkmk4\""] {
        let time = format!("step = 2e-5\n{scheme}");
        let (shapes, found, broken, why) = stretched(&spinning("flexible = 6", "", &time));
        println!("{scheme} {shapes} {found} {broken:?} {why}");
        // Measured: 1e-11, of which the modes would hold 1.1e-6.
        assert!(shapes == 0 && found.abs() < 1e-2, "{scheme}: {shapes} shapes, {found}");
        let [Broken::Stretch { left_out, influence, .. }] = broken[..] else { panic!("{scheme}: {broken:?}") };
        assert!(left_out > 0.99 && influence > 0.9, "{scheme}: {left_out} {influence}");
        assert!(
            why.contains("leave out") && why.contains("lacks") && why.contains("static_correction = true"),
            "{why}"
        );
    }
}

/// Closed form: ρΩ²a³/(3E).
#[test]
fn more_modes_hold_it() {
    let (_, found, broken, _) =
        stretched(&spinning("flexible = 40", "tolerance = 0.1", "step = 2e-7\nscheme = \"rkmk4\""));
    println!("{found} {broken:?}");
    // Measured: 1.0256.
    assert!((found - 1.0).abs() < 0.1 && broken.is_empty(), "{found} {broken:?}");
}

/// Closed form: ρΩ²a³/(3E), of which nothing is there.
#[test]
fn who_leaves_them_out_is_told_by_the_table_alone() {
    let body = spinning("flexible = 6\nstatic_correction = false", "geometric_stiffening = false", "step = 1e-4");
    let (shapes, found, broken, why) = stretched(&body);
    assert!(shapes == 0 && found.abs() < 1e-2 && broken.is_empty(), "{shapes} {found} {broken:?}");
    assert!(why.contains("leave out of the static response to the spin"), "{why}");
}
