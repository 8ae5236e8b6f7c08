//! Solvers outside of this program for the large problems of a body, where the factor of K + sM does not fit into it.

use std::time::Duration;

use faer::{Mat, MatRef};

use crate::error::EngineError;
use crate::progress::Progress;
use crate::support::held_problem::HeldProblem;

/// A solver that finds eigenpairs and static responses in the place of the factor of K + sM here.
///
/// Vectors and forces have a row for each unknown of the [`HeldProblem`].
pub trait Engine: Send + Sync {
    /// The `count` lowest eigenpairs beside the rigid modes, and how many eigenvalues there are below a number above them.
    ///
    /// # Errors
    /// Its own.
    fn eigenpairs(
        &self,
        problem: &HeldProblem<'_>,
        count: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Eigenpairs, EngineError>;

    /// Displacements u of `K u = f` for forces f (a column each), which do no work on the rigid modes. What u has of these does
    /// not matter.
    ///
    /// # Errors
    /// Its own.
    fn static_answers(&self, problem: &HeldProblem<'_>, forces: MatRef<'_, f64>) -> Result<StaticAnswers, EngineError>;
}

/// Eigenpairs from an engine. They are checked, and made into modes as those found here are.
#[derive(Debug, Clone)]
pub struct Eigenpairs {
    /// λ in rising order: those that were asked for, and all others below `stats.below`.
    pub eigenvalues: Vec<f64>,
    /// Their vectors (unknowns × pairs).
    pub vectors: Mat<f64>,
    /// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ of each, with the engine's own factor.
    pub residuals: Vec<f64>,
    /// Its work.
    pub stats: EngineStats,
}

/// The work of an engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineStats {
    /// Where the eigenvalues were counted, (rad/time)².
    pub below: f64,
    /// How many are below, by the inertia of K − `below`·M, the rigid motions among them.
    pub counted: usize,
    /// Processes that worked together.
    pub ranks: usize,
    /// Version of PETSc.
    pub petsc: [u32; 3],
    /// Version of SLEPc.
    pub slepc: [u32; 3],
    /// Entries of the largest factor.
    pub factor_entries: usize,
    /// Megabytes that the largest factorisation took, of all processes together.
    pub megabytes: usize,
    /// Time of the factorisation of K + sM, with its ordering.
    pub factor_time: Duration,
    /// Time of the search.
    pub search_time: Duration,
    /// Time of the count, with its factorisation.
    pub count_time: Duration,
}

/// Static responses from an engine.
#[derive(Debug, Clone)]
pub struct StaticAnswers {
    /// Displacements (unknowns × forces).
    pub displacements: Mat<f64>,
    /// Iterations for each.
    pub iterations: Vec<usize>,
    /// Residual of each in the norm of (K + sM)⁻¹, relative to that of the force.
    pub residuals: Vec<f64>,
}
