//! `flexframe linearize`: the state space of small motions about rest or a steady spin, for control and for other programs.

mod channels;
mod error;
mod files;
mod held;
mod of_system;
mod report;
mod state;

use std::path::Path;

use linear::{SecondOrder, StateSpace};
use model::{BuildProgress, Builder, Model};
use nalgebra::Vector3;
use scene::System;

pub use error::LinearizeError;
pub use report::LinearReport;
pub use state::State;

/// Settings of a linear model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinearSettings {
    /// Angular velocity of the steady spin, global, radians per time, about the center of mass; `None` is that which a free body of the
    /// scene begins with, or of its drive, and rest of bodies in joints.
    pub spin: Option<[f64; 3]>,
    /// True where coordinates that deform nothing are taken out.
    pub without_rigid: bool,
}

/// The linearised equations of a scene.
#[derive(Debug, Clone)]
pub struct LinearModel {
    /// Equations of second order.
    pub equations: SecondOrder,
    /// The state that they are about.
    pub state: State,
}

/// Builds the bodies of a scene and linearises their equations of motion: exactly, but for the first order of loads, which is exact for
/// those that are of second degree in the motion.
///
/// # Errors
/// [`LinearizeError`].
pub fn linear_model(
    system: &System,
    builder: &Builder,
    settings: &LinearSettings,
    mut progress: impl FnMut(BuildProgress),
) -> Result<LinearModel, LinearizeError> {
    let models: Vec<Model> =
        system.bodies.iter().map(|scene| builder.build(scene, &mut progress)).collect::<Result<_, _>>()?;
    let refuse = |found: &str, help| LinearizeError::Refused {
        scene: system.bodies[0].path.clone(),
        found: found.to_owned(),
        help,
    };
    let is_free = |model: &Model| model.body.motion.is_free() && model.physics.drive.is_none();
    let (equations, state) = match &models[..] {
        [model] if !is_free(model) && !system.has_connections() => {
            if settings.spin.is_some() {
                return Err(refuse("--spin of a body that is held", "give its hinge the speed, as `motion`"));
            }
            held::of_held(&system.bodies[0], model)?
        }
        models if models.iter().all(is_free) => {
            let initial = || match models {
                [model] if !system.has_connections() => {
                    let initial = model.initial(&system.bodies[0]);
                    Some(initial.attitude.global_to_body().transpose() * initial.omega)
                }
                _ => None,
            };
            let spin = settings.spin.map(Vector3::from).or_else(initial);
            of_system::of_system(system, models, spin)?
        }
        _ => {
            return Err(refuse(
                "several bodies, one of them held",
                "hold it by a joint to the ground, or take it alone (--body)",
            ));
        }
    };
    let equations = match settings.without_rigid {
        true => equations.without(&(0..state.rigid).collect::<Vec<_>>()),
        false => equations,
    };
    let nothing = |what, help| Err(LinearizeError::Nothing { scene: system.bodies[0].path.clone(), what, help });
    if equations.inputs.is_empty() {
        return nothing("inputs", "give the scene loads (their history does not matter), or joints that turn or slide");
    }
    if equations.outputs.is_empty() {
        return nothing("outputs", "name points in [output], or give the scene joints that turn or slide");
    }
    Ok(LinearModel { equations, state })
}

/// Writes the state space of a scene to a file, .mat or .json; with an order, that of the balanced truncation.
///
/// # Errors
/// [`LinearizeError`].
pub fn linearize(
    system: &System,
    builder: &Builder,
    settings: &LinearSettings,
    order: Option<usize>,
    output: &Path,
    progress: impl FnMut(BuildProgress),
) -> Result<LinearReport, LinearizeError> {
    files::check_ending(output)?;
    let model = linear_model(system, builder, settings, progress)?;
    let scene = &system.bodies[0];
    let failed = |source| LinearizeError::Linear { scene: scene.path.clone(), source: Box::new(source) };
    let space = model.equations.state_space().map_err(failed)?;
    let reduced = order.map(|order| space.balanced(order)).transpose().map_err(failed)?;
    let written: &StateSpace = reduced.as_ref().map_or(&space, |reduced| &reduced.model);
    let poles = written.poles().map_err(failed)?;
    files::write(written, output)?;
    Ok(LinearReport::new(scene, &model.state, &space, reduced.as_ref(), written, &poles, output))
}
