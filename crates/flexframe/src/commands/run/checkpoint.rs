//! Checkpoints of the motions of a run.

use std::path::Path;

use dynamics::CheckpointError;

use super::error::RunError;
use crate::motion::Motion;

/// The number of the files that the run reads ([`identity_of_files`](crate::files::identity::identity_of_files)), and the states of all motions, one after the
/// other: each takes the same room at any time.
pub(super) fn checkpoint<'m>(
    identity: u64,
    motions: impl IntoIterator<Item = &'m Motion>,
    part: &Path,
) -> Result<Vec<u64>, RunError> {
    let states = motions.into_iter().map(Motion::checkpoint);
    let words = std::iter::once(Ok(vec![identity])).chain(states).collect::<Result<Vec<_>, _>>();
    Ok(words.map_err(|source| RunError::Restore { part: part.to_owned(), source })?.concat())
}

/// A motion in its state, the first of those in a checkpoint, which become the others.
pub(super) fn restored(motion: Motion, states: &mut &[u64]) -> Result<Motion, CheckpointError> {
    let (state, rest) = states.split_at(motion.checkpoint()?.len().min(states.len()));
    *states = rest;
    motion.restored(state)
}
