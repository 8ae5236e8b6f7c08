//! Errors of fits.

use std::path::PathBuf;

use model::BuildError;
use scene::SceneError;

use super::least_squares::{Fault, Unseen};
use crate::commands::linear::gradient::GradientError;
use crate::files::write_error::WriteError;

/// Parameters that could not be fitted.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum FitError {
    /// The body.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The table.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The system, or its rates.
    #[error("{0}")]
    Gradient(#[from] GradientError),
    /// Shapes of a system.
    #[error(
        "{}: found shapes, expected frequencies alone: modes of bodies in joints are matched by their order\n = leave the shapes out, and put \
         the lines in order",
        file.display()
    )]
    Shapes { file: PathBuf },
    /// More measured modes than vibrations.
    #[error("{}: found {count} measured modes, expected at most {there}, the vibrations of the bodies\n = leave lines out, or keep more modes", file.display())]
    FewModes { file: PathBuf, count: usize, there: usize },
    /// Nothing is measured.
    #[error(
        "no measured frequencies: found neither --measured nor `measured` in [modes] of the scene\n = name a CSV file with a column `frequency`: --measured test.csv"
    )]
    NoTable,
    /// Nothing is to be found.
    #[error("no parameters to fit\n = name some of {}: --parameters NAME,…", names.join(", "))]
    NoParameters { names: Vec<String> },
    /// A number that does not stand in the scene.
    #[error(
        "{name} is no key of the scene, which cannot be written with it: found a factor on the shape of the mesh, expected numbers of materials and point masses\n = leave -o out, and mesh the body with the thickness that was found"
    )]
    NoKey { name: String },
    /// More parameters than frequencies.
    #[error("{}: found {count} measured frequencies for {unknowns} parameters ({}), expected at least as many as parameters, and more for intervals\n = measure more modes, or fit fewer parameters", file.display(), names.join(", "))]
    TooFew { file: PathBuf, count: usize, unknowns: usize, names: Vec<String> },
    /// Some frequencies have a stated deviation and others have none.
    #[error("{}:{line}: found no deviation, expected one, since other lines have theirs\n = add it, give --deviation for those that have none, or leave the column out", file.display())]
    SomeDeviations { file: PathBuf, line: usize },
    /// A parameter that changes none of the frequencies.
    #[error(
        "{name} changes none of the measured frequencies\n = leave it out, or measure modes that it changes: `flexframe gradient` shows them"
    )]
    NoInfluence { name: String },
    /// A parameter that has lost its influence on the way.
    #[error(
        "the search has taken {name} to where it changes none of the measured frequencies: no value of it gives them\n = see whether modes are mistaken for each other, or fit what is wrong in the model"
    )]
    Gone { name: String },
    /// Parameters that frequencies do not tell apart.
    #[error("the measured frequencies do not tell {} apart: none of them changes where {}, for any s\n = leave one of them out, or measure a mass or a static displacement", names.join(" and "), parts.join(", "))]
    Apart { names: Vec<String>, parts: Vec<String> },
    /// No end of the search.
    #[error(
        "no values were found in {steps} steps\n = begin with values nearer to the truth, or fit fewer parameters; `flexframe gradient` shows what each changes"
    )]
    NotFound { steps: usize },
    /// The scene cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

impl FitError {
    pub(super) fn of_fault(fault: Fault<Self>, names: &[String]) -> Self {
        let name = |j: usize| names[j].clone();
        match fault {
            Fault::Residuals(error) => error,
            Fault::Coordinates(Unseen::NoInfluence(j)) => Self::NoInfluence { name: name(j) },
            Fault::Coordinates(Unseen::Gone(j)) => Self::Gone { name: name(j) },
            Fault::Coordinates(Unseen::Apart(parts)) => Self::Apart {
                names: parts.iter().map(|(j, _)| name(*j)).collect(),
                parts: parts.iter().map(|(j, part)| format!("{} grows by s^{part:.2}", name(*j))).collect(),
            },
            Fault::Coordinates(Unseen::Steps(steps)) => Self::NotFound { steps },
        }
    }
}
