//! Scenes whose bodies joints tie together: runs, their rows, and the ways to go on.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use flexframe::columns::COLUMNS;
use flexframe::run::{RunError, RunProgress, RunSettings, resume, run};
use flexframe::scene::System;
use results::Results;

const SCENE: &str = include_str!("../../tied.toml");

fn system() -> System {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tied.toml"));
    System::parse(SCENE, file).unwrap()
}

/// Independent reference: the angle of the rod and the place of the slider at 0.1 s, of the plane beam of Simeon (1998).
#[test]
fn a_slider_crank_runs_from_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let (_, report) = run(&system(), folder.path(), &RunSettings::default(), |_| ()).unwrap();
    assert!(report.bodies.iter().all(|body| body.balances.energy < 1e-3), "{:?}", report.bodies);
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let last = results.rows() - 1;
    let slider = results.vectors::<3>("bodies/slider/position").unwrap()[last];
    let pin =
        results.numbers("joints/pin/angle").unwrap()[last] + results.numbers("joints/bearing/angle").unwrap()[last];
    assert!((slider[0] - 0.169_737_332_842_786).abs() < 1e-6, "{slider:?}");
    // A pin turns with the bent end of the rod.
    let turns = pin / std::f64::consts::TAU;
    assert!((pin + 0.331_173_498_825_626 - turns.round() * std::f64::consts::TAU).abs() < 2e-2, "{pin}");
    assert!((results.numbers("joints/bearing/angle").unwrap()[last] - 15.0).abs() < 1e-12);
    assert!((results.numbers("joints/guide/position").unwrap()[last] - slider[0]).abs() < 1e-12);
    // Conserved: energy is what the drive has put in.
    let drive = results.numbers("joints/bearing/drive_work").unwrap();
    let energy = results.numbers("system/energy/total").unwrap();
    let largest = energy.iter().fold(0.0_f64, |most, energy| most.max(*energy));
    assert!(
        (energy[last] - energy[0] - drive[last]).abs() < 2e-3 * largest,
        "{} {}",
        energy[last] - energy[0],
        drive[last]
    );
}

/// Conserved: the bytes of the file, with and without an interruption.
#[test]
fn a_run_with_joints_goes_on_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, cut) = (folder.path().join("whole"), folder.path().join("cut"));
    let settings = RunSettings { rows_alone: true, ..RunSettings::default() };
    let (_, report) = run(&system(), &whole, &settings, |_| ()).unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let asked = RunSettings { stop: stop.clone(), ..settings.clone() };
    let stopped = run(&system(), &cut, &asked, |progress| {
        if matches!(progress, RunProgress::Motion(part) if part > 0.3) {
            stop.store(true, Ordering::Relaxed);
        }
    });
    let Err(RunError::Stopped { part, .. }) = stopped else { panic!("{stopped:?}") };
    let resumed = resume(&part, &settings, |_| ()).unwrap();
    let read = |path: &Path| std::fs::read(path).unwrap();
    assert!(read(&report.results) == read(&resumed.results));
}
