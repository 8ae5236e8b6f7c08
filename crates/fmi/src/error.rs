//! Errors in an FMU, in the words that its logger gets.

use flexframe::advice::AdviceError;
use flexframe::dynamics::{CheckpointError, StepError};
use flexframe::forked::NoThreads;

use crate::phase::Phase;

/// An error of an FMU.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Fmu(#[from] diagnostic::Failure),
    #[error(transparent)]
    Threads(#[from] NoThreads),
    #[error(
        "the resource location {found:?} is no folder of this machine; give the URI of the unpacked folder resources, such as \
         file:///tmp/blade/resources"
    )]
    Location { found: String },
    #[error(
        "the GUID {found} is not that of this FMU, {expected}: modelDescription.xml and the resources are of different FMUs; \
         unpack the FMU again"
    )]
    Guid { found: String, expected: String },
    #[error("FMUs of flexframe are for co-simulation; instantiate with fmi2CoSimulation")]
    NotCoSimulation,
    #[error("{function} cannot be called {phase}; call it {allowed}")]
    Phase { function: &'static str, phase: Phase, allowed: &'static str },
    #[error("the start time is {found}; the scene begins at time 0: start there")]
    StartTime { found: f64 },
    #[error("the stop time is {found}; give a positive number, or none")]
    StopTime { found: f64 },
    #[error("the motion cannot start: {0}")]
    Start(Box<flexframe::motion::BeginError>),
    #[error("the value reference {reference} is none of this FMU, which has 0 to {last}")]
    Reference { reference: u32, last: usize },
    #[error("there are no {kind} variables in this FMU; all are real (value reference {reference} was asked for)")]
    Kind { kind: &'static str, reference: u32 },
    #[error("{name} cannot be set: it is {what}; inputs are the variables with causality=\"input\"")]
    NotInput { name: String, what: &'static str },
    #[error("{name} cannot be {found}: give a finite number; nothing has been set")]
    NotFinite { name: String, found: f64 },
    #[error(
        "the communication step is {found}; give a step of at least {least:e}, forward in time; the FMU stays at time {time}"
    )]
    Step { found: f64, least: f64, time: f64 },
    #[error(
        "the communication point is {found}, but the FMU is at time {time}; go on from there, or set a state that was saved at \
         {found}"
    )]
    Point { found: f64, time: f64 },
    #[error(
        "a step to time {found} is beyond the end at {end}; set a longer stop time in fmi2SetupExperiment, or pack the scene \
         with a later time.end; the FMU stays at time {time}"
    )]
    End { found: f64, end: f64, time: f64 },
    #[error(
        "the step failed: {source}. The FMU stays at time {time}, before the step: other inputs may be set and the step be \
         tried again, or an earlier state be set"
    )]
    Failed { source: Failure, time: f64 },
    #[error("the outputs cannot be found: {0}; set other inputs, or a state that was saved before")]
    Outputs(Failure),
    #[error("this is no state of this FMU: {0}")]
    State(#[from] CheckpointError),
    #[error(
        "the bytes are no state of this FMU, or they have been changed; nothing has been set. States are of one FMU (its GUID) \
         and stop time"
    )]
    Bytes,
    #[error("{what} is a null pointer where {count} entries are asked for")]
    Null { what: &'static str, count: usize },
    #[error("a text of {what} is not UTF-8")]
    Text { what: &'static str },
    #[error("{bytes} bytes are too few for the state; it has {needed} (fmi2SerializedFMUstateSize)")]
    Room { bytes: usize, needed: usize },
    #[error("FMUs of flexframe have no {what}")]
    None { what: &'static str },
    #[error(
        "this is a bug of flexframe, in {function}: {words}. Please report it. The instance can only be freed, or reset by \
         fmi2Reset"
    )]
    Panic { function: &'static str, words: String },
    #[error("this instance has been stopped by a bug, which was reported before; free it, or call fmi2Reset")]
    Broken,
    #[error("the model of this instance was lost by a fault in flexframe; free the instance and make another")]
    Lost,
}

/// Errors of a motion that cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Step(#[from] StepError),
    #[error(transparent)]
    Review(#[from] AdviceError),
    #[error("at time {time:.6}: {words}")]
    Refused { time: f64, words: String },
}
