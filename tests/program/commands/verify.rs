//! `flexframe verify`: published benchmarks.

use std::fs;
use std::process::Output;

use crate::program::{command, done, json, numbers};

/// Independent reference: the published numbers of the cases.
#[test]
fn quick_benchmarks_pass_or_are_known_misses() {
    let found = json(&["verify", "--quick"]);
    assert_eq!(found["misses"], 0, "{found}");
    assert!(found["passed"].as_u64().unwrap() > 20, "{found}");
    let rows = found["benchmarks"].as_array().unwrap();
    let known = |row: &&serde_json::Value| row["verdict"] == "miss (known)" && row["reason"].is_null();
    assert_eq!(rows.iter().find(known), None);
}

const SPECTRUM: &str = r#"title = "A rectangle"
kind = "shock"
source = "Closed form: 2 sin(π f D)"
command = "srs pulse.csv --damping 0 --frequencies 0.25:0.5:2"
quick = true

[[compare]]
quantity = "acceleration"
published = [1.4142136, 2.0]
relative = 1e-6
table = "srs.csv"
column = "acceleration_largest_0"
at = [0.25, 0.5]
"#;

/// A folder of one case, which is not in the sources.
fn folder(case: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("rectangle")).unwrap();
    fs::write(folder.path().join("rectangle/case.toml"), case).unwrap();
    fs::write(folder.path().join("rectangle/pulse.csv"), "time,acceleration\n0,1\n1,1\n").unwrap();
    folder
}

fn verify(folder: &tempfile::TempDir, more: &[&str]) -> Output {
    let cases = folder.path().to_str().unwrap();
    command(&[&["verify", "--cases", cases], more].concat()).output().unwrap()
}

/// Closed form: the residual of a rectangular pulse.
#[test]
fn a_folder_is_a_case() {
    let folder = folder(SPECTRUM);
    let out = folder.path().join("out");
    let found = verify(&folder, &["--output", out.to_str().unwrap()]);
    let text = String::from_utf8(found.stdout).unwrap();
    assert!(found.status.success() && text.contains("2 numbers pass"), "{text}");
    assert!(fs::read_to_string(out.join("benchmarks.md")).unwrap().contains("**rectangle**, A rectangle"));
    assert!(["srs.csv", "page.md", "figure1.svg"].iter().all(|file| out.join("rectangle").join(file).is_file()));
    // What is there stays.
    let again = verify(&folder, &["--output", out.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&again.stderr).contains("benchmarks.md: this file is there already"));
    let own = verify(&folder, &["--output", folder.path().to_str().unwrap(), "--overwrite"]);
    assert!(own.status.success());
    let listed = done(&["verify", "--list", "--cases", folder.path().to_str().unwrap()]);
    assert!(listed.contains("rectangle  shock  quick  A rectangle"), "{listed}");
}

/// Conserved: the tolerance decides, and a reason does not make a number pass.
#[test]
fn a_miss_stays_a_miss() {
    let wrong = SPECTRUM.replace("2.0]", "2.1]");
    let found = verify(&folder(&wrong), &["--json"]);
    assert_eq!(found.status.code(), Some(5));
    let report: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    assert_eq!((&report["passed"], &report["misses"]), (&1.into(), &1.into()));
    let differences: Vec<_> =
        report["benchmarks"].as_array().unwrap().iter().map(|row| row["difference"].clone()).collect();
    let differences = numbers(&differences.into());
    assert!(differences[0].abs() < 1e-6 && (differences[1] + 0.1 / 2.1).abs() < 1e-6, "{differences:?}");

    let known = format!("{wrong}miss = \"a misprint\"\n");
    let found = verify(&folder(&known), &[]);
    let text = String::from_utf8(found.stdout).unwrap();
    assert!(found.status.success() && text.contains("1 are known misses, 0 miss"), "{text}");
    assert!(text.contains("rectangle: a miss: a misprint"), "{text}");
    let found = verify(&folder(&format!("{SPECTRUM}miss = \"none\"\n")), &[]);
    assert!(
        String::from_utf8(found.stdout).unwrap().contains("line 7 of its case names a reason for a miss, and passes")
    );
}

#[test]
fn faults_of_a_case_are_told_with_their_place() {
    for (from, to, code, words) in [
        ("title", "titel", 3, "case.toml:1: unknown field `titel`"),
        ("srs pulse", "ls pulse", 3, "case.toml:4: command: found ls pulse.csv"),
        (
            "relative = 1e-6",
            "relative = 1e-6\nabsolute = 1.0",
            3,
            "case.toml:7: compare.relative: found no tolerance, or two",
        ),
        ("[0.25, 0.5]", "[0.25]", 3, "compare.published: found 2 values, expected as many places"),
        (
            "[0.25, 0.5]",
            "[0.25, 0.7]",
            3,
            "case.toml:7: compare.at: found 0.7, expected a row of the 2 from 0.25 to 0.5",
        ),
        (
            "acceleration_largest_0",
            "velocity",
            3,
            "compare.column: found velocity, expected one of the columns of srs.csv: frequency, displacement_0",
        ),
        ("--damping 0", "--damping none", 2, "invalid value 'none' for '--damping"),
    ] {
        let found = verify(&folder(&SPECTRUM.replacen(from, to, 1)), &[]);
        let text = String::from_utf8([found.stdout, found.stderr].concat()).unwrap();
        assert_eq!(found.status.code(), Some(code), "{to}: {text}");
        assert!(text.contains(words), "{to}: {text}");
    }
    let points =
        SPECTRUM.replace("published = [1.4142136, 2.0]", "points = \"read.csv\"").replace("at = [0.25, 0.5]", "");
    let of_points = folder(&points);
    let table = of_points.path().join("rectangle/read.csv");
    fs::write(&table, "frequency,acceleration\n0.25,1.4142136\n0.5,2.0\n").unwrap();
    assert!(String::from_utf8(verify(&of_points, &[]).stdout).unwrap().contains("2 numbers pass"));
    fs::write(&table, "frequency,acceleration\n0.25\n").unwrap();
    let text = String::from_utf8(verify(&of_points, &[]).stderr).unwrap();
    assert!(text.contains("case.toml:7: compare.points: found \"0.25\" in line 2 of read.csv"), "{text}");
    let found = verify(&folder(SPECTRUM), &["triangle"]);
    let text = String::from_utf8(found.stderr).unwrap();
    assert!(found.status.code() == Some(2) && text.contains("found triangle, expected names of cases"), "{text}");
}
