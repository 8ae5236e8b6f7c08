//! The reader of results files.
//!
//! HDF5 is a library of C that is not instrumented here: what is searched is the reader around it. Crashes within HDF5
//! itself (in `H5...` functions) are known to happen; see docs/bad-input.md.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use results::Results;

static FILE: LazyLock<(tempfile::TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fuzzed.h5");
    (folder, path)
});

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&FILE.1, bytes).unwrap();
    match Results::open(&FILE.1) {
        Ok(results) => assert!(results.points.values().all(|point| point.velocity.len() == results.time.len())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
