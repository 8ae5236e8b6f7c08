//! `flexframe equilibrium`, and a run that begins at one.

use std::fs;
use std::path::Path;

use flexframe::columns::COLUMNS;
use results::Results;
use serde_json::Value;

use crate::program::{flexframe, json, numbers};

/// A rod of 2 kg and 2 m on a hinge with a spring of moment, in an attitude about y.
fn rod(folder: &Path, root: &str, spring: &str) -> String {
    let file = folder.join("rod.toml").display().to_string();
    let text = format!(
        r#"
title = "Rod on a spring"
units = {{ length = "m", mass = "kg", time = "s" }}
{root}
[bodies.rod]
rigid = {{ mass = 2.0, center_of_mass = [1, 0, 0], inertia = [[0.01, 0, 0], [0, 0.67, 0], [0, 0, 0.67]] }}
markers = {{ end = {{ at = [0, 0, 0] }} }}
loads = [{{ kind = "gravity", direction = [0, 0, -1], amplitude = 9.81 }}]
[[joints]]
name = "hinge"
kind = "revolute"
between = ["ground", "rod.end"]
axis = [0, 1, 0]
{spring}
[time]
end = 2.0
tolerance = 1e-6
[output]
interval = 0.1
"#
    );
    fs::write(&file, text).unwrap();
    file
}

/// Closed form: k φ = m g l cos φ, φ the turn downwards from the x axis, and the weight in the hinge; the run stays there.
#[test]
fn a_rod_on_a_spring_hangs_where_moments_balance_and_a_run_begins_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = rod(folder.path(), "initial = \"equilibrium\"", "spring = { stiffness = 30.0 }");
    let found = json(&["equilibrium", &file]);
    let of_system = &found["systems"][0];
    let turn = of_system["joints"][0]["turn"].as_f64().unwrap();
    assert!((30.0 * turn - 2.0 * 9.81 * turn.cos()).abs() < 1e-9, "{of_system}");
    let force = numbers(&of_system["joints"][0]["force"]);
    assert!((force.iter().map(|x| x * x).sum::<f64>().sqrt() - 2.0 * 9.81).abs() < 1e-9, "{force:?}");
    assert_eq!((&of_system["stability"], &of_system["unstable"]), (&"stable".into(), &0.into()));
    let out = folder.path().join("out").display().to_string();
    let report = json(&["run", &file, "-o", &out]);
    assert_eq!(report["tied"][0]["equilibrium"]["unstable"], 0, "{report}");
    let results = Results::open(report["results"].as_str().unwrap(), &COLUMNS).unwrap();
    let spin =
        results.table("angular_velocity").unwrap().column(1).unwrap().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(spin < 1e-9, "{spin}");
}

/// Closed form: without the spring it hangs, and stands on its head unstably.
#[test]
fn the_other_equilibrium_and_faults_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = rod(folder.path(), "", "");
    let found = json(&["equilibrium", &file]);
    let of_system = &found["systems"][0];
    let height = |of: &Value| of["bodies"][0]["position"][2].as_f64().unwrap();
    assert!((height(of_system) + 1.0).abs() < 1e-12 && of_system["unstable"] == 0, "{of_system}");
    let others = of_system["others"].as_array().unwrap();
    assert!(others.len() == 1 && (height(&others[0]) - 1.0).abs() < 1e-9 && others[0]["unstable"] == 1, "{others:?}");
    let free = fs::read_to_string(&file).unwrap().replace("kind = \"revolute\"", "locked = [\"rx\"]");
    fs::write(&file, free).unwrap();
    let failed = flexframe(&["equilibrium", &file]);
    let words = String::from_utf8_lossy(&failed.stderr);
    assert!(words.contains("find no equilibrium") && words.contains("\"rod\""), "{words}");
    let alone = "title = \"x\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\ninitial = \"equilibrium\"\n\
                 [body]\nrigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n\
                 [time]\nend = 1.0\nstep = 0.1\n";
    fs::write(&file, alone).unwrap();
    let failed = flexframe(&["run", &file]);
    let words = String::from_utf8_lossy(&failed.stderr);
    assert!(words.contains("rod.toml:3") && words.contains("which moves alone"), "{words}");
}
