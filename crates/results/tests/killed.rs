//! Rows that survive when a run is killed; and pipes.
//!
//! In a process apart from the other tests, and one after another: a child inherits the files that its parent has open,
//! with HDF5's locks.

mod rows;

use ::sealed::SealedError;
use results::{Expected, FileError, Results, unfinished};
use rows::{COLUMNS, Resumed, Row, Writer, assert_rows, folder, metadata, shapes};
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

static ALONE: Mutex<()> = Mutex::new(());

/// Not a test of its own: the process that [`a_killed_run_can_be_read_up_to_its_last_flush`] kills.
#[test]
#[ignore = "run by another test"]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let metadata = metadata(2, &["P1"]);
    let expected = Expected { checkpoint: 1, overwrite: true, ..Expected::default() };
    let mut writer = Writer::create(Path::new(&path), &metadata, &[Some(shapes(2))], &COLUMNS, expected).unwrap();
    for i in 0..801 {
        writer.push(&Row::new(i, 2, 1)).unwrap();
        if i == 700 {
            writer.flush(&[4711]).unwrap();
        }
    }
    std::process::abort();
}

#[test]
fn a_killed_run_can_be_read_up_to_its_last_flush() {
    let _alone = ALONE.lock();
    let (_folder, path) = folder();
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_is_killed", "--ignored"])
        .env("RESULTS_TEST_CHILD", &path)
        .output()
        .unwrap()
        .status;
    assert!(!status.success(), "the child was to abort");
    let results = Results::open(unfinished(&path), &COLUMNS).unwrap();
    assert!(!results.complete);
    assert!(results.rows() >= 701, "{}", results.rows());
    assert_rows(&results, results.rows());
    let Resumed { results, checkpoint, .. } = Writer::resume(&path, &COLUMNS, true).unwrap();
    assert_rows(&results, 701);
    assert_eq!(checkpoint, Some(vec![4711]));
}

/// Not a test of its own: goes on from where it is with a flush at every row.
#[test]
#[ignore = "run by another test"]
fn child_that_flushes_at_every_row() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let path = Path::new(&path);
    let (mut writer, done) = if unfinished(path).exists() {
        let Resumed { writer, results, checkpoint } = Writer::resume(path, &COLUMNS, true).unwrap();
        let rows = results.rows();
        assert_eq!(checkpoint.map_or(0, |state| state[0]), rows as u64);
        assert_rows(&results, rows);
        (writer, rows)
    } else {
        let expected = Expected { checkpoint: STATE, overwrite: true, ..Expected::default() };
        (Writer::create(path, &metadata(2, &["P1"]), &[Some(shapes(2))], &COLUMNS, expected).unwrap(), 0)
    };
    for i in done..ROWS {
        writer.push(&Row::new(i, 2, 1)).unwrap();
        writer.flush(&vec![i as u64 + 1; STATE]).unwrap();
    }
    writer.finish().unwrap();
}

/// More than a page of them.
const STATE: usize = 1000;

/// The file grows several times on the way.
const ROWS: usize = 20_000;

/// `FLEXFRAME_KILLS` sets the number of kills.
#[test]
fn a_file_is_whole_whenever_its_writer_is_killed() {
    let _alone = ALONE.lock();
    let (_folder, path) = folder();
    let kills: u32 = std::env::var("FLEXFRAME_KILLS").map_or(25, |count| count.parse().unwrap());
    let (mut done, mut random) = (0, std::process::id().wrapping_mul(2_654_435_761));
    while done < kills {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child_that_flushes_at_every_row", "--ignored"])
            .env("RESULTS_TEST_CHILD", &path)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        std::thread::sleep(std::time::Duration::from_micros(u64::from(random >> 15)));
        child.kill().unwrap();
        match child.wait().unwrap().code() {
            None => done += 1,
            // It came to its end before, without a complaint.
            code => assert_eq!(code, Some(0)),
        }
        if unfinished(&path).exists() {
            let results = Results::open(unfinished(&path), &COLUMNS).unwrap();
            assert_rows(&results, results.rows());
        }
        if path.exists() {
            let results = Results::open(&path, &COLUMNS).unwrap();
            assert!(results.complete);
            assert_rows(&results, ROWS);
        }
    }
}

/// Not a test of its own: cannot write beyond the middle of the last checkpoint, and tries it twice.
#[test]
#[ignore = "run by another test"]
fn child_whose_checkpoints_fail() {
    let Some(path) = std::env::var_os("RESULTS_TEST_CHILD") else { return };
    let Resumed { mut writer, .. } = Writer::resume(Path::new(&path), &COLUMNS, true).unwrap();
    for state in [3, 4] {
        assert!(matches!(writer.flush(&[state; STATE]), Err(FileError::Sealed(SealedError::System { .. }))));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn checkpoints_that_fail_leave_the_last_whole_one() {
    let _alone = ALONE.lock();
    let (_folder, path) = folder();
    let expected = Expected { checkpoint: STATE, overwrite: true, ..Expected::default() };
    let mut writer = Writer::create(&path, &metadata(2, &["P1"]), &[Some(shapes(2))], &COLUMNS, expected).unwrap();
    for i in 0..2 {
        writer.push(&Row::new(i, 2, 1)).unwrap();
        writer.flush(&[0x55aa + i as u64; STATE]).unwrap();
    }
    drop(writer);
    let last = [0x55ab_u64.to_le_bytes(); STATE];
    let bytes = std::fs::read(unfinished(&path)).unwrap();
    let start = bytes.windows(8 * STATE).position(|bytes| bytes == last.as_flattened()).unwrap();
    // A signal that is ignored is so in the programs after it, too.
    let status = Command::new("sh")
        .args(["-c", "trap '' XFSZ; exec prlimit \"$@\"", "sh"])
        .arg(format!("--fsize={}", start + 4 * STATE))
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "child_whose_checkpoints_fail", "--ignored"])
        .env("RESULTS_TEST_CHILD", &path)
        .status()
        .unwrap();
    assert!(status.success());
    let Resumed { results, checkpoint, .. } = Writer::resume(&path, &COLUMNS, true).unwrap();
    assert_rows(&results, 2);
    assert_eq!(checkpoint, Some(vec![0x55ab; STATE]));
}

/// To open a pipe is to wait for who writes into it.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused_without_being_opened() {
    let _alone = ALONE.lock();
    let (_folder, path) = folder();
    for pipe in [path.clone(), unfinished(&path)] {
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(matches!(Writer::check(&path, false), Err(FileError::NotResults { path }) if path == pipe));
        assert!(matches!(Writer::resume(&path, &COLUMNS, true), Err(FileError::NothingToResume { .. })));
        std::fs::remove_file(pipe).unwrap();
    }
}
