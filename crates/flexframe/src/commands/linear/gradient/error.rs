//! Errors of rates.

use std::path::PathBuf;

use model::BuildError;

use crate::commands::system_modes::SystemModesError;
use crate::files::write_error::WriteError;

/// The most frequencies of responses.
pub(super) const MAX_FREQUENCIES: usize = 100_000;

/// Rates that could not be found.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum GradientError {
    /// The scene has none.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The system of its bodies cannot be put together.
    #[error("{0}")]
    System(#[from] SystemModesError),
    /// A name that is none of a number, or is named twice.
    #[error(
        "found {name}, expected {expected}\n = name each once; of bodies in joints, stiffnesses and the materials and point masses of bodies with a mesh are the parameters that frequencies have \
         rates with"
    )]
    Number { name: String, expected: String },
    /// A system whose place depends on its stiffnesses.
    #[error(
        "{}: found bodies that forces deform at the start, whose vibrations follow stiffnesses and materials in two ways\n = take the loads and \
         preloads out, and place the bodies so that springs have no force",
        scene.display()
    )]
    Loaded { scene: PathBuf },
    /// A number of a body that nothing ties to the others.
    #[error(
        "{}: found {parameter} of a body outside the system, expected one of a body that joints, springs or bushings tie to it\n = leave it out",
        scene.display()
    )]
    Outside { scene: PathBuf, parameter: String },
    /// Modes whose eigenvalue has no rate.
    #[error(
        "{}: found a vibration at {frequency} cycles per time that is damped critically (Yᵀ(2s + C)Y is singular), expected one with rates\n = \
         change the damping of joints, bushings or bodies a little",
        scene.display()
    )]
    Critical { scene: PathBuf, frequency: f64 },
    /// Rates that are no numbers.
    #[error(
        "{}: found rates of the vibration at {frequency} cycles per time with {parameter} that are not finite\n = look for values in the scene \
         that are many powers of ten apart",
        scene.display()
    )]
    NotFinite { scene: PathBuf, frequency: f64, parameter: String },
    /// Several systems.
    #[error("{}: found {count} systems that nothing ties together, expected one\n = make a scene of each", scene.display())]
    Systems { scene: PathBuf, count: usize },
    /// A response without an end.
    #[error(
        "{}: the response at {frequency} cycles per time has no end: an undamped vibration or a motion as a whole is there\n = take other \
         --frequencies, or give the bodies damping",
        scene.display()
    )]
    Resonance { scene: PathBuf, frequency: f64 },
    /// The frequencies are no range.
    #[error(
        "frequencies {start}:{end}:{count}: expected start:end:count, cycles per time, with 0 ≤ start < end and a count of 2 to \
         {MAX_FREQUENCIES}, e.g. 1:2000:200"
    )]
    Frequencies { start: f64, end: f64, count: usize },
    /// The table cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
