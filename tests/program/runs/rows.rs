//! How much a run writes: as many rows as a person would choose, estimate, and no room in proportion to the time.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use flexframe::columns::COLUMNS;
use flexframe::results::Results;
use flexframe::run::{Estimate, RunError, RunProgress, RunSettings, run};
use flexframe::scene::Body;

use crate::program::command_in;

/// A rigid body that spins.
const SCENE: &str = r#"
title = "Top"
units = { length = "m", mass = "kg", time = "s" }
body = { rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1.0, 0, 0], [0, 2.0, 0], [0, 0, 2.5]] } }
initial = { angular_velocity = [0.0, 0.0, 1e-3] }
"#;

fn scene(time: &str) -> Body {
    Body::parse(&format!("{SCENE}{time}"), "top.toml").unwrap()
}

/// Runs a scene. Returns what was estimate, what became of it, and the bytes of its file.
fn done(time: &str, folder: &Path) -> (Estimate, Result<u64, RunError>, u64) {
    let mut estimate = None;
    let settings = RunSettings { overwrite: true, ..RunSettings::default() };
    let done = run(&scene(time).into(), folder, &settings, |progress| {
        if let RunProgress::Estimate(told) = progress {
            estimate = Some(told);
        }
    });
    let rows = done.map(|(_, report)| {
        assert_eq!(Some(report.estimate), estimate);
        report.rows
    });
    let bytes = fs::metadata(folder.join("top.h5")).map_or(0, |file| file.len());
    (estimate.unwrap(), rows, bytes)
}

#[test]
fn a_long_run_has_some_thousand_rows_and_what_is_estimated_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (time, expected) in [
        ("time = { end = 20.0, step = 1.0 }", 21),
        ("time = { end = 5000.0, step = 1.0 }", 5001),
        ("time = { end = 20000.0, step = 1.0 }", 5001),
        ("time = { end = 20001.0, step = 1.0 }", 4002),
        ("time = { end = 1e6, tolerance = 1e-3 }", 501),
        ("time = { end = 7000.0, step = 1.0 }\noutput = { every = 1 }", 7001),
        ("time = { end = 1000.0, tolerance = 1e-3 }\noutput = { interval = 0.25 }", 4001),
    ] {
        let (estimate, rows, bytes) = done(time, folder.path());
        assert_eq!((estimate.rows, rows.unwrap()), (expected, expected), "{time}");
        // The rest is the scene, names and units.
        assert!(estimate.bytes <= bytes && bytes <= estimate.bytes + 200_000, "{time}: {estimate:?}, {bytes}");
        assert!(estimate.seconds.is_some_and(|seconds| seconds.is_finite() && seconds > 0.0), "{estimate:?}");
    }
}

#[test]
fn more_than_a_gigabyte_is_refused_unless_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let time = "time = { end = 1e6, step = 0.1 }\noutput = { every = 1 }";
    let Err(error) = run(&scene(time).into(), folder.path(), &RunSettings::default(), |_| ()) else { panic!() };
    let text = error.to_string();
    assert!(matches!(error, RunError::Large { estimate: Estimate { rows: 10_000_001, .. }, .. }), "{text}");
    assert!(text.contains("10000001 rows, ") && text.contains(" GB") && text.contains("--large"), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    // Asked for, it takes room as it goes on, not for all rows at once.
    let settings = RunSettings { large: true, stop: Arc::new(AtomicBool::new(true)), ..RunSettings::default() };
    let Err(RunError::Stopped { part, .. }) = run(&scene(time).into(), folder.path(), &settings, |_| ()) else {
        panic!()
    };
    assert!(fs::metadata(part).unwrap().len() < 100 << 20);
}

