//! Errors in an FMU, in the words that its logger gets.

use std::fmt::Display;

use diagnostic::{Failure, Kind};

/// The error with these words.
pub fn refused(words: impl Into<String>) -> Failure {
    Kind::Run.alone().says(words)
}

/// A state that does not fit.
pub fn no_state(error: impl Display) -> Failure {
    refused(format!("this is no state of this FMU: {error}"))
}

/// Bytes that are no state.
pub fn no_bytes() -> Failure {
    refused(
        "the bytes are no state of this FMU, or they have been changed; nothing has been set. States are of one FMU (its GUID) and stop time",
    )
}

/// A null pointer to entries.
pub fn null(what: &str, count: usize) -> Failure {
    refused(format!("{what} is a null pointer where {count} entries are asked for"))
}

/// A part of FMI that there is not.
pub fn none(what: &str) -> Failure {
    refused(format!("FMUs of flexframe have no {what}"))
}

/// A panic, with its words.
pub fn bug(function: &str, words: impl Display) -> Failure {
    refused(format!(
        "this is a bug of flexframe, in {function}: {words}. Please report it. The instance can only be freed, or reset by fmi2Reset"
    ))
}

/// A call after a panic.
pub fn broken() -> Failure {
    refused("this instance has been stopped by a bug, which was reported before; free it, or call fmi2Reset")
}

/// The loss of a model by a panic.
pub fn lost() -> Failure {
    refused("the model of this instance was lost by a fault in flexframe; free the instance and make another")
}
