//! `flexframe srs` as its users meet it.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program::command_in;

fn srs(folder: &Path, arguments: &[&str]) -> Output {
    command_in(folder, &[&["srs"], arguments].concat()).output().unwrap()
}

/// A half sine of 10 g in 10 ms, with names of columns, a comment and an empty line.
fn half_sine(folder: &Path) {
    let mut text = "# drop test\ntime,acceleration\n\n".to_owned();
    for k in 0..=1000 {
        let part = f64::from(k) / 1000.0;
        writeln!(text, "{:e},{:e}", 0.01 * part, 98.1 * (PI * part).sin()).unwrap();
    }
    std::fs::write(folder.join("drop.csv"), text).unwrap();
}

#[test]
fn the_spectrum_of_a_half_sine_is_written() {
    let folder = tempfile::tempdir().unwrap();
    half_sine(folder.path());
    let output = srs(folder.path(), &["drop.csv", "--frequencies", "25:100:3", "--damping", "0,0.05", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    // Closed form: the undamped spectrum of a half sine is 4 cos(π/4)/3 of its height where the period is four durations, and
    // sin(2π/3)/(1/2) where it is one (tests of the crate shock).
    let expected = [4.0 * (PI / 4.0).cos() / 3.0, (2.0 * PI / 3.0).sin() / 0.5];
    let csv = std::fs::read_to_string(folder.path().join("out/drop/srs.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().collect();
    assert!(
        rows[0].starts_with("frequency,displacement_0,pseudo_velocity_0,pseudo_acceleration_0,acceleration_largest_0")
    );
    assert_eq!(rows[0].split(',').count(), 11);
    for (at, expected) in [(0, expected[0]), (2, expected[1])] {
        let found = report["spectra"][0]["acceleration_largest"][at].as_f64().unwrap() / 98.1;
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        let row: Vec<f64> = rows[1 + at].split(',').map(|field| field.parse().unwrap()).collect();
        assert!((row[4] / 98.1 / found - 1.0).abs() < 1e-14); // a reader of JSON may be off by the last bit
        // Without damping the acceleration of the mass is ω² z.
        assert!((row[3] / 98.1 / expected - 1.0).abs() < 1e-5);
    }
    for kind in ["svg", "pdf", "png"] {
        assert!(folder.path().join(format!("out/drop/srs.{kind}")).is_file());
    }
    // A coarse table of the same pulse is straight or smooth between its rows, and the answer says which. Closed form: the pulse itself.
    let sampled: String = (0..=8)
        .map(|k| format!("{:e},{:e}\n", 1.25e-3 * f64::from(k), 98.1 * (PI * f64::from(k) / 8.0).sin()))
        .collect();
    std::fs::write(folder.path().join("coarse.csv"), sampled).unwrap();
    let off = |way: &str, words: &str| {
        let output = srs(
            folder.path(),
            &["coarse.csv", "--frequencies", "25:100:3", "--damping", "0", "--interpolation", way, "--overwrite"],
        );
        assert!(String::from_utf8_lossy(&output.stdout).contains(words), "{output:?}");
        let csv = std::fs::read_to_string(folder.path().join("out/coarse/srs.csv")).unwrap();
        let row: Vec<f64> = csv.lines().nth(1).unwrap().split(',').map(|field| field.parse().unwrap()).collect();
        (row[4] / 98.1 / expected[0] - 1.0).abs()
    };
    let [straight, smooth] =
        [off("linear", "straight lines between rows"), off("monotone-cubic", "monotone cubics between rows")];
    println!("{straight:e} {smooth:e}");
    assert!(straight > 1e-2 && smooth < 3e-3, "{straight} {smooth}");
    let again = srs(folder.path(), &["drop.csv", "--frequencies", "25:100:3"]);
    assert_eq!(again.status.code(), Some(6), "what is there is not written over");
}

#[test]
fn bad_tables_and_ranges_are_told_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let bad = |text: &str, arguments: &[&str], code: i32, expected: &[&str]| {
        std::fs::write(folder.path().join("bad.csv"), text).unwrap();
        let output = srs(folder.path(), &[&["bad.csv"], arguments].concat());
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(expected.iter().all(|part| told.contains(part)), "{told}");
    };
    let range = ["--frequencies", "1:10:5"];
    bad("t,a\n0,1\n1,two\n", &range, 3, &["bad.csv:3", "1 of them finite", "correct the line"]);
    bad("0,1\n0,2\n", &range, 3, &["bad.csv:2", "rise"]);
    bad("0,1\n", &range, 3, &["bad.csv:1", "two or more"]);
    bad("0,1\n1,2\n", &["--frequencies", "0:10:5"], 2, &["0 < start"]);
    bad("0,1\n1,2\n", &["--frequencies", "1:10:5", "--damping", "-1"], 2, &["damping ratio", "0 or more"]);
    bad("0,1\n1,2\n", &["--frequencies", "1:1e9:5"], 2, &["cycles", "cut the base motion"]);
}
