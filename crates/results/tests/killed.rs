//! What survives when a run is killed.
//!
//! In a process apart from the other tests: a child inherits the files that its parent has open, with HDF5's locks.

mod rows;

use results::Results;
use rows::{Row, assert_rows, folder, metadata, write};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Not a test of its own: the process that [`a_killed_run_can_be_read_up_to_its_last_flush`] kills.
#[test]
#[ignore = "run by another test"]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let mut writer = write(Path::new(&path), 700, &metadata(2, &["P1"]));
    std::thread::sleep(Duration::from_millis(1100));
    // This row is late enough for a flush, the next hundred are not.
    for i in 700..801 {
        writer.push(&Row::new(i, 2, 1).sample()).unwrap();
    }
    std::process::abort();
}

#[test]
fn a_killed_run_can_be_read_up_to_its_last_flush() {
    let (_folder, path) = folder();
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_is_killed", "--ignored"])
        .env("RESULTS_TEST_CHILD", &path)
        .output()
        .unwrap()
        .status;
    assert!(!status.success(), "the child was to abort");
    let results = Results::open(&path).unwrap();
    assert!(!results.complete);
    assert!(results.time.len() >= 701, "{}", results.time.len());
    assert_rows(&results, results.time.len());
}
