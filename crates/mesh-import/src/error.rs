//! Errors of a mesh that cannot be imported.

use std::io;

use diagnostic::{Diagnosis, Diagnostic, Kind};
use fem_tet10::MeshError;
use foreign_program::ProgramError;

/// A mesh that could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ImportError {
    /// flexframe's own reader refuses it.
    #[error("{0}")]
    Mesh(#[from] MeshError),
    /// A program that reads this format is not there.
    #[error("{source_name}: it is read through {reader}, but `{program}` cannot be started: {cause}\n = {help}")]
    NoReader { source_name: String, reader: &'static str, program: String, cause: io::Error, help: &'static str },
    /// The mesh is not what it should be.
    #[error("{source_name}: {found}\n = {help}")]
    Refused { source_name: String, found: String, help: String },
    /// A program that reads this format has failed.
    #[error("{source_name}: `{program}` cannot read it ({status}): {said}\n = {help}")]
    Failed { source_name: String, program: String, status: String, said: String, help: &'static str },
    /// A program that reads this format took too much, and was ended.
    #[error("{source_name}: `{program}` cannot read it: {cause}\n = {help}")]
    TooMuch { source_name: String, program: String, cause: ProgramError, help: &'static str },
    /// A file could not be read, or a temporary one not be written.
    #[error(
        "{source_name}: the mesh cannot be read: {cause}\n = check its name and its permissions, and the room in the temporary folder"
    )]
    Io {
        source_name: String,
        #[source]
        cause: io::Error,
    },
}

impl ImportError {
    /// The file at fault.
    pub fn source_name(&self) -> &str {
        match self {
            Self::Mesh(error) => &error.mesh,
            Self::NoReader { source_name, .. }
            | Self::Refused { source_name, .. }
            | Self::Failed { source_name, .. }
            | Self::TooMuch { source_name, .. }
            | Self::Io { source_name, .. } => source_name,
        }
    }
}

impl Diagnostic for ImportError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Mesh(error) => error.diagnosis(),
            Self::NoReader { .. } | Self::Io { .. } => Kind::Io.of(self.source_name()),
            _ => Kind::Input.of(self.source_name()),
        }
    }
}
