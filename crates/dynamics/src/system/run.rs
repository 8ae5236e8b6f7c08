//! Bodies in joints in a run: how they were put together, and how their steps went.

pub(crate) mod locked;
mod motion;
pub(crate) mod second_order;
pub(crate) mod setup;
mod stops;

use crate::conservative::ConservativeBody;
use crate::equations::Equations;
use crate::error::{RateError, SetupError, StepError};
use crate::load::SharedLoad;
use crate::simulation::account::EnergyAccount;
use crate::simulation::begun::Begun;
use crate::simulation::fingerprint::Fingerprint;
use crate::simulation::longest_step::LongestStep;
use crate::simulation::plan::StepControl;
use crate::system::radau::estimate::energy_of_way;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::run::second_order::Branching;
use crate::system::run::setup::{Assembled, Placed, ShapeLimit, SystemSetup, assemble, size};
use crate::vibration::system::Stability;

/// Longest step of an explicit scheme under step control, as a part of what the fastest shape allows.
const STABLE: f64 = 0.9;
/// Error of a fixed step over the size of a body that is taken for what it does not see.
const FIXED_ERROR: f64 = 1e-4;
/// Way of a body over the size of a body within which it rests in fixed steps.
const FIXED_REST: f64 = 1e-9;
/// Speed of what begins to move as t³, over its mean speed since then.
const BEGINS: f64 = 3.0;

/// Bodies in joints on their way through a run.
#[derive(Debug, Clone)]
pub struct SystemRun {
    motion: SystemMotion,
    end: f64,
    /// The tolerance of the run.
    tolerance: Option<f64>,
    shape_limit: Option<ShapeLimit>,
    size: f64,
    /// Sum of the largest forces of the loads of each body.
    forces: f64,
    placed: Placed,
    redundant: Vec<(String, usize)>,
    longest_step: f64,
    largest_residual: f64,
    undecided_at: Option<f64>,
    rounding_of_places: f64,
    /// Largest |work of loads, joints and elements| + |dissipation| of each body since the beginning.
    exchanged: Vec<f64>,
    /// Way of each body in its frame since the beginning, as it moves and turns.
    gone: Vec<f64>,
}

impl SystemRun {
    /// Puts the bodies together, and begins their run.
    pub(crate) fn begin(setup: SystemSetup) -> Result<Begun, SetupError> {
        setup.check()?;
        let (shape_limit, fingerprint) = (setup.shape_limit(), Fingerprint::of_system(&setup));
        let SystemSetup { system, states, start, scheme, control, end, rows, points } = setup;
        let mut motion = SystemMotion::new(system, &states)?.with_scheme(scheme);
        let size = size(&motion, &states);
        let placed = assemble(&mut motion, &states, start, [size, end])?;
        let is_implied = motion.implied_rows();
        let implied = motion.system().connections.sums(is_implied.iter().map(|is_implied| usize::from(*is_implied)));
        let redundant = implied.into_iter().filter(|(_, rows)| *rows > 0).map(|(name, rows)| (name.to_owned(), rows));
        let redundant = redundant.collect();
        let system = motion.system();
        let loads: Vec<SharedLoad> = system.bodies().iter().flat_map(|body| body.loads()).cloned().collect();
        let longest_step = LongestStep::new(&loads, system.joints().iter().flat_map(|joint| joint.histories()), end)?;
        let force = |body: &ConservativeBody| (body.mass() * body.sizes_of_loads(end).acceleration).sqrt();
        let forces = system.bodies().iter().map(force).sum();
        let jumps = system.connections.discontinuities().collect();
        let tolerance = match control {
            StepControl::Fixed(_) => None,
            StepControl::Tolerance(tolerance) => Some(tolerance),
        };
        let zeros = vec![0.0; system.bodies().len()];
        let run = Self {
            motion,
            end,
            tolerance,
            shape_limit,
            size,
            forces,
            placed,
            redundant,
            longest_step: 0.0,
            largest_residual: 0.0,
            undecided_at: None,
            rounding_of_places: 0.0,
            exchanged: zeros.clone(),
            gone: zeros,
        };
        let (motion, account) = (Box::new(run), EnergyAccount::default());
        let may_miss_work = false;
        Ok(Begun { motion, fingerprint, account, may_miss_work, longest_step, jumps, control, end, rows, points })
    }

