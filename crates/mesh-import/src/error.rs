//! Errors of a mesh that cannot be imported.

use std::io;

use fem_tet10::MeshError;
use foreign_program::ProgramError;

/// A mesh that could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// flexframe's own reader refuses it.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A program that reads this format is not there.
    #[error("{source_name}: it is read through {reader}, but `{program}` cannot be started: {cause}\n = {help}")]
    NoReader {
        /// The mesh file.
        source_name: String,
        /// The reader, in words.
        reader: &'static str,
        /// The program.
        program: String,
        /// Reason of the failed start.
        cause: io::Error,
        /// Help for the user.
        help: &'static str,
    },
    /// The mesh is not what it should be.
    #[error("{source_name}: {found}\n = {help}")]
    Refused {
        /// The mesh file.
        source_name: String,
        /// The fault.
        found: String,
        /// Help for the user.
        help: String,
    },
    /// A program that reads this format has failed.
    #[error("{source_name}: `{program}` cannot read it ({status}): {said}\n = {help}")]
    Failed {
        /// The mesh file.
        source_name: String,
        /// The program.
        program: String,
        /// How it ended.
        status: String,
        /// The last that it said.
        said: String,
        /// Help for the user.
        help: &'static str,
    },
    /// A program that reads this format took too much, and was ended.
    #[error("{source_name}: `{program}` cannot read it: {cause}\n = {help}")]
    TooMuch {
        /// The mesh file.
        source_name: String,
        /// The program.
        program: String,
        /// The limit.
        cause: ProgramError,
        /// Help for the user.
        help: &'static str,
    },
    /// A file could not be read, or a temporary one not be written.
    #[error(
        "{source_name}: the mesh cannot be read: {cause}\n = check its name and its permissions, and the room in the temporary folder"
    )]
    Io {
        /// The file.
        source_name: String,
        /// The reason.
        cause: io::Error,
    },
}

impl ImportError {
    /// The file at fault.
    pub fn source_name(&self) -> &str {
        match self {
            Self::Mesh(error) => error.source_name(),
            Self::NoReader { source_name, .. }
            | Self::Refused { source_name, .. }
            | Self::Failed { source_name, .. }
            | Self::TooMuch { source_name, .. }
            | Self::Io { source_name, .. } => source_name,
        }
    }
}
