//! The model of an FMU: what the program packs and the library runs.

use std::path::Path;

use dynamics::RotationShapes;
use model::{BuildProgress, Builder, Model};
use results::{Metadata, histories};
use scene::Scene;

use super::error::FmuError;
use super::manifest::Manifest;
use super::si_unit::seconds;
use super::variables::{Variable, variables};
use crate::commands::run::{self, RunBody};
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;

/// The bodies of a scene, with the variables that another program sees.
#[derive(Debug)]
pub struct FmuModel {
    /// The bodies, at least one.
    pub bodies: Vec<FmuBody>,
    /// All variables; the number of one is its value reference.
    pub variables: Vec<Variable>,
    /// Seconds in the scene's unit of time: FMI counts time in seconds.
    pub seconds: f64,
    metadata: Metadata,
}

/// A body of an FMU.
#[derive(Debug)]
pub struct FmuBody {
    /// Its scene.
    pub scene: Scene,
    /// Its model.
    pub model: Model,
    /// How the points of the output are turned by the modes.
    pub rotations: Vec<RotationShapes>,
}

impl FmuModel {
    /// The model of the bodies of a scene, with the effects that forces from outside may call for.
    ///
    /// # Errors
    /// [`FmuError`].
    pub fn new(
        scenes: Vec<Scene>,
        builder: &Builder,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Self, FmuError> {
        let bodies = scenes.into_iter().map(|scene| FmuBody::new(scene, builder, &mut progress));
        let bodies = bodies.collect::<Result<Vec<_>, _>>()?;
        let of_run: Vec<_> = bodies.iter().map(|FmuBody { scene, model, .. }| RunBody { scene, model }).collect();
        let metadata = run::metadata(&of_run).ok_or(FmuError::NoBody)?;
        let variables = variables(&of_run, &metadata);
        let seconds = of_run.first().map_or(1.0, |body| seconds(&body.scene.units));
        Ok(Self { variables, seconds, metadata, bodies })
    }

    /// The model in the resources of an FMU, which have been [checked](Manifest::checked).
    ///
    /// # Errors
    /// [`FmuError`].
    pub fn open(resources: &Path, manifest: &Manifest) -> Result<Self, FmuError> {
        Self::new(manifest.scenes(resources)?, &Builder::default(), |_| ())
    }

    /// The scene of the first body: title, units, times and rows are those of all.
    pub fn scene(&self) -> &Scene {
        &self.bodies[0].scene
    }

    /// The numbers of a row, which [`Source::Row`](super::Source::Row) counts.
    pub fn numbers(&self, row: &Row, out: &mut Vec<f64>) {
        out.clear();
        histories(&COLUMNS, &self.metadata).for_each(|history| history.append(row, &self.metadata, out));
    }
}

impl FmuBody {
    fn new(scene: Scene, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, FmuError> {
        let scene = scene.for_unknown_forces();
        let model = builder.build(&scene, progress)?;
        model
            .start(&scene)
            .map_err(|source| FmuError::Start { scene: scene.path.clone(), source: Box::new(source) })?;
        let rotations = model.point_rotations(&scene)?;
        Ok(Self { scene, model, rotations })
    }
}
