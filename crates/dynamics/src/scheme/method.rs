//! A formulation with a scheme, as a scene can name it.

use std::fmt;

use crate::error::SetupError;
use crate::motion::beginning::Beginning;
use crate::scheme::abilities::Abilities;
use crate::simulation::setup::Setup;

/// What limits the step of a scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StepLimit {
    /// The fastest mode, at about 2.83/ω_max.
    Modes,
    /// The spin: the largest angle in rad that the body may turn through in a step.
    Turn(f64),
}

/// What a [`Setup`] begins a motion with: a [`Method`], or one with data of its own.
pub trait Begin: fmt::Debug + Send + Sync {
    /// Its name and what it can do.
    fn method(&self) -> Method;

    /// Begins a motion.
    ///
    /// # Errors
    /// [`SetupError`].
    fn begin(&self, setup: &Setup) -> Result<Beginning, SetupError>;
}

/// A formulation with a scheme that a scene can name.
///
/// One of your own is a constant of this type: a [`Setup`] takes it like those of this crate.
#[derive(Clone, Copy)]
pub struct Method {
    /// The name of its formulation: "paper" or "conservative".
    pub formulation: &'static str,
    /// Its name.
    pub scheme: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// Evaluations of the rates that a step takes.
    pub evaluations_per_step: u32,
    /// What limits its step.
    pub limit: StepLimit,
    /// Whether it estimates the error of a step.
    pub estimates_error: bool,
    /// What its formulation can do.
    pub abilities: Abilities,
    /// Begins a motion.
    pub begin: fn(&Setup) -> Result<Beginning, SetupError>,
}

impl Begin for Method {
    fn method(&self) -> Method {
        *self
    }

    fn begin(&self, setup: &Setup) -> Result<Beginning, SetupError> {
        (self.begin)(setup)
    }
}

impl Method {
    /// Whether its step is limited by the fastest mode; otherwise by the spin.
    pub fn is_limited_by_modes(&self) -> bool {
        self.limit == StepLimit::Modes
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        (self.formulation, self.scheme) == (other.formulation, other.scheme)
    }
}

impl Eq for Method {}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.formulation, self.scheme)
    }
}
