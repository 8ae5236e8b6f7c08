//! Errors of matrices that cannot be read.

use std::path::{Path, PathBuf};

use memory::OutOfMemory;

/// One of the files of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// M.
    Mass,
    /// K.
    Stiffness,
    /// The positions of the nodes.
    Nodes,
    /// Node and degree of freedom of each row.
    Dofs,
}

impl Which {
    /// "mass", "stiffness", "nodes" or "dofs".
    pub fn name(self) -> &'static str {
        match self {
            Self::Mass => "mass",
            Self::Stiffness => "stiffness",
            Self::Nodes => "nodes",
            Self::Dofs => "dofs",
        }
    }
}

/// Matrices that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum MatrixError {
    /// A file is not what it should be. `line`: from 1, where one line is at fault.
    #[error("{}: found {found}, expected {expected}\n = {help}", place(path, *line))]
    Refused { which: Which, path: PathBuf, line: Option<usize>, found: String, expected: String, help: String },
    /// There is not enough memory.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
}

/// "K.mtx:12", or the file alone.
pub(crate) fn place(path: &Path, line: Option<usize>) -> String {
    let name = path.display();
    line.map_or_else(|| name.to_string(), |line| format!("{name}:{line}"))
}
