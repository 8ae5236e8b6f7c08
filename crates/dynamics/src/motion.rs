//! A motion that a run steps: equations, a scheme, and the state that they have reached.

pub(crate) mod beginning;
pub(crate) mod stepper;

use std::any::Any;
use std::fmt;

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::error::{SetupError, StepError};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::simulation::checkpoint::CheckpointError;

/// Estimated errors under step control, relative to the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// Error of the step that was tried.
    pub step: f64,
    /// Error to be expected of a step twice as long.
    pub doubled: f64,
}

/// A system in motion: equations with a scheme.
///
/// [`Simulation`](crate::Simulation) decides where steps end and asks for them one by one. Between steps a motion holds
/// one state.
pub trait Motion: fmt::Debug + Send + Sync + Any {
    /// Time of the state.
    fn time(&self) -> f64;

    /// Does one step of length `h` that ends at time `end` (= time + h but for rounding).
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError>;

    /// Tries to go on by `h` to `end`, and does so where its estimate of the error is at most `tolerance`. Returns the
    /// estimate, and that of a step twice as long.
    ///
    /// # Errors
    /// [`StepError`] where even the try fails; the state stays. A scheme without an estimate always fails.
    fn controlled_step(&mut self, h: f64, end: f64, tolerance: f64) -> Result<ErrorEstimate, StepError> {
        let _ = (h, end, tolerance);
        Err(StepError::NoErrorEstimate { time: self.time() })
    }

    /// A load or a drive may jump at the time of the state.
    ///
    /// # Errors
    /// [`StepError`].
    fn pass_discontinuity(&mut self) -> Result<(), StepError> {
        Ok(())
    }

    /// Tells that the loads have been changed from outside between two steps: rates that were found before no longer hold.
    fn loads_have_changed(&mut self) {}

    /// Takes up the energy scale of the loads up to `end` as they are now, and returns it. Asked for after a change of the
    /// loads, where steps may be blind to their work.
    fn raise_energy_of_loads(&mut self, end: f64) -> f64 {
        let _ = end;
        0.0
    }

    /// Fills `out` with the motion at the state, and that of `points`.
    ///
    /// # Errors
    /// [`StepError`].
    fn observe(&mut self, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError>;

    /// The state, in quantities that every formulation has.
    ///
    /// # Errors
    /// [`StepError`] where the velocities cannot be found from the momenta.
    fn state(&self) -> Result<MotionState, StepError>;

    /// Goes on from another state.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    fn set_state(&mut self, state: &MotionState) -> Result<(), SetupError>;

    /// Takes over the state of another scheme of the same type and body, without allocating. Does nothing for another
    /// type.
    fn copy_state(&mut self, from: &dyn Motion);

    /// The motion where its rates were last found.
    fn moment(&self) -> Moment<'_>;

    /// Energies where they were last found; `None` where they say nothing, as under a drive.
    fn energies(&self) -> Option<Energies>;

    /// Work of the loads and energy that damping has taken, since the beginning.
    fn work_and_dissipation(&self) -> [f64; 2];

    /// Largest of ω_k and 2 ζ_k ω_k.
    fn fastest_rate(&self) -> f64;

    /// Evaluations of the rates so far.
    fn evaluations(&self) -> u64;

    /// Number of flexible modes.
    fn flexible(&self) -> usize;

    /// All that a run needs to go on bit for bit, as bytes: [`encode`](crate::encode) makes them. They are equally many
    /// for all states of a run.
    ///
    /// # Errors
    /// [`CheckpointError::Encoding`].
    fn save(&self) -> Result<Vec<u8>, CheckpointError>;

    /// Goes on from what was saved, after checking its sizes and numbers.
    ///
    /// # Errors
    /// [`CheckpointError`] for bytes that are not those of such a state.
    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError>;

    /// A copy.
    fn boxed_clone(&self) -> Box<dyn Motion>;
}

impl Clone for Box<dyn Motion> {
    fn clone(&self) -> Self {
        (**self).boxed_clone()
    }
}
