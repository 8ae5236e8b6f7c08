//! A motion that a run steps: equations, a scheme, and the state that they have reached.

pub(crate) mod beginning;
pub(crate) mod facts;
pub(crate) mod stepper;

use std::any::Any;
use std::fmt;

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::error::{BodyName, SetupError, StepError};
use crate::motion::facts::{Balance, MotionFacts};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::simulation::checkpoint::CheckpointError;
use crate::system::joint::observation::JointObservation;
use crate::tolerance::ErrorMeasure;
use crate::tolerance::allowance::ErrorEstimate;

/// Bodies in motion: equations with a scheme. Bodies, joints and force elements have numbers from 0.
///
/// [`Simulation`](crate::Simulation) decides where steps end and asks for them one by one. Between steps a motion holds
/// one state. What bodies in joints alone have is left out by a motion of one body.
pub trait Motion: fmt::Debug + Send + Sync + Any {
    /// Constants of the motion. A run asks for them once.
    fn facts(&self) -> MotionFacts;

    /// Time of the state.
    fn time(&self) -> f64;

    /// A step is to be tried, whose start is kept by then: numbers by which the state is held may be exchanged now.
    fn begin_step(&mut self) {}

    /// Does one step of length `h` that ends at time `end` (= time + h but for rounding).
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError>;

    /// Tries to go on by `h` to `end`, and does so where its estimate of the error is at most `tolerance`. Returns the
    /// estimate, and the estimate for a step twice as long. It controls steps [in pairs](crate::Stepping::Pairs).
    ///
    /// # Errors
    /// [`StepError`] where even the try fails; the state stays. A scheme without an estimate always fails.
    fn controlled_step(&mut self, h: f64, end: f64, tolerance: f64) -> Result<ErrorEstimate, StepError> {
        let _ = (h, end, tolerance);
        Err(StepError::NoErrorEstimate { time: self.time() })
    }

    /// Tries one step towards `end`, about as long as `h`, which becomes the length of the next try, and takes it where its error is at
    /// most its share of the tolerance. Returns the length of a step that was taken. [Free](crate::Stepping::Free) steps are controlled
    /// by it.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough. A scheme without an estimate always fails.
    fn free_step(&mut self, end: f64, measure: &mut ErrorMeasure, h: &mut f64) -> Result<Option<f64>, StepError> {
        let _ = (end, measure, h);
        Err(StepError::NoErrorEstimate { time: self.time() })
    }

    /// Does a part of a step once more, to `end`, with iterations as exact as `exactness`: where events are looked for.
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    fn part_of_step(&mut self, h: f64, end: f64, exactness: f64) -> Result<(), StepError> {
        let _ = exactness;
        self.step(h, end)
    }

    /// Goes to a time within a step, from the motion `before` it, as the motion `after` it knows the way. Rows within
    /// [free](crate::Stepping::Free) steps are found so.
    ///
    /// # Errors
    /// [`StepError`], for a motion whose steps know only their ends always.
    fn go_within(&mut self, before: &dyn Motion, after: &dyn Motion, time: f64) -> Result<(), StepError> {
        Err(StepError::OutsideLastStep { time, from: before.time(), to: after.time() })
    }

    /// A step has been taken, as far as an event within it. Returns the work of the loads and the energy that damping has taken, of all
    /// bodies since the beginning.
    fn step_is_done(&mut self) -> [f64; 2];

    /// A load or a drive may jump at the time of the state.
    ///
    /// # Errors
    /// [`StepError`].
    fn pass_discontinuity(&mut self) -> Result<(), StepError> {
        Ok(())
    }

    /// Tells that the loads have been changed from outside between two steps, or the step cut short: rates that were found before no
    /// longer hold.
    fn loads_have_changed(&mut self) {}

    /// Takes up the energy scale of the loads up to `end` as they are now, and returns it. Asked for after a change of the
    /// loads, where steps may be blind to their work.
    fn raise_energy_of_loads(&mut self, end: f64) -> f64 {
        let _ = end;
        0.0
    }

    /// Finds what observations of several bodies need in common.
    ///
    /// # Errors
    /// [`StepError`].
    fn begin_observation(&mut self) -> Result<(), StepError> {
        Ok(())
    }

    /// Fills `out` with the motion of a body at the state, and the motion of its `points`.
    ///
    /// # Errors
    /// [`StepError`].
    fn observe(&mut self, body: usize, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError>;

    /// Observes a joint, after [`Self::begin_observation`].
    fn observe_joint(&self, joint: usize) -> JointObservation {
        let _ = joint;
        JointObservation::default()
    }

    /// Observes a force element, after [`Self::begin_observation`]; zeros of one that does not show what it does.
    fn observe_element(&self, element: usize) -> JointObservation {
        let _ = element;
        JointObservation::default()
    }

    /// Name of a body for messages, where there may be several.
    fn name_of(&self, body: usize) -> Option<BodyName> {
        let _ = body;
        None
    }

    /// The state of each body, in quantities that every formulation has.
    ///
    /// # Errors
    /// [`StepError`] where the velocities cannot be found from the momenta.
    fn states(&self) -> Result<Vec<MotionState>, StepError>;

    /// Goes on from other states of the bodies, at the time of the first.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite; the motion then stays.
    fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError>;

    /// Takes over the state of another scheme of the same type and bodies, without allocating. Does nothing for another
    /// type.
    fn copy_state(&mut self, from: &dyn Motion);

    /// The motion of a body where its rates were last found.
    fn moment(&self, body: usize) -> Moment<'_>;

    /// Energies where they were last found; `None` where they say nothing, as under a drive, or are known at rows alone.
    fn energies(&self) -> Option<Energies>;

    /// The energies of a row whose bodies have these in sum, at a time since the beginning, for the account of the energy.
    fn balance(&self, sum: &Energies, elapsed: f64) -> Option<Balance> {
        let _ = (sum, elapsed);
        self.energies().map(Balance::of)
    }

    /// Energy that a body has exchanged, and that below which it rests; `None` where the sum over the steps counts, and nothing rests.
    fn exchanged(&self, body: usize) -> Option<[f64; 2]> {
        let _ = body;
        None
    }

    /// Evaluations of the rates so far.
    fn evaluations(&self) -> u64;

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
