//! The trust card of a run: what is worst stands first, and what is not known is said.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use flexframe::columns::COLUMNS;
use results::Results;
use serde_json::Value;

use crate::program::command;

fn flexframe(arguments: &[&str]) -> Output {
    command(arguments).env("FLEXFRAME_CACHE", "").output().unwrap()
}

/// A rod that is held at one end and pushed across the other by a force, with its modes and how it is stepped; a mesh has the place of
/// its tip beside it.
pub(crate) fn scene(
    folder: &Path,
    name: &str,
    ([mesh, at], [modes, force, time, effects]): ([&str; 2], [&str; 4]),
) -> PathBuf {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    fs::copy(root.join(mesh), folder.join(format!("{name}.msh"))).unwrap();
    let text = format!(
        "title = \"Rod\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = \"{name}.msh\"\n\
         material = {{ young_modulus = 7e7, poisson_ratio = 0.0, density = 1000.0 }}\n\
         [modes]\n{modes}\ndamping_ratio = 0.7\n[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
         [[loads]]\nkind = \"force\"\nat = {at}\ndirection = [0.0, 0.0, 1.0]\namplitude = {force}\n\
         history = {{ kind = \"ramp\", duration = 3.0 }}\n[effects]\n{effects}\nrefuse = false\n\
         [output]\ninterval = 1.0\npoints = {{ tip = {at} }}\n[time]\nend = 5.0\n{time}\n"
    );
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text).unwrap();
    path
}

pub(crate) const COLUMN: [&str; 2] = ["crates/verification/meshes/column.msh", "[1.0, 0.0, 0.0]"];
/// An arc with an element across its wall.
pub(crate) const COARSE: [&str; 2] = ["crates/verification/meshes/quarter_arc.msh", "[0.0, 0.8, 0.8]"];
const LINEAR: &str = "large_deflection = false";
const MANY: &str = "flexible = 6\nstatic_correction = true";
const FINE: &str = "tolerance = 1e-6";

fn run(folder: &Path, scene: &Path, more: &[&str]) -> Value {
    let (scene, out) = (scene.to_str().unwrap(), folder.to_str().unwrap());
    let said = flexframe(&[&["run", scene, "-o", out, "--json"][..], more].concat());
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    serde_json::from_slice(&said.stdout).unwrap()
}

fn lines(report: &Value) -> &[Value] {
    report["trust"]["lines"].as_array().unwrap()
}

#[test]
fn each_fault_of_a_model_stands_first_on_its_card() {
    let folder = tempfile::tempdir().unwrap();
    for (place, next, described) in [
        ("mesh", "mesh_size", (COARSE, [MANY, "1e-3", FINE, LINEAR])),
        ("modes", "static shapes", (COLUMN, ["flexible = 2\nstatic_correction = false", "1e-3", FINE, LINEAR])),
        ("steps", "tolerance", (COLUMN, [MANY, "1e-3", "tolerance = 0.2", LINEAR])),
        ("model", "large modes", (COLUMN, [MANY, "1.4", FINE, LINEAR])),
    ] {
        let scene = scene(folder.path(), place, described);
        let report = run(folder.path(), &scene, &[]);
        let lines = lines(&report);
        let error = |line: &Value| line["error"].as_f64().unwrap();
        println!(
            "{place}: {:?}",
            lines.iter().map(|line| (line["place"].as_str().unwrap(), error(line))).collect::<Vec<_>>()
        );
        assert_eq!(lines.len(), 4);
        assert!(lines.windows(2).all(|pair| error(&pair[0]) >= error(&pair[1])), "{lines:?}");
        assert_eq!(lines[0]["place"], place, "{lines:?}");
        assert!(lines[0]["next"].as_str().unwrap().contains(next), "{lines:?}");
        assert!(lines.iter().all(|line| !line["known"].as_str().unwrap().is_empty() && line["body"].is_null()));
    }
}

/// Conserved: the error that the mesh makes of a frequency is that of its mode, whatever the state: elements have the stretch of a bar that
/// spins, and the card had 2e-7 of a frequency where `modes` has 2.6e-4.
#[test]
fn a_spin_that_the_elements_have_does_not_make_frequencies_right() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/rotating_bar.msh");
    let scene = folder.path().join("bar.toml");
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
         material = {{ young_modulus = 7e4, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 4\n\
         [initial]\nangular_velocity = [0.0, 0.0, 50.0]\n[time]\nend = 0.01\ntolerance = 1e-6\n"
    );
    fs::write(&scene, text).unwrap();
    let report = run(folder.path(), &scene, &["--no-check"]);
    let line = lines(&report).iter().find(|line| line["place"] == "mesh").unwrap();
    let modes = flexframe(&["modes", scene.to_str().unwrap(), "--json"]);
    let modes: Value = serde_json::from_slice(&modes.stdout).unwrap();
    let of_mode = modes["strain_energy"]["mesh_errors"][0].as_f64().unwrap();
    assert!((line["error"].as_f64().unwrap() / of_mode - 1.0).abs() < 1e-2, "{line} {of_mode}");
}

