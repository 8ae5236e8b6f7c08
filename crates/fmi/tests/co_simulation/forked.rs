//! A host that forks after it has used an FMU, as Python's `multiprocessing` does.
#![allow(unsafe_code)]

use std::ffi::c_int;
use std::time::{Duration, Instant};

use crate::importer::{Fmu, Instance};
use crate::scenes::{END, FREE, STEP, scene};

unsafe extern "C" {
    fn fork() -> c_int;
    fn waitpid(process: c_int, status: *mut c_int, options: c_int) -> c_int;
    fn kill(process: c_int, signal: c_int) -> c_int;
    fn _exit(status: c_int) -> !;
}
const WNOHANG: c_int = 1;
const SIGKILL: c_int = 9;

/// Result of a forked process; none where it does not come to an end.
fn in_a_fork(work: impl FnOnce() -> bool) -> Option<bool> {
    // SAFETY: the forked process has this thread alone. It works by what it has itself made, and ends without running anything
    // that the test program wants to be run at its end.
    let process = unsafe { fork() };
    if process == 0 {
        let is_well = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).unwrap_or(false);
        unsafe { _exit(c_int::from(!is_well)) }
    }
    let (started, mut status) = (Instant::now(), 0);
    // SAFETY: a process of ours, and a place for its status.
    while unsafe { waitpid(process, &mut status, WNOHANG) } == 0 {
        if started.elapsed() > Duration::from_secs(120) {
            unsafe {
                kill(process, SIGKILL);
                waitpid(process, &mut status, 0);
            }
            return None;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Some(status == 0)
}

fn rows(fmu: &Fmu, instance: &mut Instance, from: usize) -> Vec<Vec<f64>> {
    let (references, _) = fmu.of_row();
    let count = (END / STEP) as usize;
    (from..count)
        .map(|k| {
            instance.step(k as f64 * STEP, STEP).unwrap();
            instance.get(&references).unwrap()
        })
        .collect()
}

/// Conserved: the same numbers in the fork.
#[test]
fn a_forked_host_goes_on_with_its_instance_and_makes_others() {
    let fmu = Fmu::of(&scene(FREE));
    // The pool has threads from here on.
    let expected = rows(&fmu, &mut fmu.start(), 0);
    let mut begun = fmu.start();
    let (references, _) = fmu.of_row();
    begun.step(0.0, STEP).unwrap();
    assert_eq!(begun.get(&references).unwrap(), expected[0]);
    let made = in_a_fork(|| rows(&fmu, &mut fmu.start(), 0) == expected);
    assert_eq!(made, Some(true), "none where it waits for ever");
    let goes_on = in_a_fork(|| rows(&fmu, &mut begun, 1) == expected[1..]);
    assert_eq!(goes_on, Some(true));
    // One that was forked forks.
    let deeper = in_a_fork(|| {
        let first = rows(&fmu, &mut fmu.start(), 0);
        first == expected && in_a_fork(|| rows(&fmu, &mut fmu.start(), 0) == expected) == Some(true)
    });
    assert_eq!(deeper, Some(true));
}
