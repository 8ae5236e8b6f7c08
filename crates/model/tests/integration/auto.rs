//! Modes that `"auto"` keeps.

use nalgebra::Vector3;

use crate::{Body, CLAMPED, bar, build, observations, point};

const END: f64 = 0.02;

/// A clamped bar whose tip is hit for a time, across and a little along.
fn hit(modes: &str, duration: f64, tolerance: f64) -> Body {
    let rest = format!(
        "[effects]\ntolerance = {tolerance}\n{CLAMPED}[[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\n\
         direction = [0.1, 0.0, 1.0]\namplitude = 2.0\nhistory = {{ kind = \"half-sine\", duration = {duration:e} }}"
    );
    bar(&format!("{modes}\ndamping_ratio = 0.01"), &rest, &format!("end = {END}\nstep = 5e-6"))
}

/// Path of the tip.
fn path(body: &Body) -> (usize, Vec<Vector3<f64>>) {
    let model = build(body);
    let rows = observations(body, &model);
    (model.body.flexible(), rows.iter().map(|row| point(&model, row, "tip").displacement).collect())
}

fn largest(path: impl Iterator<Item = Vector3<f64>>) -> f64 {
    path.map(|u| u.norm()).fold(0.0, f64::max)
}

/// Independent reference: the motion with 40 modes.
#[test]
fn a_short_pulse_keeps_more_modes_than_a_slow_one_and_both_are_right() {
    let mut kept = Vec::new();
    for duration in [1e-2, 1e-4, 3e-5] {
        let tolerance = 1e-2;
        let (modes, found) = path(&hit("flexible = \"auto\"", duration, tolerance));
        let (_, all) = path(&hit("flexible = 40", duration, 1e-6));
        let off = largest(found.iter().zip(&all).map(|(a, b)| a - b)) / largest(all.iter().copied());
        // Measured: 2.3e-3 with 5 modes, 3.6e-3 with 15, 6.6e-3 with 27.
        assert!(off < tolerance, "{duration:e}: {modes} modes are {off:e} off");
        kept.push(modes);
    }
    assert!(kept[0] < kept[1] && kept[1] < kept[2], "{kept:?}");
}

#[test]
fn a_closer_tolerance_keeps_more() {
    let kept = |tolerance| build(&hit("flexible = \"auto\"", 1e-3, tolerance)).body.flexible();
    let kept = [1e-1, 1e-2, 1e-3].map(kept);
    assert!(kept[0] < kept[1] && kept[1] < kept[2], "{kept:?}");
}

#[test]
fn there_are_never_more_than_the_most() {
    let model = build(&hit("flexible = \"auto\"\nmost = 4\nstatic_correction = false", 1e-5, 1e-4));
    assert_eq!(model.body.flexible(), 4);
    assert!(model.advice.more_modes);
}

#[test]
fn static_shapes_come_where_a_load_needs_them() {
    let force = |at: &str, direction: &str| {
        format!(
            "{CLAMPED}[[loads]]\nkind = \"force\"\nat = {at}\ndirection = {direction}\namplitude = 2.0\n\
             history = {{ kind = \"ramp\", duration = 0.01 }}"
        )
    };
    let shapes = |modes: &str, rest: &str| {
        build(&bar(&format!("{modes}\ndamping_ratio = 0.01"), rest, "end = 0.02\nstep = 1e-4")).static_shapes()
    };
    // Three bending modes carry nothing of a pull along the bar.
    assert_eq!(shapes("flexible = 3", &force("[200.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]")), 1);
    assert_eq!(shapes("flexible = 3", &force("[200.0, 0.0, 0.0]", "[0.0, 0.0, 1.0]")), 1);
    assert_eq!(shapes("flexible = 3\nstatic_correction = false", &force("[200.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]")), 0);
    // No load and no spin: nothing to be static about.
    assert_eq!(shapes("flexible = 3", &format!("[initial]\nmodal_velocity = [1.0]\n{CLAMPED}")), 0);
    assert_eq!(shapes("flexible = 3", "[initial]\nmodal_velocity = [1.0]\n"), 0);
    // Gravity does not deform a free body.
    let falls = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0";
    assert_eq!(shapes("flexible = 3", falls), 0);
}

#[test]
fn what_nothing_moves_is_not_kept() {
    let falls = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0";
    assert_eq!(build(&bar("flexible = \"auto\"", falls, "end = 0.02\nstep = 1e-4")).body.flexible(), 0);
    assert_eq!(build(&bar("flexible = \"auto\"", CLAMPED, "end = 0.02\nstep = 1e-4")).body.flexible(), 0);
}
