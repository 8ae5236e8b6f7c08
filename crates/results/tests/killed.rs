//! What survives when a run is killed.
//!
//! In a process apart from the other tests: a child inherits the files that its parent has open, with HDF5's locks.

mod rows;

use results::{Expected, Results, Resumed, Writer, unfinished};
use rows::{Row, assert_rows, folder, metadata};
use std::path::Path;
use std::process::Command;

/// Not a test of its own: the process that [`a_killed_run_can_be_read_up_to_its_last_flush`] kills.
#[test]
#[ignore = "run by another test"]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let metadata = metadata(2, &["P1"]);
    let expected = Expected { checkpoint: 1, ..Expected::default() };
    let mut writer = Writer::create(Path::new(&path), &metadata, expected).unwrap();
    for i in 0..801 {
        writer.push(&Row::new(i, 2, 1).sample()).unwrap();
        if i == 700 {
            writer.flush(&[4711]).unwrap();
        }
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
    let results = Results::open(unfinished(&path)).unwrap();
    assert!(!results.complete);
    assert!(results.time.len() >= 701, "{}", results.time.len());
    assert_rows(&results, results.time.len());
    let Resumed { results, checkpoint, .. } = Writer::resume(&path).unwrap();
    assert_rows(&results, 701);
    assert_eq!(checkpoint, Some(vec![4711]));
}
