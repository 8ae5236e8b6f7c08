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
pub enum FmuError {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The body cannot be made.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// No body.
    #[error("there is no body to pack; give one or more")]
    NoBody,
    /// The motion cannot start.
    #[error("{}", source.in_scene(scene))]
    Start {
        /// The scene file.
        scene: PathBuf,
        /// The reason.
        source: Box<StartError>,
    },
    /// The body file that was named cannot be read.
    #[error(transparent)]
    Body(#[from] SealedError),
    /// A body file that does not say which scene it was made of.
    #[error("{}: no scene is in this file; make it again: flexframe reduce SCENE -o FILE", path.display())]
    NoScene {
        /// The file.
        path: PathBuf,
    },
    /// There are no binaries of FMUs for this machine.
    #[error(
        "FMI 2.0 has no name for this machine ({machine}); pack it on 64-bit Linux, Windows or macOS, with a processor of the x86 family"
    )]
    Platform {
        /// System and processor.
        machine: String,
    },
    /// The library that goes into the FMU is not there, or is another one.
    #[error(
        "{}: {found}; build it (./dev build, or cargo build --release -p fmi), and name it with --library or {variable} where \
         it is not beside the program", path.display(), variable = LIBRARY_VARIABLE
    )]
    Library {
        /// Where it was looked for.
        path: PathBuf,
        /// The content that is there.
        found: String,
    },
    /// The text of the scene could not be changed to what the FMU holds.
    #[error(
        "the scene cannot be written for the FMU: {0}\n = run it by `flexframe run`, and correct what that says; if it runs, please report this"
    )]
    Text(String),
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}\n = check its name and its permissions", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A resource is not where the FMU was unpacked to.
    #[error("{}: a resource of the FMU cannot be read: {source}; unpack the whole FMU again, or pack it again: flexframe fmu", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A resource is not what was packed.
    #[error("{}: this resource of the FMU has been changed or damaged; unpack the FMU again, or pack it again: flexframe fmu", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// Packed by another version.
    #[error("the resources of this FMU are those of flexframe {found}, its library is of {}; pack it again: flexframe fmu", env!("CARGO_PKG_VERSION"))]
    Version {
        /// The version of the resources.
        found: String,
    },
    /// The FMU cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
