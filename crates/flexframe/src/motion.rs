//! Motions of a scene: of a body alone, or of bodies that joints, springs or bushings connect. Every command that moves bodies moves
//! them by these.

mod beginning;
pub(crate) mod described;
pub(crate) mod row_times;

use dynamics::{
    CheckpointError, JointObservation, Moment, MotionState, Observation, Reached, SetupError, Simulation, Stats,
    StepError, SystemSimulation,
};
use scene::Scene;

pub use beginning::{BeginError, Beginning, BodyForces, JointForces, MarkerForces, Moving, OwnEquation, begin};

/// Energies of a run that the balances of a body are counted over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunEnergies {
    /// Energy that has come and gone: the sum of |work| + |dissipation| of all steps of a body that moves alone, whose loads the stages sum up;
    /// the largest of both since the beginning of one in joints.
    pub exchanged: f64,
    /// Energy below which a body in joints rests; zero of one alone.
    pub at_rest: f64,
    /// Largest energy of all bodies in joints together for which works and dissipation do not account.
    pub open_together: Option<f64>,
}

/// A motion with steps of its own.
#[derive(Debug, Clone)]
pub enum Motion {
    /// The motion of one body.
    Alone(Box<Simulation>),
    /// The motion of several bodies, or of one that is tied to the ground.
    Tied(Box<SystemSimulation>),
}

/// Calls the method of the same name of either.
macro_rules! either {
    ($motion:expr, $of:ident => $call:expr) => {
        match $motion {
            Motion::Alone($of) => $call,
            Motion::Tied($of) => $call,
        }
    };
}

impl Motion {
    /// Time that it has come to.
    pub fn time(&self) -> f64 {
        either!(self, of => of.time())
    }

    /// Time at which it ends.
    pub fn end(&self) -> f64 {
        either!(self, of => of.end())
    }

    /// True if neither a step nor a row is to come.
    pub fn is_over(&self) -> bool {
        either!(self, of => of.is_over())
    }

    /// True if a row falls on what has been reached, and comes next without a step.
    pub fn row_is_due(&self) -> bool {
        matches!(self, Self::Alone(simulation) if simulation.row_is_due())
    }

    /// Name of its scheme, of a scene.
    pub fn scheme<'s>(&self, scene: &'s Scene) -> &'s str {
        match self {
            Self::Alone(_) => scene.time.method.scheme,
            Self::Tied(_) => scene.time.system_scheme.name(),
        }
    }

    /// Its cost so far.
    pub fn stats(&self) -> Stats {
        either!(self, of => of.stats())
    }

    /// Steps tried so far.
    pub fn tried(&self) -> u64 {
        let Stats { accepted, rejected, .. } = self.stats();
        accepted + rejected
    }

    /// Keeps what [`Self::observe`] needs at times between steps. A tied motion has its rows there by itself.
    pub fn keep_last_step(&mut self) {
        if let Self::Alone(simulation) = self {
            simulation.keep_last_step();
        }
    }

    /// Goes on to its next row, event or stop, or for at most `tries` tries of a step; `watch` sees each of its bodies at every step.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn advance(&mut self, tries: u64, mut watch: impl FnMut(usize, &Moment)) -> Result<Reached, StepError> {
        match self {
            Self::Alone(simulation) => simulation.advance_watched(tries, |moment| watch(0, moment)),
            Self::Tied(simulation) => simulation.advance_watched(tries, watch),
        }
    }

    /// Observes its bodies at the time that it has come to, or at one within its last step.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn observe<'o>(
        &mut self,
        within: Option<f64>,
        out: impl IntoIterator<Item = &'o mut Observation>,
    ) -> Result<(), StepError> {
        match self {
            Self::Alone(simulation) => out.into_iter().try_for_each(|out| match within {
                Some(time) => simulation.interpolate(time, out),
                None => simulation.observe(out),
            }),
            Self::Tied(simulation) => simulation.observe(out),
        }
    }

    /// Observes its joints and elements, at their numbers in a row, after [`Self::observe`]; a body alone has none.
    pub fn observe_ties(&self, [joints, elements]: [&[usize]; 2], row: &mut [JointObservation]) {
        let Self::Tied(simulation) = self else { return };
        for (joint, place) in joints.iter().enumerate() {
            row[*place] = simulation.observe_joint(joint);
        }
        for (element, place) in elements.iter().enumerate() {
            row[*place] = simulation.observe_element(element);
        }
    }

    /// The state of each of its bodies.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        match self {
            Self::Alone(simulation) => Ok(vec![simulation.state()?]),
            Self::Tied(simulation) => {
                let (motion, time) = (simulation.motion(), simulation.time());
                let bodies = 0..motion.system().bodies().len();
                bodies.map(|body| motion.state(body).map_err(|error| error.in_step(time, 0.0))).collect()
            }
        }
    }

    /// Goes on from other states of its bodies, at the time of the first.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        match self {
            Self::Alone(simulation) => states.iter().try_for_each(|state| simulation.set_state(state)),
            Self::Tied(simulation) => simulation.set_states(states),
        }
    }

    /// Ends a step at this time and stops there, once. `None` takes it back.
    pub fn set_stop_time(&mut self, time: Option<f64>) {
        either!(self, of => of.set_stop_time(time));
    }

    /// Says that something that a load reads has been changed since the last step.
    pub fn loads_have_changed(&mut self) {
        either!(self, of => of.loads_have_changed());
    }

    /// Name of an event by its number.
    pub fn event_name(&self, number: usize) -> Option<&str> {
        either!(self, of => of.event(number).map(|event| event.name()))
    }

    /// Energies of the run so far that the balances of a body are counted over.
    pub fn energies(&self, body: usize) -> RunEnergies {
        match self {
            Self::Alone(simulation) => {
                RunEnergies { exchanged: simulation.exchanged(), at_rest: 0.0, open_together: None }
            }
            Self::Tied(simulation) => RunEnergies {
                exchanged: simulation.exchanged(body),
                at_rest: simulation.energy_at_rest(body),
                open_together: Some(simulation.open_energy()),
            },
        }
    }

    /// Its state, in as many words as that of any other time.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        either!(self, of => of.checkpoint())
    }

    /// Takes up the state of a checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError`] for one of another run.
    pub fn restored(self, state: &[u64]) -> Result<Self, CheckpointError> {
        Ok(match self {
            Self::Alone(simulation) => Self::Alone(Box::new(simulation.restored(state)?)),
            Self::Tied(simulation) => Self::Tied(Box::new(simulation.restored(state)?)),
        })
    }
}
