//! The reader of results files, and the run that goes on with one.
#![no_main]

use std::os::unix::fs::FileExt;
use std::path::PathBuf;
use std::sync::LazyLock;

use flexframe_fuzz::{COLUMNS, write_results};
use libfuzzer_sys::fuzz_target;
use results::{FileError, Results, Writer};
use sealed::SealedError;

/// Where a file of any bytes is, where an unfinished one, and the bytes of that.
static FILES: LazyLock<(tempfile::TempDir, PathBuf, PathBuf, Vec<u8>)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let [any, part] = ["any.h5", "seed.part.h5"].map(|name| folder.path().join(name));
    write_results(&folder.path().join("seed.h5"), 2, [2, 1], 3, false).unwrap();
    let bytes = std::fs::read(&part).unwrap();
    (folder, any, part, bytes)
});

fn open(path: &PathBuf) {
    match Results::open_with_shapes(path, &COLUMNS) {
        Ok((results, _)) => assert_eq!(results.numbers("time").map(<[f64]>::len), Some(results.rows())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fuzz_target!(|bytes: &[u8]| {
    let (_folder, any, part, sound) = &*FILES;
    std::fs::write(any, bytes).unwrap();
    open(any);

    // Changes of a sound file: the place in three bytes, and what comes there.
    std::fs::write(part, sound).unwrap();
    let file = std::fs::OpenOptions::new().write(true).open(part).unwrap();
    for &[a, b, c, byte] in bytes.as_chunks().0 {
        let place = u32::from_le_bytes([a, b, c, 0]) as usize % sound.len();
        file.write_at(&[byte], place as u64).unwrap();
    }
    drop(file);
    open(part);
    if let Err(error) = Writer::resume(part, &COLUMNS, false) {
        assert!(
            matches!(
                error,
                FileError::Sealed(
                    SealedError::NoSeal { .. } | SealedError::OtherVersion { .. } | SealedError::Damaged { .. }
                )
            ),
            "{error}"
        );
    }
});
