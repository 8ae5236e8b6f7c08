//! What steps a body: the trait of all schemes, and the list of those that a scene can name.

use std::any::Any;
use std::fmt;
use std::sync::LazyLock;

use crate::account::Energies;
use crate::checkpoint::StateCoder;
use crate::error::{SetupError, StepError};
use crate::moment::Moment;
use crate::motion::PointShapes;
use crate::observation::Observation;
use crate::simulation::Setup;
use crate::state::MotionState;
use crate::{conservative_motion, paper, paper_limit};

/// A body in motion: a formulation of its equations with a time integration of them.
///
/// [`Simulation`](crate::Simulation) decides where steps end and asks for them one by one. Between steps a scheme holds
/// one state.
pub trait Scheme: fmt::Debug + Send + Sync + Any {
    /// Time of the state.
    fn time(&self) -> f64;

    /// Does one step of length `h` that ends at time `end` (= time + h but for rounding).
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError>;

    /// Tries to go on by `h` to `end`, and does so where its estimate of the error is at most `tolerance`. Returns the
    /// estimate.
    ///
    /// # Errors
    /// [`StepError`] where even the try fails; the state stays. A scheme without an estimate always fails.
    fn controlled_step(&mut self, h: f64, end: f64, tolerance: f64) -> Result<f64, StepError> {
        let _ = (h, end, tolerance);
        Err(StepError::NoErrorEstimate { time: self.time() })
    }

    /// A load or a drive may jump at the time of the state.
    ///
    /// # Errors
    /// [`StepError`].
    fn pass_corner(&mut self) -> Result<(), StepError> {
        Ok(())
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
    fn copy_state(&mut self, from: &dyn Scheme);

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

    /// Encodes or decodes the state, all that a run needs to go on bit for bit.
    fn code(&mut self, coder: &mut StateCoder<'_>);

    /// A copy.
    fn boxed_clone(&self) -> Box<dyn Scheme>;
}

impl Clone for Box<dyn Scheme> {
    fn clone(&self) -> Self {
        (**self).boxed_clone()
    }
}

/// What limits the step of a scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepLimit {
    /// The fastest mode, at about 2.83/ω_max.
    Modes,
    /// The spin: the largest angle in rad that the body may turn through in a step.
    Turn(f64),
}

/// A scheme that a scene can name.
#[derive(Clone, Copy)]
pub struct Method {
    /// The name of its formulation: "paper" or "conservative".
    pub formulation: &'static str,
    /// Its name.
    pub scheme: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// Evaluations of the rates that a step takes.
    pub evaluations_per_step: u32,
    /// What limits its step.
    pub limit: StepLimit,
    /// Whether it estimates the error of a step.
    pub estimates_error: bool,
    /// Begins a motion.
    pub(crate) begin: fn(&Setup) -> Result<Box<dyn Scheme>, SetupError>,
}

impl Method {
    /// The list of all of them.
    pub const ALL: [Self; 4] =
        [paper::METHOD, paper_limit::METHOD, conservative_motion::RKMK4, conservative_motion::EXPONENTIAL];
    /// The paper's scheme, literally.
    pub const PAPER: Self = paper::METHOD;
    /// The limit of the paper's scheme, by RKMK4.
    pub const PAPER_RKMK4: Self = paper_limit::METHOD;
    /// The conservative form by classical Runge–Kutta.
    pub const RKMK4: Self = conservative_motion::RKMK4;
    /// The conservative form by the exponential scheme: the default.
    pub const EXPONENTIAL: Self = conservative_motion::EXPONENTIAL;

    /// The scheme of this name; where no formulation is named, that of the conservative form comes first. `None` where
    /// the list has no such pair.
    pub fn named(formulation: Option<&str>, scheme: &str) -> Option<Self> {
        let fits =
            |method: &&Self| method.scheme == scheme && formulation.is_none_or(|name| method.formulation == name);
        Self::ALL.iter().filter(fits).max_by_key(|method| !method.is_of_paper()).copied()
    }

    /// The names of all schemes, each once.
    pub fn scheme_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| once_each(|method| method.scheme));
        &NAMES
    }

    /// The names of all formulations, each once.
    pub fn formulation_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| once_each(|method| method.formulation));
        &NAMES
    }

    /// Whether it is of the paper's formulation.
    pub fn is_of_paper(&self) -> bool {
        self.formulation == "paper"
    }

    /// Whether its step is limited by the fastest mode; otherwise by the spin.
    pub fn is_limited_by_modes(&self) -> bool {
        self.limit == StepLimit::Modes
    }
}

fn once_each(name: fn(&Method) -> &'static str) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for method in &Method::ALL {
        if !names.contains(&name(method)) {
            names.push(name(method));
        }
    }
    names
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        (self.formulation, self.scheme) == (other.formulation, other.scheme)
    }
}

impl Eq for Method {}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.formulation, self.scheme)
    }
}
