//! `flexframe modes` of bodies that joints tie together: the vibrations of the assembled system where it stands at the start.

mod advice;
mod assembled;
mod draw;
mod error;
mod report;
mod shape;

use dynamics::CommonSpin;
use model::{BuildError, BuildProgress, Builder, Model};
use scene::System;

pub use advice::{AdviceOnSystems, SystemAdvice};
pub(crate) use assembled::{TiedMotion, tied_motions};
pub use draw::draw;
pub use error::SystemModesError;
pub(crate) use report::body_names;
pub use report::{ModesOfSystems, Share, SystemModeReport, SystemModes, SystemModesReport};
pub(crate) use shape::SystemSurface;

/// Builds the bodies of a scene.
///
/// # Errors
/// [`BuildError`].
pub fn build(
    system: &System,
    builder: &Builder,
    mut progress: impl FnMut(BuildProgress),
) -> Result<Vec<Model>, BuildError> {
    system.bodies.iter().map(|scene| builder.build(scene, &mut progress)).collect()
}

/// Finds the vibrations of all bodies of a scene that joints, springs or bushings tie together, at rest where they stand at the
/// start; the bodies are deformed as their loads ask, and drives hold still.
///
/// # Errors
/// [`SystemModesError`].
pub fn system_modes(system: &System, models: &[Model]) -> Result<Vec<SystemModes>, SystemModesError> {
    tied_motions(system, models)?.iter().map(|motion| of_motion(system, motion)).collect()
}

/// Advice on the systems of a scene, by their vibrations at rest.
///
/// # Errors
/// [`SystemModesError`].
pub fn system_advice(
    system: &System,
    builder: &Builder,
    progress: impl FnMut(BuildProgress),
) -> Result<Vec<SystemAdvice>, SystemModesError> {
    let models = build(system, builder, progress)?;
    let of_system = |modes: &SystemModes| {
        let flexible = modes.bodies.iter().copied().filter(|body| models[*body].body.flexible() > 0);
        SystemAdvice::new(&modes.report, &body_names(system, &flexible.collect::<Vec<_>>()))
    };
    Ok(system_modes(system, &models)?.iter().map(of_system).collect())
}

fn of_motion(system: &System, motion: &TiedMotion) -> Result<SystemModes, SystemModesError> {
    let scene = &system.bodies[motion.bodies[0]];
    let failed = |source| SystemModesError::Steady { scene: scene.path.clone(), source };
    let steady = motion.simulation.motion().steady_state(&CommonSpin::REST).map_err(failed)?;
    let vibrations = steady.linear.vibrations().map_err(failed)?;
    let report = SystemModesReport::new(system, motion, &steady, &vibrations);
    Ok(SystemModes { bodies: motion.bodies.clone(), states: steady.states(), vibrations, report })
}