    /// The motion, at the end of the last step.
    pub fn motion(&self) -> &SystemMotion {
        &self.motion
    }

    /// Changes of each body by which the joints closed at the beginning.
    pub fn assembled(&self) -> &[Assembled] {
        &self.placed.changes
    }

    /// Largest distance of two bodies at the beginning, or the largest radius of gyration, if that is more.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Names of the joints and couplings with rows that others imply where bodies are rigid, at the beginning, each with how many:
    /// what they bear is then not determined by rigid bodies, but by how the bodies give.
    pub fn redundant(&self) -> &[(String, usize)] {
        &self.redundant
    }

    /// The equilibrium that it has begun at, where it has begun at one.
    pub fn stability(&self) -> Option<Stability> {
        self.placed.stability
    }

    /// The branches of the motion at the beginning, if there are two.
    pub fn branching(&self) -> Option<&Branching> {
        self.placed.branching.as_ref()
    }

    /// The largest residual of all rows of joints and couplings at the ends of the steps so far, as a length over the size of the system.
    pub fn largest_residual(&self) -> f64 {
        self.largest_residual
    }

    /// The first time at which a linkage has passed so near a singular position that the rounding of places of the ground decides how it goes
    /// on.
    pub fn undecided_at(&self) -> Option<f64> {
        self.undecided_at
    }

    /// The largest rounding of places of bodies at the ends of the steps so far, over the size of the largest body: bodies that run far along
    /// a rail, from where a joint holds it to the ground, lose digits.
    pub fn rounding_of_places(&self) -> f64 {
        self.rounding_of_places
    }

    /// Degrees of freedom that the joints leave rigid bodies at the beginning.
    pub fn rigid_dofs(&self) -> usize {
        let system = self.motion.system();
        let implied: usize = self.redundant.iter().map(|(_, rows)| rows).sum();
        (system.rigid_coordinates() + implied).saturating_sub(system.rows())
    }

    /// The limit that shapes set for the steps, if the scheme is one that they limit and steps have come near to it.
    pub fn met_shape_limit(&self) -> Option<ShapeLimit> {
        self.shape_limit.filter(|of| self.longest_step > 0.9 * STABLE * of.limit)
    }

    /// Energy below which a body rests: the energy of a motion that moves its place by no more than the error allowed in all of the run, and,
    /// of a rigid body that has gone no farther, the work of the loads over this way.
    fn energy_at_rest(&self, body: usize) -> f64 {
        let way = self.tolerance.unwrap_or(FIXED_REST) * self.motion.size();
        let of = &self.motion.system().bodies()[body];
        let pushed = if of.flexible() == 0 && self.gone[body] <= way { self.forces * way } else { 0.0 };
        energy_of_way(of.mass(), way, self.end) + pushed
    }

    /// Energy of bodies that have moved by the error that is allowed in a time, a part of the size of the largest, and the work of
    /// their loads over it: what has moved less has work that steps do not see.
    fn unseen_energy(&self, elapsed: f64) -> f64 {
        let mass: f64 = self.motion.system().bodies().iter().map(ConservativeBody::mass).sum();
        let way = self.tolerance.unwrap_or(FIXED_ERROR) * self.motion.size();
        if elapsed > 0.0 { energy_of_way(mass, BEGINS * way, elapsed) + self.forces * way } else { 0.0 }
    }

    /// An error of the rates where the motion is.
    fn in_step(&self, error: RateError) -> StepError {
        error.in_step(self.motion.time(), self.longest_step)
    }
}

/// The error of a step that was not done.
fn of_step(failed: Failed, time: f64, step: f64) -> StepError {
    match failed {
        Failed::Newton => StepError::Newton { time, step },
        Failed::Rates(error) => error.in_step(time, step),
        Failed::Open { joints, gap } => StepError::Open { time: time + step, joints, gap },
    }
}
