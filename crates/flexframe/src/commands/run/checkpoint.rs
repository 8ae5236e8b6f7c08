//! Checkpoints of the simulations of a run.

use std::path::Path;

use dynamics::{CheckpointError, Simulation};

use super::error::RunError;

/// The states of all simulations, one after the other: each takes the same room at any time.
pub(super) fn checkpoint<'s>(
    simulations: impl IntoIterator<Item = &'s Simulation>,
    part: &Path,
) -> Result<Vec<u64>, RunError> {
    let states = simulations.into_iter().map(Simulation::checkpoint).collect::<Result<Vec<_>, _>>();
    Ok(states.map_err(|source| RunError::Restore { part: part.to_owned(), source })?.concat())
}

/// The simulations in the states of a checkpoint.
pub(super) fn restored(simulations: Vec<Simulation>, mut states: &[u64]) -> Result<Vec<Simulation>, CheckpointError> {
    let state = |simulation: Simulation| {
        let (state, rest) = states.split_at(simulation.checkpoint()?.len().min(states.len()));
        states = rest;
        simulation.restored(state)
    };
    simulations.into_iter().map(state).collect()
}
