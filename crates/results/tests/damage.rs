//! Damaged results files: an error or the rows that are there, and no more memory than the file has bytes for.
//!
//! HDF5 is a library of C, and what it does with a damaged file cannot be promised: so the damaged files are read in
//! processes of their own, and one that dies is counted. See docs/bad-input.md.

mod rows;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use results::{FileError, Results};
use rows::{assert_rows, folder, metadata, write};

/// Inputs that one child reads, up to the next multiple of this.
const EACH: usize = 150;

/// A file of three rows, as small as such a file can be.
fn good_file() -> (tempfile::TempDir, PathBuf, Vec<u8>) {
    let (folder, path) = folder();
    let mut metadata = metadata(2, &["P1", "P2"]);
    metadata.scene_text = "title = \"ω₂\"".into();
    write(&path, 3, &metadata).finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    (folder, path, bytes)
}

/// Knuth's MMIX linear congruential generator.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// Damages some of the bytes that say something: most of a file is numbers and room for more.
fn spoil(good: &[u8], telling: &[usize], random: &mut Random) -> Vec<u8> {
    let mut bytes = good.to_vec();
    for _ in 0..1 + random.below(3) {
        let at = telling[random.below(telling.len())];
        match random.below(5) {
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => {
                let claim = [u64::MAX, 1_000_000_000_000, 1 << 63, 0][random.below(4)].to_le_bytes();
                bytes.iter_mut().skip(at).zip(claim).for_each(|(byte, new)| *byte = new);
            }
            3 => bytes.truncate(at),
            _ => {
                let from = telling[random.below(telling.len())];
                let piece: Vec<u8> = good[from..].iter().take(1 + random.below(64)).copied().collect();
                bytes.iter_mut().skip(at).zip(piece).for_each(|(byte, new)| *byte = new);
            }
        }
        if bytes.len() <= at {
            break;
        }
    }
    bytes
}

/// Not a test of its own: reads damaged files from the one that the environment names.
#[test]
#[ignore = "run by another test"]
fn child_that_reads_damaged_files() {
    let Some(first) = std::env::var("RESULTS_TEST_FIRST").ok().and_then(|first| first.parse::<usize>().ok()) else {
        return;
    };
    let (folder, path, good) = good_file();
    // Not the zeros, and not what the rows are made of: the numbers in the chunks at the end.
    let telling: Vec<usize> = (0..good.len()).filter(|at| good[*at] != 0 || *at < 4096).collect();
    let damaged = folder.path().join("damaged.h5");
    for seed in first..(first / EACH + 1) * EACH {
        std::fs::write(path.with_extension("seed"), seed.to_string()).unwrap();
        std::fs::write(&damaged, spoil(&good, &telling, &mut Random(seed as u64))).unwrap();
        match Results::open(&damaged) {
            Ok(results) => assert!(results.points.values().all(|point| point.velocity.len() == results.time.len())),
            Err(error) => assert!(error.to_string().len() < 5000, "{error}"),
        }
        println!("read {seed}");
    }
}

/// Reads in a child; gives how many files were read before it ended, and how it ended if not well.
fn read_in_child(first: usize) -> (usize, Option<String>) {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child_that_reads_damaged_files", "--ignored", "--nocapture"])
        .env("RESULTS_TEST_FIRST", first.to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // HDF5 may also go round in circles. What a child says fits into the pipe.
    for _ in 0..600 {
        if child.try_wait().unwrap().is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let read = said.lines().filter(|line| line.contains("read ")).count();
    (read, (!output.status.success()).then(|| format!("{} {}", output.status, String::from_utf8_lossy(&output.stderr))))
}

#[test]
fn damaged_files_end_in_an_error() {
    let (mut tried, mut crashed) = (0, Vec::new());
    let most: usize = std::env::var("RESULTS_TEST_INPUTS").ok().and_then(|n| n.parse().ok()).unwrap_or(EACH);
    while tried < most {
        let (read, end) = read_in_child(tried);
        tried += read;
        if let Some(end) = end {
            assert!(!end.contains("panicked"), "input {tried}: {end}");
            crashed.push((tried, end));
            tried += 1;
        }
    }
    println!("{tried} damaged files, {} crashes of HDF5: {crashed:?}", crashed.len());
    // Measured with HDF5 1.10.8: 2 of 150; of 1346, 9 crashes and 4 that never ended.
    assert!(crashed.len() * 20 <= tried, "{} of {tried} files made HDF5 crash", crashed.len());
}

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let (folder, _, good) = good_file();
    let cut = folder.path().join("cut.h5");
    for end in (0..good.len()).step_by(good.len() / 300).chain([good.len() - 1]) {
        std::fs::write(&cut, &good[..end]).unwrap();
        assert!(matches!(Results::open(&cut), Err(FileError::Hdf5 { .. })), "cut at {end}");
    }
}

#[test]
fn a_claim_of_very_many_rows_is_refused() {
    let (_folder, path, good) = good_file();
    assert_rows(&Results::open(&path).unwrap(), 3);
    let file = hdf5::File::open_rw(&path).unwrap();
    let mut names = Vec::new();
    collect(&file, &mut names);
    for (name, shape) in names.iter().filter(|(name, _)| !name.starts_with("body")) {
        let mut shape = shape.clone();
        shape[0] = 1_000_000_000_000;
        file.dataset(name).unwrap().resize(shape).unwrap();
    }
    drop(file);
    let error = Results::open(&path).unwrap_err();
    let FileError::ClaimsTooMuch { claimed, length, .. } = error else { panic!("{error}") };
    assert!(claimed > 100_000_000_000_000 && length.abs_diff(good.len() as u64) < 4096, "{claimed} {length}");
    assert!(error.to_string().contains("more than the"), "{error}");
}

/// All datasets below a group, with their shapes.
fn collect(group: &hdf5::Group, into: &mut Vec<(String, Vec<usize>)>) {
    for dataset in group.datasets().unwrap() {
        into.push((dataset.name().trim_start_matches('/').to_owned(), dataset.shape()));
    }
    for child in group.groups().unwrap() {
        collect(&child, into);
    }
}

#[test]
fn a_text_that_is_not_utf8_is_refused() {
    let (folder, _, mut good) = good_file();
    let at = good.windows(6).position(|window| window == "ω₂\"".as_bytes()).unwrap();
    good[at] = 0xff;
    let spoiled = folder.path().join("text.h5");
    std::fs::write(&spoiled, good).unwrap();
    let error = Results::open(&spoiled).unwrap_err();
    assert!(matches!(&error, FileError::NotUtf8 { attribute, .. } if attribute == "scene"), "{error}");
}

#[test]
fn what_is_no_results_file_is_an_error() {
    let (folder, _) = folder();
    let path: &Path = &folder.path().join("none.h5");
    for contents in [&b""[..], b"\x89HDF\r\n\x1a\n", b"$MeshFormat\n4.1 0 8\n", &[0xff; 5000]] {
        std::fs::write(path, contents).unwrap();
        assert!(matches!(Results::open(path), Err(FileError::Hdf5 { .. })));
    }
    assert!(matches!(Results::open(folder.path()), Err(FileError::Hdf5 { .. })));
}
