//! A run that begins.

use crate::body::shapes::PointShapes;
use crate::motion::Motion;
use crate::simulation::account::EnergyAccount;
use crate::simulation::fingerprint::Fingerprint;
use crate::simulation::longest_step::LongestStep;
use crate::simulation::plan::{Rows, StepControl};

/// A run that begins: the motion, and what leads it.
pub(crate) struct Begun {
    pub motion: Box<dyn Motion>,
    pub fingerprint: Fingerprint,
    pub account: EnergyAccount,
    pub may_miss_work: bool,
    pub longest_step: LongestStep,
    /// Jumps of what is no load and no drive.
    pub jumps: Vec<f64>,
    pub control: StepControl,
    pub end: f64,
    pub rows: Rows,
    pub points: Vec<Vec<PointShapes>>,
}
