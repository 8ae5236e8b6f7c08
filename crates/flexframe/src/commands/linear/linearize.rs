//! `flexframe linearize`: the state space of small motions about rest or a steady spin, for control and for other programs.

mod at_once;
mod at_time;
mod channels;
mod files;
mod growth;
mod held;
mod of_system;
mod reduction;
mod report;
mod settings;
mod space;
mod state;
mod system_spin;
mod unseen;

use std::path::Path;

use ::report::Report;
use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Initial, MotionState};
use linear::{LinearError, SecondOrder};
use model::{BuildProgress, Builder, Model, Needs};
use nalgebra::Vector3;
use scene::Scene;

pub use at_once::AtOnce;
use at_time::{moving_modes, states_at};
pub(super) use channels::{BodyRows, acting_loads, input_channels};
use growth::growing;
pub use reduction::{Reduced, Reduction};
pub use settings::LinearSettings;
pub use space::LinearSpace;
pub use state::State;
use unseen::unseen;

/// The linearised equations of a scene.
#[derive(Debug, Clone)]
pub struct LinearModel {
    /// Equations of second order.
    pub equations: SecondOrder,
    /// The state that they are about.
    pub state: State,
}

/// Builds the bodies of a scene and linearises their equations of motion: exactly; the first order of loads by differences
/// that are exact for laws of fourth degree in the motion.
///
/// # Errors
/// [`Failure`].
pub fn linear_model(
    scene: &Scene,
    builder: &Builder,
    settings: &LinearSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<LinearModel, Failure> {
    // A motion that the body does not call for is one that an input may: of a free body any, of a held one a vibration.
    let builder = builder.needing(match &scene.bodies[..] {
        [body] if body.reduced_constraint().is_none() => Needs::external_inputs(),
        _ => Needs::vibrations(),
    });
    let models = builder.models(scene, progress)?;
    let refuse = |found: &str, help: &str| Kind::Refused.of(&scene.path).help(help).says(found);
    let is_free = |model: &Model| model.body.motion.is_free() && model.physics.drive.is_none();
    let states = settings.time.map(|time| states_at(scene, &models, time)).transpose()?;
    let is_alone = models.len() == 1 && !scene.has_connections();
    let (channels, mut state) = match (&scene.bodies[..], &models[..]) {
        ([body], [model]) if is_alone && !is_free(model) => {
            if settings.spin.is_some() {
                return Err(refuse("--spin of a body that is held", "give its hinge the speed, as `motion`"));
            }
            let initial = match states.as_deref() {
                Some([state, ..]) => Initial {
                    attitude: state.attitude,
                    origin: Some(state.origin_global),
                    ..Initial::at_rest(model.body.flexible())
                },
                _ => model.initial(body),
            };
            held::of_held(body, model, (&initial, settings.time.unwrap_or(0.0)), settings)?
        }
        (bodies, models) if models.iter().all(is_free) => {
            let of_state = |state: &MotionState| state.attitude.global_to_body().transpose() * state.omega_body;
            let own = || match (bodies, models, states.as_deref()) {
                (_, [_], Some([state, ..])) if is_alone => Some(of_state(state)),
                ([body], [model], None) if is_alone => {
                    let initial = model.initial(body);
                    Some(initial.attitude.global_to_body().transpose() * initial.omega)
                }
                _ => None,
            };
            let spin = settings.spin.map(Vector3::from).or_else(own);
            of_system::of_system(scene, models, spin, states.as_deref(), settings)?
        }
        _ => {
            return Err(refuse(
                "several bodies, one of them held",
                "hold it by a joint to the ground, or take it alone (--body)",
            ));
        }
    };
    if let Some(states) = &states {
        state.warnings.extend(moving_modes(&models, states));
    }
    let whole = channels.chosen(settings, scene)?;
    let without_rigid = settings.without_rigid.then(|| whole.without(&(0..state.rigid).collect::<Vec<_>>()));
    state.warnings.extend(unseen(&whole, without_rigid.as_ref().unwrap_or(&whole)));
    Ok(LinearModel { equations: without_rigid.unwrap_or(whole), state })
}

/// Linearises a scene, and lowers the order of its state space where that is asked for.
///
/// # Errors
/// [`Failure`].
pub fn linear_space(
    scene: &Scene,
    builder: &Builder,
    settings: &LinearSettings,
    reduction: Option<Reduction>,
    progress: impl FnMut(BuildProgress),
) -> Result<LinearSpace, Failure> {
    let LinearModel { equations, mut state } = linear_model(scene, builder, settings, progress)?;
    let failed = |source: LinearError| source.in_file(&scene.path);
    let whole = equations.state_space().map_err(failed)?;
    let rigid = if settings.without_rigid { 0 } else { state.rigid };
    state.warnings.extend(growing(&equations, rigid).map_err(failed)?);
    let reduced = reduction.map(|reduction| reduction.of(&whole)).transpose().map_err(failed)?;
    Ok(LinearSpace { whole, reduced, state })
}

/// Writes the state space of a scene to a file, .mat or .json, or that of a model of lower order.
///
/// # Errors
/// [`Failure`].
pub fn linearize(
    scene: &Scene,
    builder: &Builder,
    settings: &LinearSettings,
    reduction: Option<Reduction>,
    output: &Path,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    files::check_ending(output)?;
    let space = linear_space(scene, builder, settings, reduction, progress)?;
    let failed = |source: LinearError| source.in_file(&scene.path);
    let poles = space.model().poles().map_err(failed)?;
    files::write(space.model(), output)?;
    Ok(report::report(scene, &space, &poles, output))
}
