//! Locks of files.

use std::fs::{File, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A process that this one starts has its locks, too, for the moment until it has become another program.
const START_OF_A_PROCESS: Duration = Duration::from_millis(200);

/// Locks a file, unless another process has it locked and keeps it so.
pub(crate) fn try_lock(file: &File, try_lock: fn(&File) -> Result<(), TryLockError>) -> Result<(), TryLockError> {
    let started = Instant::now();
    loop {
        match try_lock(file) {
            Err(TryLockError::WouldBlock) if started.elapsed() < START_OF_A_PROCESS => sleep(Duration::from_millis(5)),
            outcome => return outcome,
        }
    }
}
