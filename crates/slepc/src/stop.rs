//! Signals that stop the driver.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asks a driver to stop, and knows whether one is at work. Clones are the same.
#[derive(Debug, Clone, Default)]
pub struct Stop {
    asked: Arc<AtomicBool>,
    at_work: Arc<AtomicBool>,
}

impl Stop {
    /// Asks it to stop: its processes are ended and its files removed. False where none is at work.
    pub fn ask(&self) -> bool {
        let is_at_work = self.at_work.load(Ordering::SeqCst);
        if is_at_work {
            self.asked.store(true, Ordering::SeqCst);
        }
        is_at_work
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst)
    }

    /// From here until the guard is dropped, one is at work.
    pub(crate) fn work(&self) -> Work<'_> {
        self.at_work.store(true, Ordering::SeqCst);
        Work(self)
    }
}

pub(crate) struct Work<'a>(&'a Stop);

impl Drop for Work<'_> {
    fn drop(&mut self) {
        self.0.at_work.store(false, Ordering::SeqCst);
    }
}
