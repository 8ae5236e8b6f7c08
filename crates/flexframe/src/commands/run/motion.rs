//! Motions of a run: of a body alone, or of bodies that joints, springs or bushings connect.

use dynamics::{
    CheckpointError, JointObservation, Moment, Observation, Reached, Simulation, Stats, StepError, SystemSimulation,
};
use scene::Scene;

/// A motion with steps of its own.
#[derive(Debug, Clone)]
pub(super) enum Motion {
    /// Of one body.
    Alone(Box<Simulation>),
    /// Of several bodies, or of one that is tied to the ground.
    Tied(Box<SystemSimulation>),
}

impl Motion {
    /// Time that it has come to.
    pub fn time(&self) -> f64 {
        match self {
            Self::Alone(simulation) => simulation.time(),
            Self::Tied(simulation) => simulation.time(),
        }
    }

    /// Time at which it ends.
    pub fn end(&self) -> f64 {
        match self {
            Self::Alone(simulation) => simulation.end(),
            Self::Tied(simulation) => simulation.end(),
        }
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
        match self {
            Self::Alone(simulation) => simulation.stats(),
            Self::Tied(simulation) => simulation.stats(),
        }
    }

    /// Steps tried so far.
    pub fn tried(&self) -> u64 {
        let Stats { accepted, rejected, .. } = self.stats();
        accepted + rejected
    }

    /// Keeps what [`Self::observe`] needs at times between steps. The steps of a tied motion end at the rows.
    pub fn keep_last_step(&mut self) {
        if let Self::Alone(simulation) = self {
            simulation.keep_last_step();
        }
    }

    /// Goes on to its next row, or as far as so many tries lead; `watch` sees each of its bodies at every step.
    pub fn advance(&mut self, tries: u64, mut watch: impl FnMut(usize, &Moment)) -> Result<Reached, StepError> {
        match self {
            Self::Alone(simulation) => simulation.advance_watched(tries, |moment| watch(0, moment)),
            Self::Tied(simulation) => simulation.advance_watched(tries, watch),
        }
    }

    /// Observes its bodies at the time that it has come to, or at one within its last step.
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

    /// Observes a joint, after [`Self::observe`]; a body alone has none.
    pub fn observe_joint(&self, joint: usize) -> JointObservation {
        match self {
            Self::Alone(_) => JointObservation::default(),
            Self::Tied(simulation) => simulation.observe_joint(joint),
        }
    }

    /// Sum of |work| + |dissipation| of all steps, of a body.
    pub fn exchanged(&self, body: usize) -> f64 {
        match self {
            Self::Alone(simulation) => simulation.exchanged(),
            Self::Tied(simulation) => simulation.exchanged(body),
        }
    }

    /// Its state, in as many words as that of any other time.
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        match self {
            Self::Alone(simulation) => simulation.checkpoint(),
            Self::Tied(simulation) => simulation.checkpoint(),
        }
    }

    /// Takes up the state of a checkpoint.
    pub fn restored(self, state: &[u64]) -> Result<Self, CheckpointError> {
        Ok(match self {
            Self::Alone(simulation) => Self::Alone(Box::new(simulation.restored(state)?)),
            Self::Tied(simulation) => Self::Tied(Box::new(simulation.restored(state)?)),
        })
    }
}
