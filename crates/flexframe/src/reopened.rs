//! The body and the rows of a results file.

use std::path::Path;

use results::{FileError, Metadata, Results};
use scene::{BuildError, BuildProgress, Cache, Model, Scene, SceneError};

use crate::columns::COLUMNS;
use crate::scene_file;

/// A results file, and the body of the scene in it, made anew: the file has no shapes.
#[derive(Debug)]
pub(crate) struct Reopened {
    pub results: Results,
    pub scene: Scene,
    pub model: Model,
}

/// Why there is none.
#[derive(Debug, thiserror::Error)]
pub enum ReopenError {
    /// The results file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The scene in the results file is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The body cannot be made again.
    #[error(transparent)]
    Build(#[from] BuildError),
}

impl Reopened {
    /// Reads a results file, finished or not, and makes its body with the stress of all nodes. The mesh is looked for where it
    /// was.
    pub fn open(file: &Path, cache: &Cache, progress: impl FnMut(BuildProgress)) -> Result<Self, ReopenError> {
        let results = Results::open(file, &COLUMNS)?;
        let scene = scene_of(&results, cache)?;
        let model = Model::build(&scene.clone().without_rows().with_stress_field(), progress)?;
        Ok(Self { results, scene, model })
    }
}

/// The scene in a results file.
pub(crate) fn scene_of(results: &Results, cache: &Cache) -> Result<Scene, SceneError> {
    Ok(Scene { cache: cache.clone(), ..scene_in(&results.metadata)? })
}

/// The same, without a cache.
pub(crate) fn scene_in(metadata: &Metadata) -> Result<Scene, SceneError> {
    Scene::parse(&metadata.scene_text, scene_file::to_path(&metadata.scene_file))
}
