//! The observers of a run.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::StepError;
use crate::observation::observer::{Observer, StepEnd};
use crate::simulation::account::EnergyAccount;

/// Observers of a run. Its copies have the same ones, but for the account of the energy, of which each has its own.
#[derive(Clone)]
pub(crate) struct Observers {
    pub energy: EnergyAccount,
    pub others: Vec<Arc<Mutex<dyn Observer>>>,
}

impl Observers {
    pub fn new(energy: EnergyAccount) -> Self {
        Self { energy, others: Vec::new() }
    }

    /// Shows the end of a step to all of them.
    pub fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self.each(|observer| observer.step(now))
    }

    /// Shows a state whose motion is asked for to all of them.
    pub fn observed(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self.each(|observer| observer.observed(now))
    }

    fn each(&mut self, mut show: impl FnMut(&mut dyn Observer) -> Result<(), StepError>) -> Result<(), StepError> {
        show(&mut self.energy)?;
        for observer in &self.others {
            // An observer that panicked in another thread still sees what comes.
            show(&mut *observer.lock().unwrap_or_else(PoisonError::into_inner))?;
        }
        Ok(())
    }
}

impl fmt::Debug for Observers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observers").field("energy", &self.energy).field("others", &self.others.len()).finish()
    }
}