/// The memory that a run takes at the most, of its process.
#[test]
#[cfg(target_os = "linux")]
fn the_memory_of_a_run_does_not_go_with_its_end() {
    const END: &str = "FLEXFRAME_END_OF_RUN";
    if let Ok(end) = std::env::var(END) {
        let folder = tempfile::tempdir().unwrap();
        run(
            &scene(&format!("time = {{ end = {end}, tolerance = 1e-3 }}")).into(),
            folder.path(),
            &RunSettings::default(),
            |_| (),
        )
        .unwrap();
        println!("{}", fs::read_to_string("/proc/self/status").unwrap());
        return;
    }
    let peak = |end: &str| -> u64 {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "runs::rows::the_memory_of_a_run_does_not_go_with_its_end", "--nocapture"])
            .env(END, end)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_else(|| panic!("{text}"));
        line.split_whitespace().next().unwrap().parse().unwrap()
    };
    let [short, long] = ["1.0", "1e6"].map(peak);
    assert!(long < short + 20_000, "{short} kB with the end at 1, {long} kB at 1e6");
}

#[test]
fn the_terminal_and_the_summary_say_what_a_run_will_come_to() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("top.toml"), format!("{SCENE}time = {{ end = 20.0, step = 1.0 }}")).unwrap();
    let flexframe = |more: &[&str]| -> Output {
        command_in(folder.path(), &[&["run", "top.toml", "--overwrite"], more].concat()).output().unwrap()
    };
    let told = String::from_utf8(flexframe(&[]).stderr).unwrap();
    assert!(told.contains("run: 21 rows, 1 MB, less than a second\n"), "{told}");
    let output = flexframe(&["--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.stderr.len(), &report["estimate"]["rows"]), (0, &21.into()), "{report}");
    assert!(report["estimate"]["bytes"].is_u64() && report["estimate"]["seconds"].is_number(), "{report}");
    let large = flexframe(&["--set", "time.end=1e7", "--set", "output.every=1", "--json"]);
    let failure: serde_json::Value = serde_json::from_slice(&large.stderr).unwrap();
    assert_eq!((large.status.code(), &failure["key"]), (Some(4), &"output.interval".into()), "{failure}");
}

/// Closed form: a body on a slider stays where it is while its support is shaken along it; one on a hinge across goes with it.
#[test]
fn accelerations_are_absolute_and_relative_to_a_shaken_support_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let body = SCENE.replace("initial = { angular_velocity = [0.0, 0.0, 1e-3] }", "");
    let course = |time: f64| 3.0 * (std::f64::consts::PI * time).sin();
    for (support, slides) in [
        ("kind = \"slider\", direction = [0, 0, 1]", true),
        ("kind = \"hinge\", at = [0, 0, 0], axis = [0, 0, 1]", false),
    ] {
        let text = format!(
            "{body}constraints = [{{ {support} }}]\n\
             loads = [{{ kind = \"base-acceleration\", direction = [0, 0, 1], amplitude = 3.0, history = {{ kind = \"half-sine\", duration = 1.0 }} }}]\n\
             time = {{ end = 1.0, step = 0.01 }}\noutput = {{ points = {{ P = [0.5, 0, 0] }} }}"
        );
        let given = Body::parse(&text, "top.toml").unwrap();
        let settings = RunSettings { overwrite: true, ..RunSettings::default() };
        run(&given.into(), folder.path(), &settings, |_| ()).unwrap();
        let results = Results::open(folder.path().join("top.h5"), &COLUMNS).unwrap();
        let along = |path: &str| -> Vec<f64> {
            results.vectors::<3>(path).unwrap_or_else(|| panic!("{path}")).iter().map(|vector| vector[2]).collect()
        };
        let times = results.numbers("time").unwrap();
        let names = ["acceleration", "acceleration_relative", "rigid_acceleration"];
        let [absolute, relative, rigid] = names.map(|name| along(&format!("bodies/body/points/P/{name}")));
        for (row, time) in times.iter().enumerate() {
            let expected = if slides { [0.0, -course(*time)] } else { [course(*time), 0.0] };
            assert!((absolute[row] - expected[0]).abs() < 1e-12, "{support}: {} at {time}", absolute[row]);
            assert!((relative[row] - expected[1]).abs() < 1e-12, "{support}: {} at {time}", relative[row]);
            assert!((rigid[row] - expected[0]).abs() < 1e-12, "{support}: {} at {time}", rigid[row]);
        }
    }
}
