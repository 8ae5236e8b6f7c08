//! `[modes] measured`: frequencies and damping of a test in the place of the model's.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{command_in, numbers};

fn mesh() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/rotating_bar.msh"))
}

/// The report of `flexframe modes` about the free bar with a table, or its refusal.
fn modes(folder: &Path, table: &str) -> Result<Value, String> {
    std::fs::write(folder.join("test.csv"), table).unwrap();
    report(folder, "measured = \"test.csv\"")
}

/// The frequencies of the model.
fn own(folder: &Path) -> Vec<f64> {
    numbers(&report(folder, "").unwrap()["body"]["natural_frequencies"])
}

fn report(folder: &Path, measured: &str) -> Result<Value, String> {
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"{}\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 5\n\
         damping_ratio = 0.01\n{measured}\n[time]\nend = 0.01\ntolerance = 1e-6\n\
         [output]\npoints = {{ tip = [202.07, 0.0, 0.0], middle = [100.0, 0.0, 0.0], root = [0.0, 0.0, 0.0] }}\n",
        mesh().display()
    );
    std::fs::write(folder.join("bar.toml"), text).unwrap();
    let scene = folder.join("bar.toml");
    let output = command_in(folder, &["modes", scene.to_str().unwrap(), "--json"]).output().unwrap();
    if output.status.success() {
        Ok(serde_json::from_slice(&output.stdout).unwrap())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

fn close(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 1e-12
}

#[test]
fn a_table_replaces_the_first_modes_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let found = modes(folder.path(), "# test of May\nfrequency, damping\n1290.5,0.004\n\n1300.25,\n").unwrap();
    let (frequencies, damping) =
        (numbers(&found["body"]["natural_frequencies"]), numbers(&found["body"]["damping_ratios"]));
    assert!(close(frequencies[0], 1290.5) && close(frequencies[1], 1300.25), "{frequencies:?}");
    assert_eq!(damping, [0.004, 0.01, 0.01, 0.01, 0.01]);
    assert_eq!(frequencies[2..], own(folder.path())[2..]);
}

/// Closed form: the second bending of a free bar moves its ends against each other, and its middle not at all; the first one moves both
/// ends by 1 and the middle by −0.608.
#[test]
fn shapes_say_which_modes_are_meant() {
    let folder = tempfile::tempdir().unwrap();
    let own = own(folder.path());
    let head = "frequency,tip.y,tip.z,middle.y,middle.z,root.y,root.z\n";
    // Modes of bending come in pairs, whose planes are those of rounding.
    let second = modes(folder.path(), &format!("{head}3500,1,0,0,0,-1,0\n")).unwrap();
    let changed = |found: &Value| -> Vec<usize> {
        let now = numbers(&found["body"]["natural_frequencies"]);
        (0..now.len()).filter(|k| now[*k] != own[*k]).collect()
    };
    assert!(matches!(changed(&second)[..], [2 | 3]), "{:?}", changed(&second));
    let first = modes(folder.path(), &format!("{head}1200,1,0,-0.6,0,1,0\n")).unwrap();
    assert!(matches!(changed(&first)[..], [0 | 1]), "{:?}", changed(&first));
}

#[test]
fn bad_tables_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |table: &str, words: &[&str]| {
        let message = modes(folder.path(), table).unwrap_err();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    refused("", &["no measured mode", "modes.measured"]);
    refused("frequency\n", &["no measured mode"]);
    refused("10.0\n", &["another name of the column 1", "POINT.x"]);
    refused("damping\n0.1\n", &["a column that is there twice, or no `frequency`"]);
    refused("frequency,tip.x,tip.x\n1,1,1\n", &["each column once"]);
    refused("frequency\n-3\n", &["test.csv", "the frequency -3", "above 0"]);
    refused("frequency\nNaN\n", &["the frequency NaN"]);
    refused("frequency,damping\n3,-0.1\n", &["the damping -0.1"]);
    refused("frequency,damping\n3\n", &["1 field(s) in the line", "2, one for each column"]);
    refused("frequency\n3\n2\n", &["the frequency 2.0 after 3.0", "rise"]);
    refused("frequency\n1\n2\n3\n4\n5\n6\n", &["6 entries"]);
    // In rad/s.
    refused("frequency\n8108.4\n", &["8108.4 in line 2, for mode 1", "off by less than 3 times", "cycles per time"]);
    refused("frequency,tip.y\n3,0\n", &["a shape of zeros"]);
    refused("frequency,nose.y\n3,1\n", &["a shape at the point `nose`", "tip"]);
    refused("frequency,tip.x,middle.x,root.x\n3,1,-3,1\n", &["MAC with the mode most like it"]);
    let head = "frequency,tip.y,tip.z,middle.y,middle.z,root.y,root.z\n";
    refused(&format!("{head}3500,1,0,0,0,-1,0\n3600,1,0,0,0,-1,0\n"), &["lines 2 and 3, both most like mode"]);
}
