//! Bodies that move together by steps of their own.

use crate::body::motion_state::MotionState;
use crate::error::{SetupError, StepError};
use crate::observation::Observation;
use crate::observation::moment::Moment;
use crate::simulation::checkpoint::CheckpointError;
use crate::simulation::events::Event;
use crate::simulation::stats::Stats;
use crate::simulation::{Reached, Simulation};
use crate::system::joint::observation::JointObservation;
use crate::system::simulation::SystemSimulation;
use crate::system::simulation::observation::SystemObservation;

/// Bodies that nothing ties to others, with steps of their own.
#[derive(Debug, Clone)]
pub struct Island {
    /// Their motion.
    pub motion: IslandMotion,
    /// Numbers of its bodies in the run.
    pub bodies: Vec<usize>,
    /// Numbers of its joints in the rows of the run.
    pub joints: Vec<usize>,
    /// Numbers of its springs and bushings in the rows, which come after the joints.
    pub elements: Vec<usize>,
}

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

/// The motion of an island. Bodies, joints and elements are numbered within the island.
#[derive(Debug, Clone)]
pub enum IslandMotion {
    /// One body, which nothing ties.
    Body(Box<Simulation>),
    /// Bodies that joints, springs or bushings tie together or to the ground.
    System(Box<SystemSimulation>),
}

/// Calls the method of the same name of either.
macro_rules! either {
    ($motion:expr, $of:ident => $call:expr) => {
        match $motion {
            IslandMotion::Body($of) => $call,
            IslandMotion::System($of) => $call,
        }
    };
}

impl Island {
    /// Observes its bodies, and its joints, springs and bushings at their numbers in a row, where the motion is or at a time within its
    /// last step.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn observe<'o>(
        &mut self,
        within: Option<f64>,
        bodies: impl IntoIterator<Item = &'o mut Observation>,
        joints: &mut [JointObservation],
    ) -> Result<(), StepError> {
        let Self { motion, .. } = self;
        motion.observe(within, bodies)?;
        let IslandMotion::System(simulation) = motion else { return Ok(()) };
        for (joint, place) in self.joints.iter().enumerate() {
            joints[*place] = simulation.observe_joint(joint);
        }
        for (element, place) in self.elements.iter().enumerate() {
            joints[*place] = simulation.observe_element(element);
        }
        Ok(())
    }
}

impl IslandMotion {
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
        matches!(self, Self::Body(simulation) if simulation.row_is_due())
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
        if let Self::Body(simulation) = self {
            simulation.keep_last_step();
        }
    }

    /// Goes on to its next row, event or stop, or for at most `tries` tries of a step; `watch` sees each of its bodies at every step.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn advance(&mut self, tries: u64, mut watch: impl FnMut(usize, &Moment)) -> Result<Reached, StepError> {
        match self {
            Self::Body(simulation) => simulation.advance_watched(tries, |moment| watch(0, moment)),
            Self::System(simulation) => simulation.advance_watched(tries, watch),
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
            Self::Body(simulation) => out.into_iter().try_for_each(|out| match within {
                Some(time) => simulation.interpolate(time, out),
                None => simulation.observe(out),
            }),
            Self::System(simulation) => simulation.observe(out),
        }
    }

    /// Room for the motion of a body.
    pub fn room(&self, body: usize) -> Observation {
        match self {
            Self::Body(simulation) => simulation.room(),
            Self::System(simulation) => simulation.room(body),
        }
    }

    /// The simulation of bodies in joints.
    pub fn system(&self) -> Option<&SystemSimulation> {
        match self {
            Self::Body(_) => None,
            Self::System(simulation) => Some(simulation),
        }
    }

    /// The state of each of its bodies.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        match self {
            Self::Body(simulation) => Ok(vec![simulation.state()?]),
            Self::System(simulation) => {
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
            Self::Body(simulation) => states.iter().try_for_each(|state| simulation.set_state(state)),
            Self::System(simulation) => simulation.set_states(states),
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

    /// Stops with [`Reached::Event`] where a function of its bodies, joints and elements passes through zero. Returns the event's number.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn add_event(&mut self, event: Event<SystemObservation>) -> Result<usize, StepError> {
        match self {
            Self::Body(simulation) => simulation.add_event(event.of_body()),
            Self::System(simulation) => simulation.add_event(event),
        }
    }

    /// Name of an event by its number.
    pub fn event_name(&self, number: usize) -> Option<&str> {
        either!(self, of => of.event(number).map(|event| event.name()))
    }

    /// Energies of the run so far that the balances of a body are counted over.
    pub fn energies(&self, body: usize) -> RunEnergies {
        match self {
            Self::Body(simulation) => {
                RunEnergies { exchanged: simulation.exchanged(), at_rest: 0.0, open_together: None }
            }
            Self::System(simulation) => RunEnergies {
                exchanged: simulation.exchanged(body),
                at_rest: simulation.energy_at_rest(body),
                open_together: Some(simulation.open_energy()),
            },
        }
    }

    /// State of the motion, in equally many words at any time.
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
            Self::Body(simulation) => Self::Body(Box::new(simulation.restored(state)?)),
            Self::System(simulation) => Self::System(Box::new(simulation.restored(state)?)),
        })
    }
}
