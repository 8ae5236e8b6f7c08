//! Commands that have little memory.

use std::path::{Path, PathBuf};
use std::process::Command;

fn example(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples").join(name).canonicalize().unwrap()
}

/// Runs the program in an address space of a given number of kB: exit code and standard error.
fn limited(kilobytes: usize, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -v {kilobytes}; exec \"$@\""), "sh", env!("CARGO_BIN_EXE_flexframe")]);
    // A trace of a panic wants memory, too.
    let output = command.args(arguments).env("RUST_BACKTRACE", "1").output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Megabytes of address space that products of dense matrices reserve on these threads.
fn reserve(threads: usize) -> usize {
    modal::reserve_of_dense_products(threads) / 1_000_000
}

#[test]
fn little_memory_ends_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_str().unwrap();
    let (small, ring) = (example("bar/free.toml"), example("ring.toml"));
    let (small, ring) = (small.to_str().unwrap(), ring.to_str().unwrap());
    let commands: [(usize, &[&str]); 4] = [
        (1, &["modes", small, "--threads", "1"]),
        (2, &["modes", small, "--threads", "2", "-o", folder, "--overwrite"]),
        (2, &["modes", ring, "--threads", "2"]),
        (2, &["run", small, "--threads", "2", "-o", folder, "--overwrite"]),
    ];
    let limits = [100, 130, 170, 250, 350, 500, 1000];
    for (threads, arguments) in commands {
        let (mut good, mut refused) = (0, 0);
        // Without the reserve, and with it: a processor may have more cache than all of these limits.
        for megabytes in limits.into_iter().chain(limits.map(|own| own + reserve(threads))) {
            let (code, words) = limited(1000 * megabytes, arguments);
            match code {
                Some(0) => good += 1,
                Some(1..=6)
                    if words.contains("memory") || words.contains("os error 12") || words.contains("thread") =>
                {
                    refused += 1;
                }
                // A thread that begins and finds no room for its signal stack is ended by the standard library, which aborts.
                None if words.contains("failed to allocate an alternative stack") => refused += 1,
                _ => panic!("{arguments:?} under {megabytes} MB: {code:?}: {words}"),
            }
        }
        assert!(good > 0 && refused > 0, "{arguments:?}: {good} good, {refused} refused");
        println!("{arguments:?}: {good} good, {refused} refused");
    }
}

#[test]
fn a_factor_that_does_not_fit_is_refused_before_it_is_made_with_numbers() {
    let scene = example("plate.toml");
    let mut estimate = 0;
    // Which phase meets the limit goes with the size of the program and of what the allocator keeps.
    for own in (155..275).step_by(15) {
        let megabytes = own + reserve(1);
        let arguments = ["modes", scene.to_str().unwrap(), "--threads", "1", "-n", "200"];
        let (code, words) = limited(1000 * megabytes, &arguments);
        assert!(code != Some(0) && words.contains("not enough memory"), "{megabytes} MB: {code:?}: {words}");
        let parts = ["not enough memory for", "wanted", "ulimit -v", "coarser mesh", "fewer modes"];
        estimate += u32::from(parts.iter().all(|part| words.contains(part)));
    }
    println!("{estimate} of 8 with numbers");
    assert!(estimate >= 4, "{estimate}");
}
