//! `flexframe gradient`: rates of frequencies, effective masses and static answers with the numbers that a body is made with.

mod report;
mod table;

use std::path::{Path, PathBuf};

use model::{BuildError, BuildProgress, Builder, Parameter, RatesOf};
use scene::Scene;
use whole_file::write_whole;

pub use report::{GradientReport, ParameterReport, StaticReport};

use crate::commands::modes::unloaded_body;
use crate::files::write_error::WriteError;

const NAME: &str = "gradient.csv";

/// Rates that could not be found.
#[derive(Debug, thiserror::Error)]
pub enum GradientError {
    /// The scene has none.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The table cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// The files that [`gradient`] writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    vec![folder.join(NAME)]
}

/// Finds the rates of a scene with the parameters of some names, or with all keys of its materials and point masses, and writes
/// `gradient.csv` to a folder, where one is given.
///
/// # Errors
/// [`GradientError`].
pub fn gradient(
    scene: &Scene,
    builder: &Builder,
    names: &[String],
    folder: Option<&Path>,
    progress: impl FnMut(BuildProgress),
) -> Result<GradientReport, GradientError> {
    let scene = &unloaded_body(scene).map_err(BuildError::from)?;
    let parameters = Parameter::named(scene, names).map_err(BuildError::from)?;
    let body = builder.varied(scene, progress)?;
    let found = body.rates(body.body(), &parameters, RatesOf::All)?;
    let mut report = GradientReport::new(&body, &parameters, found);
    if let Some(folder) = folder {
        std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
        let path = folder.join(NAME);
        write_whole(&path, table::rows(&report)).map_err(WriteError::of(&path))?;
        report.files.push(path);
    }
    Ok(report)
}