/// Conserved: the same card in JSON, in the results file, on its page, and in the summary.
#[test]
fn the_card_is_the_same_wherever_it_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), "rod", (COLUMN, ["flexible = 2", "1e-3", FINE, LINEAR]));
    let report = run(folder.path(), &scene, &[]);
    let file = folder.path().join("rod.h5");
    let of_file = Results::open(&file, &COLUMNS).unwrap().metadata.trust;
    assert_eq!(serde_json::to_value(&of_file).unwrap(), report["trust"]["lines"]);

    let path = file.to_str().unwrap();
    assert!(flexframe(&["report", path]).status.success());
    let page = fs::read_to_string(file.with_extension("html")).unwrap();
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    let page: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    assert_eq!(page["trust"]["unseen"], report["trust"]["unseen"]);
    for (line, on_page) in lines(&report).iter().zip(page["trust"]["lines"].as_array().unwrap()) {
        for key in ["place", "error", "meaning", "known", "next"] {
            assert_eq!(line[key], on_page[key], "{key}");
        }
        assert_eq!(on_page["body"], "");
    }

    let (scene, out) = (scene.to_str().unwrap(), folder.path().to_str().unwrap());
    let said = String::from_utf8(flexframe(&["run", scene, "-o", out, "--overwrite"]).stdout).unwrap();
    let mut after = said.lines().skip_while(|line| !line.starts_with("  trust "));
    for line in lines(&report) {
        let told = after.next().unwrap();
        assert!(
            told.contains(&format!(" {:<6} {}", line["place"].as_str().unwrap(), line["meaning"].as_str().unwrap())),
            "{told}"
        );
    }
    assert!(after.next().unwrap().contains("Not seen: "));
    // The check of all rows finds no less.
    let checked: Value = serde_json::from_slice(&flexframe(&["check", path, "--json"]).stdout).unwrap();
    let error = |report: &Value, place: &str| {
        lines(report).iter().find(|line| line["place"] == place).unwrap()["error"].as_f64().unwrap()
    };
    for place in ["mesh", "steps"] {
        assert_eq!(error(&checked, place), error(&report, place));
    }
    assert!(error(&checked, "modes") >= error(&report, "modes"));
    // Its card can be kept: then it is that of the file, whose rows are as they were.
    let before = Results::open(&file, &COLUMNS).unwrap();
    assert_eq!(serde_json::to_value(&before.metadata.trust).unwrap(), report["trust"]["lines"], "kept without --write");
    let kept: Value =
        serde_json::from_slice(&flexframe(&["check", path, "--rows", "1", "--write", "--json"]).stdout).unwrap();
    assert_ne!(kept["trust"], report["trust"]);
    let (mut after, shapes) = Results::open_with_shapes(&file, &COLUMNS).unwrap();
    assert_eq!(serde_json::to_value(&after.metadata.trust).unwrap(), kept["trust"]["lines"]);
    after.metadata.trust = before.metadata.trust.clone();
    assert_eq!(after, before);
    assert!(shapes[0].is_some());
    assert!(flexframe(&["report", path, "--overwrite"]).status.success());
}

#[test]
fn what_is_not_known_is_said_with_the_command_that_tells() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), "rod", (COLUMN, [MANY, "1e-3", FINE, LINEAR]));
    let report = run(folder.path(), &scene, &["--no-check"]);
    for place in ["modes", "model"] {
        let line = lines(&report).iter().find(|line| line["place"] == place).unwrap();
        assert!(line["error"].is_null());
        assert!(line["meaning"].as_str().unwrap().starts_with("not known: the run was made without the check"));
        assert_eq!(line["next"], "`flexframe check rod.h5`");
    }
    let small = |line: &Value| line["error"].as_f64().is_some_and(|error| error < 0.01);
    let first_small = lines(&report).iter().position(small).unwrap();
    assert!(lines(&report)[first_small..].iter().all(|line| !line["error"].is_null()));

    // The command tells.
    let file = folder.path().join("rod.h5");
    let checked: Value =
        serde_json::from_slice(&flexframe(&["check", file.to_str().unwrap(), "--json"]).stdout).unwrap();
    assert!(lines(&checked).iter().all(|line| line["error"].is_number()), "{checked}");
}

#[test]
fn a_rigid_body_is_taken_as_one_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), "rod", (COLUMN, ["flexible = 0", "1e-3", FINE, "coriolis = false"]));
    let text = fs::read_to_string(&scene).unwrap().replace("[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n", "");
    fs::write(&scene, text).unwrap();
    let report = run(folder.path(), &scene, &[]);
    let places: Vec<_> = lines(&report).iter().map(|line| line["place"].as_str().unwrap()).collect();
    assert_eq!(places[0], "model");
    assert!(lines(&report)[0]["meaning"].as_str().unwrap().contains("taken as rigid"));
}

/// The name of the worst body stands before its line.
#[test]
fn of_several_bodies_the_worst_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let report = run(folder.path(), &root.join("tests/two.toml"), &["--set", "time.end=0.002"]);
    let names: Vec<&str> =
        report["bodies"].as_array().unwrap().iter().map(|body| body["name"].as_str().unwrap()).collect();
    assert!(lines(&report).iter().all(|line| names.contains(&line["body"].as_str().unwrap())), "{report}");
}
