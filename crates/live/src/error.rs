//! Runs that cannot be led on.

use dynamics::{DescriptionError, SetupError, StepError};

/// A live run that cannot begin, go on, or be changed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum LiveError {
    /// The data are no run.
    #[error("{0}")]
    Description(#[from] DescriptionError),
    /// Data with bodies that are moved twice, or not at all.
    #[error("the run moves body {body} {times} times; expected once")]
    Bodies { body: usize, times: usize },
    /// A motion cannot begin, or not with this change.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A step failed.
    #[error("{0}")]
    Step(#[from] StepError),
    /// Something to change that the run does not have.
    #[error("the run has no {what}")]
    Nothing { what: &'static str },
    /// A value that is not finite, or negative where it must not be.
    #[error("{found} was given for {what}; expected {expected}")]
    Value { what: &'static str, found: f64, expected: &'static str },
    /// A pull at a place whose shapes are not known.
    #[error(
        "{found} numbers were given for the shapes of the place to pull at; expected {expected}: three for each shape of its body"
    )]
    Shapes { found: usize, expected: usize },
}
