//! How a run is started and stopped, and how far it has come.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use model::{BuildProgress, Builder};

use super::estimate::Estimate;
use crate::commands::check::checked_rows::CheckProgress;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// The model is there, and the motion begins. A new run has written no file yet.
    Built,
    /// The estimate of the run. Nothing is written yet.
    Estimate(Estimate),
    /// Part of the time that has been passed, 0 to 1.
    Motion(f64),
    /// Rows are being checked by the full body.
    Check(CheckProgress),
}

/// How a run treats files, and how it is stopped.
#[derive(Debug, Clone, Default)]
pub struct RunSettings {
    /// Replaces what is there: a results file, and an unfinished run that is in the way.
    pub overwrite: bool,
    /// Allows a results file of more than 1 GB.
    pub large: bool,
    /// Leaves the shapes of the body out of the results file, for who reads its rows and throws it away.
    pub rows_alone: bool,
    /// Checks rows of each body against the full body at the end: those where its model is most likely to be wrong, as many as cost no
    /// more than its reduction did ([`check`](crate::check)).
    pub check: bool,
    /// The accuracy that is asked for: more rows are checked, without a limit of their cost, and other large modes are looked for where the
    /// model takes a part of the error ([`accuracy::run`](crate::accuracy::run())).
    pub accuracy: Option<f64>,
    /// Set from elsewhere, stops the run at its next row, or before where that is some thousand steps away.
    pub stop: Arc<AtomicBool>,
    /// The builder of the body.
    pub builder: Builder,
}
