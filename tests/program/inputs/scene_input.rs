//! Scenes from standard input, and values of their keys from the command line.

use std::io::Write;
use std::process::{Output, Stdio};

use flexframe::columns::COLUMNS;
use results::Results;
use serde_json::Value;

use crate::program::command;

fn flexframe(arguments: &[&str], input: &str) -> Output {
    let mut child = command(arguments);
    let mut child = child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A command that does not read its input closes it.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn values_are_set_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let arguments =
        ["run", "examples/heavy_top.toml", "-o", out, "--json", "--set", "time.end = 0.25", "--set", "title=A top"];
    let report = json(&flexframe(&arguments, ""));
    assert_eq!(report["title"], "A top");
    let results = Results::open(folder.path().join("heavy_top.h5"), &COLUMNS).unwrap();
    assert!(results.metadata.scene_text.contains("end = 0.25"));
}

#[test]
fn a_scene_comes_from_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let scene = include_str!("../../../examples/heavy_top.toml");
    json(&flexframe(&["run", "-", "-o", out, "--json", "--set", "time.end=0.25"], scene));
    assert!(folder.path().join("stdin.h5").is_file());
    let broken = flexframe(&["run", "-", "-o", out], "title = 3\n");
    assert_eq!(broken.status.code(), Some(3));
    let words = String::from_utf8_lossy(&broken.stderr).into_owned();
    assert!(words.contains("stdin:1:9: `title`"), "{words}");
}

#[test]
fn a_key_that_leads_nowhere_is_a_wrong_argument_and_a_wrong_value_a_wrong_scene() {
    for (set, code, words) in [
        ("title.end=1", 2, "`end` in a value that is a text"),
        ("time.end", 2, "expected KEY=VALUE"),
        ("time.end=-1", 3, "error: --set time.end=-1: found -1, expected a number greater than 0\n = "),
        ("time.edn=1", 3, "error: --set time.edn=1: found edn, expected one of `end`"),
        ("units.length=mn", 3, "error: --set units.length=\"mn\": found \"mn\", expected `mm`"),
    ] {
        let output = flexframe(&["run", "examples/heavy_top.toml", "--set", set], "");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{set}: {said}");
        assert!(said.contains(words), "{set}: {said}");
    }
}

/// A key that is added moves the lines behind it.
#[test]
fn a_fault_of_the_scene_is_shown_at_its_line_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("ball.toml");
    let text = "title = \"ball\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[time]\nend = 1.0\n[body]\n\
                rigid = { mass = -1, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n";
    std::fs::write(&scene, text).unwrap();
    let output = flexframe(&["run", scene.to_str().unwrap(), "--set", "time.step=0.1"], "");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("ball.toml:6:18: `body.rigid.mass`: found -1"), "{said}");
}

#[test]
fn shells_complete_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let output = flexframe(&["completions", shell], "");
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && script.contains("campbell"), "{shell}");
    }
}
