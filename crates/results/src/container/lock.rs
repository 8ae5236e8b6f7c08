//! Locks of files.

use std::fs::{File, TryLockError};
use std::ops::Deref;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Another process may have a file locked for the moment in which it looks at it.
const MOMENT: Duration = Duration::from_millis(200);

/// A file that is locked while it is open. Where files cannot be locked, nothing locks them.
///
/// It is unlocked when it is dropped, and not by being closed: a process that this one has just started has the file open,
/// too, until it has become another program, and would keep the lock.
#[derive(Debug)]
pub(crate) struct Locked(File);

impl Locked {
    /// Locks a file, unless another process has it locked and keeps it so: then `None`.
    pub(crate) fn new(file: File, try_lock: fn(&File) -> Result<(), TryLockError>) -> Option<Self> {
        let started = Instant::now();
        while let Err(TryLockError::WouldBlock) = try_lock(&file) {
            if started.elapsed() >= MOMENT {
                return None;
            }
            sleep(Duration::from_millis(5));
        }
        Some(Self(file))
    }
}

impl Drop for Locked {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

impl Deref for Locked {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_another_process_has_inherited_is_unlocked_all_the_same() {
        let place = tempfile::NamedTempFile::new().unwrap();
        let open = || File::open(place.path()).unwrap();
        let file = open();
        // As a process has it that was started meanwhile.
        let inherited = file.try_clone().unwrap();
        let locked = Locked::new(file, File::try_lock).unwrap();
        assert!(Locked::new(open(), File::try_lock_shared).is_none());
        drop(locked);
        assert!(Locked::new(open(), File::try_lock).is_some());
        drop(inherited);
    }
}
