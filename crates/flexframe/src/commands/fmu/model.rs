//! The model of an FMU: what the program packs and the library runs.

use std::path::Path;

use diagnostic::Failure;
use dynamics::{Coordinate, RotationShapes};
use model::{BuildProgress, Builder, Model, Needs};
use results::{Metadata, histories};
use scene::{Body, Scene};

use super::manifest::Manifest;
use super::si_unit::seconds;
use super::variables::{Variable, variables};
use crate::commands::run::{self, RunBody};
use crate::motion::{StartSettings, begin};
use crate::rows::columns::{COLUMNS, part};
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
    /// Its bodies and what ties them together, in the words of the scene.
    pub scene: Scene,
    metadata: Metadata,
}

/// A body of an FMU.
#[derive(Debug)]
pub struct FmuBody {
    /// The body of the scene.
    pub body: Body,
    /// Its model.
    pub model: Model,
    /// How the points of the output are turned by the modes.
    pub rotations: Vec<RotationShapes>,
}

impl FmuModel {
    /// The model of the bodies of a scene, with the effects that forces from outside may call for.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn new(scene: Scene, builder: &Builder, mut progress: impl FnMut(BuildProgress)) -> Result<Self, Failure> {
        let builder = builder.needing(Needs::external_inputs());
        let bodies = scene.bodies.iter().map(|body| FmuBody::new(body, &builder, &mut progress));
        let bodies = bodies.collect::<Result<Vec<_>, _>>()?;
        let models: Vec<&Model> = bodies.iter().map(|body| &body.model).collect();
        let beginning = StartSettings::of(&scene, &models);
        begin(&scene, &models, &beginning).map_err(|error| error.at_key(&scene))?;
        let of_run: Vec<_> = bodies.iter().map(|FmuBody { body, model, .. }| RunBody { body, model }).collect();
        let mut metadata = run::metadata_of_scene(&scene, &of_run);
        add_motors(&scene, &mut metadata);
        let variables = variables(&scene, &of_run, &metadata);
        Ok(Self { variables, seconds: seconds(&scene.units), metadata, bodies, scene })
    }

    /// The model in the resources of an FMU, which have been [checked](Manifest::checked).
    ///
    /// # Errors
    /// [`Failure`].
    pub fn open(resources: &Path, manifest: &Manifest) -> Result<Self, Failure> {
        Self::new(manifest.system(resources)?, &Builder::default(), |_| ())
    }

    /// The numbers of a row, which [`Source::Row`](super::Source::Row) counts.
    pub fn numbers(&self, row: &Row, out: &mut Vec<f64>) {
        out.clear();
        histories(&COLUMNS, &self.metadata).for_each(|history| history.append(row, &self.metadata, out));
    }
}

impl FmuBody {
    fn new(body: &Body, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, Failure> {
        let model = builder.build(body, progress)?;
        let rotations = model.point_rotations(body)?;
        Ok(Self { body: body.clone(), model, rotations })
    }
}

/// Gives each joint the columns of a motor along its coordinates, since that is an input.
fn add_motors(scene: &Scene, metadata: &mut Metadata) {
    for (joint, of) in scene.joints.iter().zip(&mut metadata.joints) {
        for along in joint.kind.coordinates() {
            let acts = match along {
                Coordinate::Turn => part::TURN_FORCE,
                Coordinate::Slide => part::SLIDE_FORCE,
            };
            for part in [part::DRIVE, acts] {
                if !of.parts.iter().any(|has| has == part) {
                    of.parts.push(part.to_owned());
                }
            }
        }
    }
}
