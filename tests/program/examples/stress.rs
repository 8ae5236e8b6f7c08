//! Stress from the scene to the results file, against closed forms.

use flexframe::columns::COLUMNS;
use flexframe::model::Model;
use flexframe::peak_stress::PeakStress;
use flexframe::results::Results;
use flexframe::run::{RunSettings, run};
use flexframe::scene::{Body, Effect};

use crate::examples::{build, scene};
use crate::program::root;

/// The results file of a scene and the peak of its summary.
fn outcome(body: &Body) -> (Results, Option<PeakStress>) {
    let folder = tempfile::tempdir().unwrap();
    let mut report = run(&body.clone().into(), folder.path(), &RunSettings::default(), |_| ()).unwrap().1;
    (Results::open(report.results, &COLUMNS).unwrap(), report.bodies.remove(0).peak_stress)
}

/// A scene of the bar of slenderness 70 along x, 202.07 mm long and 10 mm thick, without Poisson's effect.
fn bar(rest: &str) -> Body {
    let text = format!(
        r#"
title = "bar"
units = {{ length = "mm", mass = "Mg", time = "s" }}
[body]
mesh = "../meshes/rotating_bar.msh"
material = {{ young_modulus = 70000.0, poisson_ratio = 0.0, density = 2.7e-9 }}
{rest}"#
    );
    Body::parse(&text, root().join("examples/bar.toml")).unwrap()
}

const SPIN: f64 = 1000.0;
const LENGTH: f64 = 202.07;
/// ρω²(L/2)²/2.
const BAR: f64 = 0.5 * 2.7e-9 * SPIN * SPIN * LENGTH * LENGTH / 4.0;

fn spinning_bar(static_correction: bool) -> Body {
    bar(&format!(
        r#"
[modes]
flexible = 4
static_correction = {static_correction}
damping_ratio = 0.7
[initial]
angular_velocity = [0, 0, {SPIN:?}]
[time]
end = 2e-3
tolerance = 1e-6
[output]
interval = 5e-4
points = {{ middle = [101.035, 0, 0], quarter = [50.5175, 0, 0] }}
stress = true
peak_stress = true
"#
    ))
}

/// Closed form: ρω²(L²/4 − x²)/2 at x from the middle.
#[test]
fn a_spinning_bar_has_the_stress_of_the_closed_form() {
    let (results, peak) = outcome(&spinning_bar(true));
    let last = results.rows() - 1;
    for (name, expected) in [("middle", BAR), ("quarter", 0.75 * BAR)] {
        let stress = results.vectors::<6>(&format!("points/{name}/stress")).unwrap()[last];
        println!("{name}: {stress:?} {expected}");
        assert!((stress[0] / expected - 1.0).abs() < 0.01, "{name}: {stress:?}, {expected}");
        assert!(stress[1..].iter().all(|s| s.abs() < 0.02 * expected), "{name}: {stress:?}");
        let von_mises = results.numbers(&format!("points/{name}/von_mises_stress")).unwrap()[last];
        let principal = results.vectors::<3>(&format!("points/{name}/principal_stress")).unwrap()[last];
        assert!((von_mises / expected - 1.0).abs() < 0.02, "{von_mises}");
        assert!((principal[0] / expected - 1.0).abs() < 0.01 && principal[0] >= principal[1], "{principal:?}");
    }
    let peak = peak.unwrap();
    println!("{peak:?}");
    assert!((peak.at[0] - 0.5 * LENGTH).abs() < 15.0 && peak.groups == ["bar"], "{peak:?}");
    // It swings beyond the answer before it comes to rest, by less than a tenth with this damping.
    assert!((0.99..1.1).contains(&(peak.von_mises / BAR)), "{peak:?}");
    assert!(peak.max_left_out.unwrap() < 1e-3 * BAR && peak.mesh_error.unwrap() < 0.05, "{peak:?}");
}

/// Closed form: what is left out is ρω²L²/8, since bending modes have no tension.
#[test]
fn what_modes_without_static_shapes_leave_out_is_said() {
    let (_, peak) = outcome(&spinning_bar(false));
    let peak = peak.unwrap();
    println!("{peak:?}");
    // Four bending modes have none of the tension.
    assert!(peak.von_mises < 1e-3 * BAR, "{peak:?}");
    assert!((peak.max_left_out.unwrap() / BAR - 1.0).abs() < 0.02, "{peak:?}");
}

/// Closed form: (3 + ν)/8 ρω²R² in the middle of a thin disc, and the two stresses at half the radius.
#[test]
fn a_spinning_disc_has_the_stress_of_the_closed_form() {
    let (results, peak) = outcome(&scene("spinning_disc"));
    let last = results.rows() - 1;
    let nu = 0.3;
    let load = 2.7e-9 * SPIN * SPIN * 1e4;
    let stress = |name: &str| results.vectors::<6>(&format!("points/{name}/stress")).unwrap()[last];
    let (middle, half) = (stress("middle"), stress("half"));
    println!("{middle:?} {half:?} {peak:?}");
    for (found, expected) in [
        (middle[0], (3.0 + nu) / 8.0 * load),
        (middle[1], (3.0 + nu) / 8.0 * load),
        (half[0], (3.0 + nu) / 8.0 * load * 0.75),
        (half[1], load / 8.0 * (3.0 + nu - (1.0 + 3.0 * nu) / 4.0)),
    ] {
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }
    let peak = peak.unwrap();
    assert!(peak.at[0].hypot(peak.at[1]) < 30.0, "{peak:?}");
    assert!(peak.max_left_out.unwrap() < 1e-2 * load, "{peak:?}");
}

/// A clamped bar with a large mode.
const BENT: &str = r#"
[modes]
flexible = 6
large = [1]
[effects]
large_deflection = true
refuse = false
[[constraints]]
kind = "clamp"
group = "root"
[time]
end = 1e-3
tolerance = 1e-6
[output]
points = { axis = [100, 0, 0], above = [100, 0, 5], left = [100, 5, 0] }
stress = true
peak_stress = true
"#;

/// The coordinate of its first mode at a deflection of the tip, in parts of the length: the peaks of the modes are of mass-normalised
/// shapes, 2/√m.
fn bent(model: &Model, deflection: f64) -> f64 {
    deflection * LENGTH * model.body.mass.sqrt() / 2.0
}

/// The stress that large modes leave out is stated only where they hardly bend the body.
#[test]
fn what_large_modes_leave_out_of_a_body_that_is_bent_far_is_not_stated() {
    for (deflection, is_stated) in [(0.01, true), (0.05, false)] {
        let mut body = bar(BENT);
        body.initial.modal_displacement = vec![bent(&build(&body), deflection)];
        let peak = outcome(&body).1.unwrap();
        assert_eq!([peak.left_out, peak.max_left_out].map(|stated| stated.is_some()), [is_stated; 2], "{peak:?}");
    }
}

/// Closed form: no stress along the axis of a bar in pure bending.
#[test]
fn a_bar_that_is_bent_far_is_not_compressed_along_its_middle() {
    let body = bar(BENT);
    let model = build(&body);
    assert!(model.physics.effects[Effect::LargeDeflection]);
    let mut q = vec![0.0; model.body.flexible()];
    q[0] = bent(&model, 0.1);
    let stress: Vec<[f64; 6]> = model.stress.as_ref().unwrap().at_points(&q).collect();
    // In the order of the names: above, axis, left.
    let surface = stress[0][0].abs().max(stress[2][0].abs());
    println!("{stress:?}");
    assert!(surface > 100.0, "{stress:?}");
    assert!(stress[1][0].abs() < 0.05 * surface, "{stress:?}");
}
