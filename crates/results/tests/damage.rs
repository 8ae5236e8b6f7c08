//! Damaged files: each is refused, and none costs much more memory than it has bytes.
//!
//! Each byte is damaged in one of two ways, in turn; in both where `FLEXFRAME_FORGERIES` is set (`./dev stability`).

mod rows;
#[allow(dead_code)] // files are made right again by other tests
mod sealed;

use ::sealed::SealedError;
use results::*;
use rows::{COLUMNS, Resumed, Row, Writer, assert_rows, folder, metadata, shapes};
use std::fs::OpenOptions;
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Files refused.
static REFUSED: AtomicUsize = AtomicUsize::new(0);

const ROWS: usize = 30;

/// A finished and an unfinished file, as bytes.
fn files(path: &Path) -> [Vec<u8>; 2] {
    let metadata = Metadata { scene_text: "title = \"ω₂\"".into(), ..metadata(2, &["P1"]) };
    let begin = || {
        let expected = Expected { checkpoint: 4, overwrite: true, ..Expected::default() };
        let mut writer = Writer::create(path, &metadata, &[Some(shapes(2))], &COLUMNS, expected).unwrap();
        (0..ROWS).for_each(|i| writer.push(&Row::new(i, 2, 1)).unwrap());
        writer.flush(&[1, 2, 3, 4]).unwrap();
        writer
    };
    begin().finish().unwrap();
    drop(begin());
    [path.to_owned(), unfinished(path)].map(|path| {
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        bytes
    })
}

/// The bytes of the datasets whose numbers change.
fn open_places(bytes: &[u8]) -> Vec<Range<usize>> {
    let places = sealed::places(&sealed::read(bytes), bytes.len()).into_iter();
    places.filter(|place| place.hash.is_none()).map(|place| place.bytes).collect()
}

/// Result of the reader for a file, and the most memory that it held meanwhile.
fn read(path: &Path) -> (Result<Results, FileError>, usize) {
    let mut outcome = None;
    let open = || Results::open_with_shapes(path, &COLUMNS).map(|(results, _)| results);
    let memory = allocation_counter::measure(|| outcome = Some(open()));
    (outcome.unwrap(), memory.bytes_max as usize)
}

/// The reader must refuse the file, with no more in memory than its description and a message.
fn refuse(path: &Path, what: std::fmt::Arguments) {
    let (outcome, memory) = read(path);
    let Err(error) = outcome else { panic!("{what}: accepted") };
    assert!(
        matches!(
            error,
            FileError::Sealed(
                SealedError::NoSeal { .. } | SealedError::OtherVersion { .. } | SealedError::Damaged { .. }
            )
        ),
        "{what}: {error}"
    );
    assert!(error.to_string().len() < 500, "{error}");
    let bytes = std::fs::metadata(path).unwrap().len() as usize;
    assert!(memory < 6000 + bytes, "{what}: {memory} bytes of memory for {bytes}");
    REFUSED.fetch_add(1, Relaxed);
}

/// Knuth's MMIX linear congruential generator.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

#[test]
fn every_damage_is_found() {
    let (folder, path) = folder();
    let files = files(&path);
    let place = folder.path().join("damaged.part.h5");
    let all = std::env::var_os("FLEXFRAME_FORGERIES").is_some();
    for bytes in &files {
        std::fs::write(&place, bytes).unwrap();
        let (results, memory) = read(&place);
        assert_rows(&results.unwrap(), ROWS);
        println!("{} bytes: {memory} bytes of memory", bytes.len());
        assert!(memory < 3 * bytes.len()); // 0.5 times, 0.9 times
        let numbers = open_places(bytes);
        let file = OpenOptions::new().write(true).open(&place).unwrap();
        for at in (0..bytes.len()).filter(|at| !numbers.iter().any(|range| range.contains(at))) {
            let changes = [1 << (at / 2 % 8), 0xff];
            for change in if all { &changes[..] } else { &changes[at % 2..][..1] } {
                file.write_at(&[bytes[at] ^ change], at as u64).unwrap();
                refuse(&place, format_args!("byte {at} of {}, {change:#x}", bytes.len()));
            }
            file.write_at(&bytes[at..=at], at as u64).unwrap();
        }
        // A page that was lost, or is that of another place.
        for start in (0..bytes.len() - 512).step_by(512) {
            let here = start..start + 512;
            for other in [&[0; 512][..], &bytes[..512], &bytes[bytes.len() - 512..]] {
                let mut spoiled = bytes.clone();
                spoiled[here.clone()].copy_from_slice(other);
                numbers.iter().for_each(|range| spoiled[range.clone()].copy_from_slice(&bytes[range.clone()]));
                if spoiled != *bytes {
                    std::fs::write(&place, spoiled).unwrap();
                    refuse(&place, format_args!("the page at {start} of {}", bytes.len()));
                }
            }
        }
        std::fs::write(&place, [bytes, &[0][..]].concat()).unwrap();
        for length in (0..bytes.len()).rev().step_by(7) {
            refuse(&place, format_args!("cut to {length} or more of {}", bytes.len()));
            file.set_len(length as u64).unwrap();
        }
    }
    let [_, part] = files;
    for claim in [1, 28, 1 << 20, 1_000_000_000_000, u64::MAX >> 4, u64::MAX] {
        for mut bytes in [part.clone(), part[..512].to_vec()] {
            let length = bytes.len() as u64;
            bytes[24..32].copy_from_slice(&length.to_le_bytes());
            bytes[32..40].copy_from_slice(&claim.to_le_bytes());
            std::fs::write(&place, bytes).unwrap();
            refuse(&place, format_args!("a description of {claim} bytes"));
        }
    }

    println!("{} damaged files refused", REFUSED.load(Relaxed));

    // What no hash is of is numbers. The rows of a checkpoint have a sum in it; of the checkpoints the last whole
    // one counts.
    let numbers = open_places(&part);
    let mut state = 1;
    let mut refused = 0;
    for _ in 0..500 {
        let mut bytes = part.clone();
        for _ in 0..1 + next(&mut state) % 40 {
            let range = &numbers[next(&mut state) % numbers.len()];
            bytes[range.start + next(&mut state) % range.len()] = next(&mut state) as u8;
        }
        std::fs::write(&place, &bytes).unwrap();
        let (results, memory) = read(&place);
        assert!(memory < 3 * bytes.len());
        match results {
            // Rows after the checkpoint may be anything that is finite.
            Ok(results) => assert!(results.numbers("time").unwrap().iter().all(|time| time.is_finite())),
            Err(error) => assert!(matches!(error, FileError::Sealed(SealedError::Damaged { .. })), "{error}"),
        }
        match Writer::resume(&place, &COLUMNS, true) {
            Ok(Resumed { results, checkpoint: Some(state), .. }) => {
                assert_rows(&results, ROWS);
                assert_eq!(state, [1, 2, 3, 4]);
            }
            // The checkpoint itself is damaged: the run begins anew.
            Ok(Resumed { results, checkpoint: None, .. }) => assert_rows(&results, 0),
            Err(error) => {
                assert!(matches!(error, FileError::Sealed(SealedError::Damaged { .. })), "{error}");
                refused += 1;
            }
        }
    }
    println!("{refused} of 500 with damaged numbers");
    assert!(refused > 100, "{refused}");
}
