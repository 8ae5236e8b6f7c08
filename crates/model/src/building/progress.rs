//! How far the building of a model has come, and where the time went.

use std::time::{Duration, Instant};

use crate::mesh::doubt::Doubt;

/// How far the building of a model has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BuildProgress {
    /// The mesh is being read.
    Mesh,
    /// Something of the scene and its mesh is doubtful, and is told before the work.
    Doubt(Doubt),
    /// Mass and stiffness are being assembled.
    Assembly,
    /// The modes are being searched.
    Modes(modal::Progress),
    /// Static responses to loads and to the centrifugal field are being computed.
    Statics,
}

/// Where the time went. That of the modes is in [`modal::SolveStats`].
#[derive(Debug, Clone, Copy, Default)]
pub struct BuildTimes {
    /// Reading and checking the mesh.
    pub mesh: Duration,
    /// Assembling mass and stiffness.
    pub assembly: Duration,
    /// Finding the modes.
    pub modes: Duration,
    /// Static responses and the stress stiffness of the centrifugal field and of steady loads.
    pub statics: Duration,
    /// Making the reduced body and its points.
    pub reduction: Duration,
}

/// Work of the mesh's size.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BuildWork {
    /// Blocks of columns that the factor of K + sM was used for.
    pub blocks: usize,
    /// Columns of them all.
    pub columns: usize,
    /// Passes over the elements, beside that of the assembly.
    pub element_passes: usize,
}

pub(crate) fn timed<T>(time: &mut Duration, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    *time = started.elapsed();
    result
}
