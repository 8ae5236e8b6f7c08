//! Each history, from the scene to the acceleration of a rigid body that it acts on.

use std::f64::consts::{PI, TAU};

use crate::{observations, parse, point, rigid};

const END: f64 = 0.5;

/// A force with this history gives the acceleration that the formula says.
#[track_caller]
fn follows(history: &str, formula: impl Fn(f64) -> f64) {
    let rest = format!(
        "[[loads]]\nkind = \"force\"\nat = [1.0, 2.0, 3.0]\ndirection = [0.0, 1.0, 0.0]\namplitude = 6.0\n\
         history = {history}"
    );
    // Rows never fall on a discontinuity: those are at whole hundredths.
    let scene = rigid(&rest, &format!("end = {END}\nstep = 0.0037"));
    let model = crate::build(&scene);
    let rows = observations(&scene, &model);
    assert!(rows.len() > 100);
    let mut largest = 0.0_f64;
    for row in rows {
        if (row.time * 100.0 - (row.time * 100.0).round()).abs() < 1e-6 {
            continue;
        }
        let (found, expected) = (point(&model, &row, "center").rigid_acceleration.y, 3.0 * formula(row.time));
        assert!((found - expected).abs() < 1e-12, "{history}: {found} instead of {expected} at {}", row.time);
        largest = largest.max(expected.abs());
    }
    assert!(largest > 0.5, "{history}: never more than {largest}");
}

/// Closed form: the formula of each kind of history.
#[test]
fn every_kind_is_its_formula() {
    let inside = |t: f64, from: f64, to: f64| f64::from(t > from && t < to);
    follows("{ kind = \"constant\" }", |_| 1.0);
    follows("{ kind = \"step\", at = 0.2 }", |t| f64::from(t > 0.2));
    follows("{ kind = \"ramp\", start = 0.1, duration = 0.2 }", |t| ((t - 0.1) / 0.2).clamp(0.0, 1.0));
    follows("{ kind = \"half-sine\", start = 0.1, duration = 0.3 }", |t| {
        inside(t, 0.1, 0.4) * (PI * (t - 0.1) / 0.3).sin()
    });
    follows("{ kind = \"sine\", frequency = 7.0, phase = 0.4 }", |t| (TAU * 7.0 * t + 0.4).sin());
    follows("{ kind = \"sine\", frequency = 7.0, start = 0.1, duration = 0.3 }", |t| {
        inside(t, 0.1, 0.4) * (TAU * 7.0 * (t - 0.1)).sin()
    });
    follows("{ kind = \"sweep\", from = 2.0, to = 30.0, start = 0.1, duration = 0.3 }", |t| {
        let tau = t - 0.1;
        inside(t, 0.1, 0.4) * (TAU * (2.0 + 28.0 * tau / 0.6) * tau).sin()
    });
    follows("{ kind = \"table\", points = [[0.1, 0.0], [0.2, 1.0], [0.4, -1.0]] }", |t| match t {
        t if t < 0.1 => 0.0,
        t if t < 0.2 => (t - 0.1) / 0.1,
        t if t < 0.4 => 1.0 - (t - 0.2) / 0.1,
        _ => -1.0,
    });
    follows("{ kind = \"expression\", formula = \"2*exp(-3*t)*cos(2*pi*5*t)\" }", |t| {
        2.0 * (-3.0 * t).exp() * (TAU * 5.0 * t).cos()
    });
    follows(
        "{ kind = \"product\", factors = [{ kind = \"ramp\", duration = 0.2 }, { kind = \"sine\", frequency = 9.0 }] }",
        |t| (t / 0.2).min(1.0) * (TAU * 9.0 * t).sin(),
    );
}

/// Closed form: straight lines between the rows.
#[test]
fn a_csv_file_is_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pulse.csv");
    std::fs::write(&file, "# measured\ntime,factor\n0.0,0.5\n\n0.25, 1.5\n0.5,0.0\n").unwrap();
    follows(&format!("{{ kind = \"table\", file = {file:?} }}"), |t| {
        if t < 0.25 { 0.5 + 4.0 * t } else { 1.5 - 6.0 * (t - 0.25) }
    });
}

const SCENE: &str = r#"
title = "Stone"
units = { length = "m", mass = "kg", time = "s" }
[body.rigid]
mass = 2.0
center_of_mass = [0.0, 0.0, 0.0]
inertia = [[5.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 4.0]]
[[loads]]
kind = "force"
at = [1.0, 2.0, 3.0]
direction = [0.0, 1.0, 0.0]
amplitude = 6.0
history = HISTORY
[time]
end = 1.0
step = 0.01
"#;

fn message(history: &str, folder: &std::path::Path) -> String {
    let path = folder.join("stone.toml");
    match scene::Body::parse(&SCENE.replace("HISTORY", history), path) {
        Ok(scene) => crate::refusal(&scene).to_string(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_table_that_is_missing_or_wrong_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let of = |text: &str| {
        std::fs::write(folder.path().join("pulse.csv"), text).unwrap();
        message("{ kind = \"table\", file = \"pulse.csv\" }", folder.path())
    };
    let missing = message("{ kind = \"table\", file = \"none.csv\" }", folder.path());
    assert!(missing.contains("stone.toml:13:") && missing.contains("none.csv"), "{missing}");
    for (text, line, words) in [
        ("0,1\n0.5,two\n", "pulse.csv:2:", "found 2 field(s), 1 of them"),
        ("time,factor\n0,1\n# no\n0.5\n", "pulse.csv:4:", "found 1 field(s)"),
        ("0,1\n0.5,2\n0.5,3\n", "pulse.csv:3:", "0.5 after 0.5"),
        ("0,1\n1,nan\n", "pulse.csv:2:", "found 2 field(s), 1 of them"),
        ("0;1\n1;2\n", "pulse.csv:2:", "found 1 field(s)"),
        ("0,1\n", "pulse.csv:1:", "1 pairs of time and value"),
    ] {
        let message = of(text);
        assert!(message.contains(line) && message.contains(words), "{text:?}: {message}");
    }
}

#[test]
fn a_formula_that_is_none_or_has_no_value_is_refused_at_its_place() {
    let folder = tempfile::tempdir().unwrap();
    for (formula, words) in [("2*x", "x"), ("sin(t", "sin(t"), ("1/t", "at time 0"), ("sqrt(0.5-t)", "finite")] {
        let message = message(&format!("{{ kind = \"expression\", formula = \"{formula}\" }}"), folder.path());
        assert!(
            message.contains("stone.toml:13:") && message.contains("history") && message.contains(words),
            "{message}"
        );
    }
}

/// Closed form: ω = 3 sin 2πft of a driven hinge, which turns with the speed that its history says, and has its rate.
#[test]
fn a_motion_has_a_history_too() {
    let body = parse(
        r#"
title = "Crank"
units = { length = "m", mass = "kg", time = "s" }
[body.rigid]
mass = 2.0
center_of_mass = [1.0, 0.0, 0.0]
inertia = [[5.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 4.0]]
[[constraints]]
kind = "hinge"
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
motion = { amplitude = 3.0, history = { kind = "sine", frequency = 2.0 } }
[time]
end = 0.5
step = 1e-3
"#,
    );
    let model = crate::build(&body);
    for row in observations(&body, &model) {
        let angle = TAU * 2.0 * row.time;
        assert!((row.omega_body.z - 3.0 * angle.sin()).abs() < 1e-12);
        assert!((row.alpha_body.z - 3.0 * TAU * 2.0 * angle.cos()).abs() < 1e-9);
    }
}
