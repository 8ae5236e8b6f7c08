//! The model of an FMU: what the program packs and the library runs.

use std::path::Path;

use frames_rk4::{Effect, RotationShapes};
use results::Metadata;
use scene::{Body, BuildProgress, Choice, Model, Scene};

use super::error::FmuError;
use super::si_unit::seconds;
use super::variables::{Variable, variables};
use crate::columns::COLUMNS;
use crate::row::Row;
use crate::run;

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
    pub fn new(scene: Scene, progress: impl FnMut(BuildProgress)) -> Result<Self, FmuError> {
        let scene = for_unknown_forces(scene);
        let model = Model::build(&scene, progress)?;
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
        Self::new(Scene::read(resources.join(super::packed_scene::SCENE))?, |_| ())
    }

    /// The numbers of a row, which [`Source::Row`](super::Source::Row) counts.
    pub fn numbers(&self, row: &Row, out: &mut Vec<f64>) {
        out.clear();
        COLUMNS.iter().filter(|column| column.is_in(&self.metadata)).for_each(|column| {
            column.append(row, &self.metadata, out);
        });
    }
}

/// The scene as its FMU has it. What would be left out since the scene calls for none of it is on, as long as the scene does not
/// say otherwise: nobody knows the forces from outside. What each of several supports does is left out: it would have to know
/// these forces.
pub(super) fn for_unknown_forces(mut scene: Scene) -> Scene {
    (scene.output.support_reactions, scene.output.peak_stress) = (false, false);
    let flexible = scene.modes.flexible.most() > 0 && scene.effects.choices[Effect::Flexibility] != Choice::Off;
    let of_modes = if matches!(scene.body, Body::Meshed(_)) && flexible { &OF_MODES[..] } else { &[] };
    for effect in [Effect::Translation, Effect::Rotation, Effect::Gravity].iter().chain(of_modes) {
        let choice = &mut scene.effects.choices[*effect];
        if *choice == Choice::Auto {
            *choice = Choice::On;
        }
    }
    scene
}

const OF_MODES: [Effect; 3] = [Effect::Damping, Effect::DeformedInertia, Effect::Coriolis];
