//! The list of files that are read: what keeps outputs off them, and what rows of sweeps and unfinished runs are known by.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use flexframe::model::Builder;
use flexframe::run::{RunError, RunSettings, resume, run};
use flexframe::scene::Scene;

use super::files_opened::EVERY_KEY;
use crate::program::command_in;

#[test]
fn every_key_with_a_path_is_in_the_list_of_files_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut names: BTreeSet<&str> = EVERY_KEY
        .split('"')
        .filter(|word| [".csv", ".inp", ".h5", ".mtx", ".txt"].iter().any(|end| word.ends_with(end)))
        .collect();
    for name in &names {
        fs::write(at(name), "0, 0\n1, 1\n").unwrap();
    }
    fs::write(at("measured.csv"), "frequency\n10\n").unwrap();
    fs::write(at("deck.inp"), "*INCLUDE, INPUT=included.txt\n").unwrap();
    fs::write(at("included.txt"), "").unwrap();
    names.extend(["scene.toml", "included.txt"]);
    let scene = Scene::parse(EVERY_KEY, at("scene.toml")).unwrap();
    let files = Builder::default().files(&scene);
    assert_eq!(files.iter().collect::<BTreeSet<_>>().len(), files.len(), "{files:?}");
    let expected: BTreeSet<PathBuf> = names.into_iter().map(at).collect();
    assert_eq!(files.into_iter().collect::<BTreeSet<_>>(), expected);
}

/// A wheel on a motor of a table.
const WHEEL: &str = r#"
title = "wheel"
units = { length = "m", mass = "kg", time = "s" }

[bodies.wheel]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }
markers = { hub = { at = [0, 0, 0] } }

[[joints]]
name = "axle"
kind = "revolute"
axis = [0, 0, 1]
between = ["ground", "wheel.hub"]
motor = { amplitude = 1.0, history = { kind = "table", file = "motor.csv" } }

[time]
end = 1.0
tolerance = 1e-6

[output]
interval = 0.01
"#;
const SWEEP: &str = "scene = \"wheel.toml\"\nparameters = { \"joints[0].motor.amplitude\" = [1.0, 2.0] }\n\
                     results = { rate = { final = \"joints/axle/rate\" } }\n";

fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("wheel.toml", WHEEL), ("motor.csv", "0, 1\n1, 1\n"), ("sweep.toml", SWEEP)] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = command_in(folder, arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn refused(folder: &Path, arguments: &[&str], words: &str) {
    let output = command_in(folder, arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && text.contains(words), "{arguments:?}: {text}");
}

#[test]
fn a_table_of_a_motor_is_never_written_over() {
    let folder = desk();
    done(folder.path(), &["run", "wheel.toml", "-o", "."]);
    let table = fs::read(folder.path().join("motor.csv")).unwrap();
    // By another name, which the command takes for its own.
    fs::hard_link(folder.path().join("motor.csv"), folder.path().join("wheel.csv")).unwrap();
    refused(folder.path(), &["export", "wheel.h5", "--csv", ".", "--overwrite"], "this file is read by the command");
    refused(
        folder.path(),
        &["linearize", "wheel.toml", "-o", "motor.csv", "--overwrite"],
        "this file is read by the command",
    );
    assert!(fs::read(folder.path().join("motor.csv")).unwrap() == table);
}

#[test]
fn rows_of_a_sweep_follow_from_the_table_of_a_motor() {
    let folder = desk();
    let rates = || {
        done(folder.path(), &["sweep", "sweep.toml", "-o", "sweep.h5"]);
        fs::read_to_string(folder.path().join("sweep.csv")).unwrap()
    };
    let first = rates();
    fs::write(folder.path().join("motor.csv"), "0, 100\n1, 100\n").unwrap();
    assert_ne!(rates(), first);
}

#[test]
fn a_run_with_joints_does_not_go_on_with_another_table() {
    let folder = desk();
    let scene = Scene::read(folder.path().join("wheel.toml")).unwrap();
    let settings = RunSettings { rows_alone: false, check: false, ..RunSettings::default() };
    // The run stops at its first row.
    let asked = RunSettings { stop: Arc::new(AtomicBool::new(true)), ..settings.clone() };
    let stopped = run(&scene, folder.path(), &asked, |_| ());
    let Err(RunError::Stopped { part, .. }) = stopped else { panic!("{stopped:?}") };
    fs::write(folder.path().join("motor.csv"), "0, 1\n1, 2\n").unwrap();
    let refused = resume(&part, &settings, |_| ());
    let Err(error @ RunError::Restore { .. }) = refused else { panic!("{refused:?}") };
    assert!(error.to_string().contains("the joint \"axle\""), "{error}");
    fs::write(folder.path().join("motor.csv"), "0, 1\n1, 1\n").unwrap();
    resume(&part, &settings, |_| ()).unwrap();
}

/// A pipe in the place of a file that a run once read would wait for somebody to write into it.
#[test]
fn a_pipe_among_the_files_of_a_run_is_not_waited_for() {
    let folder = desk();
    done(folder.path(), &["run", "wheel.toml", "-o", "."]);
    fs::write(folder.path().join("wheel.csv"), "old").unwrap();
    fs::remove_file(folder.path().join("motor.csv")).unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("motor.csv")).status().unwrap().success());
    done(folder.path(), &["export", "wheel.h5", "--csv", ".", "--overwrite"]);
}

/// docs/reference/body.md: a cache that cannot be written is a warning.
#[test]
fn a_body_file_is_written_where_the_cache_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    let bar = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/model/tests/data/bar.msh"));
    fs::copy(bar, folder.path().join("bar.msh")).unwrap();
    let scene = "title = \"bar\"\nunits = { length = \"mm\", mass = \"Mg\", time = \"s\" }\n[body]\nmesh = \"bar.msh\"\n\
                 material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }\n[modes]\nflexible = 2\n\
                 [time]\nend = 1e-3\nstep = 1e-5\n";
    fs::write(folder.path().join("bar.toml"), scene).unwrap();
    fs::write(folder.path().join("cache"), "no folder").unwrap();
    let mut command = command_in(folder.path(), &["reduce", "bar.toml", "-o", "body.h5"]);
    let output = command.env("FLEXFRAME_CACHE", folder.path().join("cache")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let all = format!("{said}{}", String::from_utf8_lossy(&output.stdout));
    assert!(all.contains("cannot be written, and what is computed is not kept"), "{all}");
    assert!(folder.path().join("body.h5").is_file());
}
