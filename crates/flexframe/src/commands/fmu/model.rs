//! The model of an FMU: what the program packs and the library runs.

use std::path::Path;

use dynamics::RotationShapes;
use model::{BuildProgress, Builder, Model};
use results::Metadata;
use scene::Scene;

use super::error::FmuError;
use super::si_unit::seconds;
use super::variables::{Variable, variables};
use crate::commands::run;
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;

/// A scene and its body, with the variables that another program sees.
#[derive(Debug)]
pub struct FmuModel {
    /// The scene.
    pub scene: Scene,
    /// The body.
    pub model: Model,
    /// How the points of the output are turned by the modes.
    pub rotations: Vec<RotationShapes>,
    /// All variables; the number of one is its value reference.
    pub variables: Vec<Variable>,
    /// Seconds in the scene's unit of time: FMI counts time in seconds.
    pub seconds: f64,
    metadata: Metadata,
}

impl FmuModel {
    /// The model of a scene, with the effects that forces from outside may call for.
    ///
    /// # Errors
    /// [`FmuError`].
    pub fn new(scene: Scene, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, FmuError> {
        let scene = scene.for_unknown_forces();
        let model = builder.build(&scene, progress)?;
        model
            .start(&scene)
            .map_err(|source| FmuError::Start { scene: scene.path.clone(), source: Box::new(source) })?;
        let metadata = run::metadata(&scene, &model);
        let rotations = model.point_rotations(&scene)?;
        let variables = variables(&scene, &model, &metadata);
        Ok(Self { rotations, variables, seconds: seconds(&scene.units), metadata, scene, model })
    }

    /// The model in the resources of an FMU, which have been [checked](super::Manifest::checked).
    ///
    /// # Errors
    /// [`FmuError`].
    pub fn open(resources: &Path) -> Result<Self, FmuError> {
        Self::new(Scene::read(resources.join(super::packed_scene::SCENE))?, &Builder::default(), |_| ())
    }

    /// The numbers of a row, which [`Source::Row`](super::Source::Row) counts.
    pub fn numbers(&self, row: &Row, out: &mut Vec<f64>) {
        out.clear();
        COLUMNS.iter().filter(|column| column.is_in(&self.metadata)).for_each(|column| {
            column.append(row, &self.metadata, out);
        });
    }
}
