//! What watches a run, without owning its loop.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use crate::account::EnergyAccount;
use crate::error::StepError;
use crate::motion::PointShapes;
use crate::observation::Observation;
use crate::scheme::Scheme;

/// Watches a run step by step. A closure of `&Observation` is one, too.
pub trait Observer: Send {
    /// Sees the end of a step.
    ///
    /// # Errors
    /// One ends [`Simulation::advance`](crate::Simulation::advance) there.
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError>;

    /// Sees the state whose motion [`Simulation::observe`](crate::Simulation::observe) is asked for, as at each row.
    ///
    /// # Errors
    /// One is returned from there.
    fn observed(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        let _ = now;
        Ok(())
    }
}

impl<F: FnMut(&Observation) + Send> Observer for F {
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self(now.observation()?);
        Ok(())
    }
}

/// The end of a step, as an [`Observer`] sees it.
#[derive(Debug)]
pub struct StepEnd<'a> {
    pub(crate) scheme: &'a mut dyn Scheme,
    pub(crate) points: &'a [PointShapes],
    /// Length of the longest step so far; 0 before the first.
    pub(crate) longest_step: f64,
    pub(crate) observation: &'a mut Observation,
    /// Whether `observation` is that of the state.
    pub(crate) is_observed: bool,
}

impl StepEnd<'_> {
    /// What steps the body: what it knows without another evaluation of the rates.
    pub fn scheme(&self) -> &dyn Scheme {
        self.scheme
    }

    /// Length of the longest step so far; 0 before the first.
    pub fn longest_step(&self) -> f64 {
        self.longest_step
    }

    /// The motion, which is found at the first call: the rates are evaluated for it.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed.
    pub fn observation(&mut self) -> Result<&Observation, StepError> {
        if !self.is_observed {
            self.scheme.observe(self.points, self.observation)?;
            self.is_observed = true;
        }
        Ok(self.observation)
    }
}

/// Those of a run. Its copies have the same ones, but for the account of the energy, of which each has its own.
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
