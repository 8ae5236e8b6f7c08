//! The observers of a run.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::StepError;
use crate::observation::observer::{Observer, StepEnd};

/// Observers of a run. Its copies have the same ones.
#[derive(Clone)]
pub(crate) struct Observers(Vec<Arc<Mutex<dyn Observer>>>);

impl Observers {
    pub const NONE: Self = Self(Vec::new());

    pub fn add(&mut self, observer: Arc<Mutex<dyn Observer>>) {
        self.0.push(observer);
    }

    /// Shows the end of a step to all of them.
    pub fn step(&self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self.each(|observer| observer.step(now))
    }

    /// Shows a state whose motion is asked for to all of them.
    pub fn observed(&self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self.each(|observer| observer.observed(now))
    }

    fn each(&self, mut show: impl FnMut(&mut dyn Observer) -> Result<(), StepError>) -> Result<(), StepError> {
        // An observer that panicked in another thread still sees what comes.
        self.0.iter().try_for_each(|observer| show(&mut *observer.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

impl fmt::Debug for Observers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Observers").field(&self.0.len()).finish()
    }
}
