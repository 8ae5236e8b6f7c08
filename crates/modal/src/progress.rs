//! How far a solution has come.

use crate::memory_estimate::Forecast;

/// How far a solution has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// An order of the unknowns is being sought in which the factor of K + sM has few entries.
    Ordering,
    /// K + sM is being factored, or the problem on the corners of the elements where multigrid cycles take its place.
    Factorizing(Forecast),
    /// Modes that have converged, of those asked for. Where multigrid cycles find them, all converge together: then it is how
    /// far they have come, as a number of modes.
    Lanczos {
        /// Converged.
        converged: usize,
        /// Asked for.
        requested: usize,
    },
    /// A phase of an [`Engine`](crate::Engine).
    Engine(EnginePhase),
}

/// A phase of an [`Engine`](crate::Engine). Its search for modes is [`Progress::Lanczos`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EnginePhase {
    /// K and M are written for it.
    Writing,
    /// It starts, and reads them.
    Starting,
    /// It factors K + sM.
    Factorizing,
    /// It counts the eigenvalues.
    Counting,
}
