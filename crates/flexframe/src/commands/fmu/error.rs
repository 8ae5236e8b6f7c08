//! Errors of an FMU that cannot be packed or opened.

use std::io;
use std::path::PathBuf;

use model::{BuildError, StartError};
use scene::SceneError;
use sealed::SealedError;

use crate::files::write_error::WriteError;

/// The environment variable that names the library for FMUs.
pub(super) const LIBRARY_VARIABLE: &str = "FLEXFRAME_FMU_LIBRARY";

/// An FMU that cannot be packed or opened.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum FmuError {
    /// The scene is invalid.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The body cannot be made.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// No body.
    #[error("there is no body to pack; give one or more")]
    NoBody,
    /// The motion cannot start.
    #[error("{}", source.in_scene(scene))]
    Start { scene: PathBuf, source: Box<StartError> },
    /// The body file that was named cannot be read.
    #[error("{0}")]
    Body(#[from] SealedError),
    /// A body file that does not say which scene it was made of.
    #[error("{}: no scene is in this file; make it again: flexframe reduce SCENE -o FILE", path.display())]
    NoScene { path: PathBuf },
    /// There are no binaries of FMUs for this machine. `machine`: system and processor.
    #[error(
        "FMI 2.0 has no name for this machine ({machine}); pack it on 64-bit Linux, Windows or macOS, with a processor of the x86 family"
    )]
    Platform { machine: String },
    /// The library that goes into the FMU is not there, or is another one. `path`: where it was looked for.
    #[error(
        "{}: {found}; build it (./dev build, or cargo build --release -p fmi), and name it with --library or {variable} where \
         it is not beside the program", path.display(), variable = LIBRARY_VARIABLE
    )]
    Library { path: PathBuf, found: String },
    /// The text of the scene could not be changed to what the FMU holds.
    #[error(
        "the scene cannot be written for the FMU: {0}\n = run it by `flexframe run`, and correct what that says; if it runs, please report this"
    )]
    Text(String),
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}\n = check its name and its permissions", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// A resource is not where the FMU was unpacked to.
    #[error("{}: a resource of the FMU cannot be read: {source}; unpack the whole FMU again, or pack it again: flexframe fmu", path.display())]
    Missing { path: PathBuf, source: io::Error },
    /// A resource is not what was packed.
    #[error("{}: this resource of the FMU has been changed or damaged; unpack the FMU again, or pack it again: flexframe fmu", path.display())]
    Damaged { path: PathBuf },
    /// Packed by another version.
    #[error("the resources of this FMU are those of flexframe {found}, its library is of {}; pack it again: flexframe fmu", env!("CARGO_PKG_VERSION"))]
    Version { found: String },
    /// The FMU cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
