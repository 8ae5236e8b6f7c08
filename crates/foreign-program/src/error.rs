//! Errors of a program that gave no result.

use std::io;
use std::time::Duration;

/// A program that did not come to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ProgramError {
    /// It cannot be started.
    #[error("it cannot be started: {0}")]
    Start(#[source] io::Error),
    /// `sh`, which ends it when this program ends, cannot be started.
    #[error("`sh`, which is to end it with this program, cannot be started: {0}")]
    Guard(#[source] io::Error),
    /// The system does not say what has become of it.
    #[error("the system does not say what has become of it: {0}")]
    Wait(#[source] io::Error),
    /// It was asked to stop, and has ended.
    #[error("it was stopped")]
    Stopped,
    /// It took too long, and was ended.
    #[error("it was ended after {} s, which is the most that it may take", .0.as_secs_f64())]
    Time(Duration),
    /// It wrote too much, and was ended.
    #[error("it was ended with {found} bytes in its temporary folder, where it may have {most}")]
    Bytes { found: u64, most: u64 },
}
