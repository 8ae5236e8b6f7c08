//! Why a motion cannot start, or cannot go on.

/// A motion that cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A list with one number for each flexible mode has another length.
    #[error("{what} has {found} entries; expected one for each of the {expected} flexible modes")]
    Length {
        /// Which list.
        what: &'static str,
        /// Number of flexible modes.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A number that is NaN or infinite, or outside its range.
    #[error("{what} is {found}; expected {expected}")]
    Value {
        /// Which number.
        what: &'static str,
        /// Its value.
        found: f64,
        /// Its range.
        expected: &'static str,
    },
    /// A step at which RK4 amplifies a mode.
    #[error(
        "a step of {step:e} is beyond the stability limit {limit:e} that flexible mode {mode} ({frequency:.6} cycles per time) sets for RK4; take a smaller step or fewer modes"
    )]
    StepBeyondLimit {
        /// The step.
        step: f64,
        /// Largest stable step.
        limit: f64,
        /// Number of the mode, from 1.
        mode: usize,
        /// Its natural frequency.
        frequency: f64,
    },
    /// The reference points lie on a line.
    #[error(transparent)]
    CollinearPoints(#[from] rigid_kin::CollinearPoints),
    /// The inertia is none of a rigid body.
    #[error(transparent)]
    Inertia(#[from] rigid_kin::InertiaError),
}

/// A step that failed. The state before it is kept.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The body turns by more than a full turn within a step.
    #[error("at time {time}: the body turns by {angle:.3} rad within a step of {step:e}; take a step of at most {:e}", step / angle)]
    TurnTooLarge {
        /// Start of the step.
        time: f64,
        /// Its length.
        step: f64,
        /// Angle of the turn.
        angle: f64,
    },
    /// A NaN or an overflow.
    #[error(
        "at time {time}: {what} is no longer a finite number; the motion has blown up: take a smaller step, and check loads and initial velocities"
    )]
    NotFinite {
        /// Start of the step.
        time: f64,
        /// Which quantity.
        what: &'static str,
    },
}
