//! A hard case, and what is expected of it.

use std::fmt;

use dynamics::Method;
use reduced_body::ReducedBody;

/// The schemes whose bounds are written down, in the order of [`HardCase::expected`].
pub const BOUNDED: [Method; 4] = [Method::EXPONENTIAL, Method::RKMK4, frames_rk4::PAPER, frames_rk4::LIMIT];

/// How long the runs of a case are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Seconds for all cases together.
    Test,
    /// Minutes.
    Study,
}

impl Extent {
    /// The number for this extent. The paper's formulation always goes as far as the study does: it often stops there
    /// only.
    pub fn pick(self, method: Method, test: u32, study: u32) -> f64 {
        let always = !method.abilities.keeps_energy;
        f64::from(if self == Self::Study || always { study } else { test })
    }
}

/// How a run went.
#[derive(Debug, Clone, PartialEq)]
pub enum TrialOutcome {
    /// It came to its end, with this error or drift. NaN where anything in its observations was none.
    Ran(f64),
    /// It did not start, or stopped, with this message.
    Refused(String),
}

/// Bound of an outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// The error or drift is not above this.
    Within(f64),
    /// It does not start, or stops, with this in its message.
    Refused(&'static str),
}

impl Bound {
    /// True if the outcome is within the bound.
    pub fn holds(&self, outcome: &TrialOutcome) -> bool {
        match (self, outcome) {
            (Self::Within(bound), TrialOutcome::Ran(error)) => error <= bound,
            (Self::Refused(part), TrialOutcome::Refused(message)) => message.contains(part),
            _ => false,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(bound) => write!(f, "≤ {bound:.0e}"),
            Self::Refused(part) => write!(f, "refused: “{part}”"),
        }
    }
}

/// A figure of the body itself, before it moves.
#[derive(Debug, Clone, Copy)]
pub struct BodyFigure {
    /// Name of the figure.
    pub what: &'static str,
    /// Finds it.
    pub figure: fn() -> Result<f64, String>,
    /// Its bound.
    pub expected: Bound,
}

impl BodyFigure {
    /// Finds the figure.
    pub fn run(&self) -> TrialOutcome {
        (self.figure)().map_or_else(TrialOutcome::Refused, TrialOutcome::Ran)
    }
}

/// A hard case.
#[derive(Debug, Clone, Copy)]
pub struct HardCase {
    /// Its name.
    pub name: &'static str,
    /// Reason of the difficulty.
    pub why: &'static str,
    /// Figure of the body.
    pub body: Option<BodyFigure>,
    /// Name of the figure of the motion.
    pub measure: &'static str,
    /// Runs it.
    pub run: fn(Method, Extent) -> TrialOutcome,
    /// Bound of each of [`BOUNDED`].
    pub expected: [Bound; 4],
}

impl HardCase {
    /// Bound of a scheme, if any.
    pub fn expected_of(&self, method: Method) -> Option<&Bound> {
        let place = BOUNDED.iter().position(|bounded| *bounded == method)?;
        self.expected.get(place)
    }
}

/// A case with a body, or its refusal.
pub(crate) fn on(body: Result<ReducedBody, String>, run: impl FnOnce(&ReducedBody) -> TrialOutcome) -> TrialOutcome {
    match body {
        Ok(body) => run(&body),
        Err(refusal) => TrialOutcome::Refused(refusal),
    }
}
