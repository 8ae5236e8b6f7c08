//! `flexframe modes` of bodies that joints tie together: the vibrations of the assembled system where it stands at the start.

mod advice;
mod assembled;
mod draw;
mod report;
mod rotors;
mod shape;
mod stiffening;

use ::report::Report;
use diagnostic::{Diagnostic, Failure};
use dynamics::{CommonSpin, SteadyError, SteadyState};
use model::{BuildProgress, Builder, Model};
use nalgebra::Vector3;
use scene::Scene;

use crate::commands::modes::Carried;
use assembled::tied_motions_at;
pub(crate) use assembled::{TiedMotion, placed_motions, tied_motions};
pub use draw::{draw, write_fields};
pub(crate) use report::body_names;
pub use report::{Share, SystemModeReport, SystemModes, SystemModesReport};
pub(crate) use rotors::Rotors;
pub use rotors::SpinningRotor;
pub(crate) use shape::SystemSurface;

/// Finds the vibrations of all bodies of a scene that joints, springs or bushings tie together, at rest where they stand at the
/// start, or where a run has them at a time; the bodies are deformed as their loads ask, and drives hold still, but rotors spin. Where forces do
/// not balance, the vibrations are about the motion that they accelerate. Rotations of the ground,
/// for effective moments of inertia, are `about` a global point, or about the first place that the ground holds.
///
/// # Errors
/// [`Failure`].
pub fn system_modes(
    scene: &Scene,
    models: &[Model],
    time: Option<f64>,
    about: Option<[f64; 3]>,
) -> Result<Vec<(SystemModes, Report)>, Failure> {
    let of_system = |motion: &TiedMotion| {
        let (modes, steady) = of_motion(scene, motion)?;
        let found = steady.participation(motion.run.motion(), about.map(Vector3::from));
        let found = found.map_err(|source| failed(scene, source))?;
        let unit = &modes.report.frequency_unit;
        let report = modes.report.report(found.map(|found| Carried::of_system(found, about.is_some(), unit)));
        Ok((modes, report))
    };
    motions_at(scene, models, time)?.iter().map(of_system).collect()
}

/// The vibrations of a scene as [`system_modes`] has them, without what they carry: for pictures.
///
/// # Errors
/// [`Failure`].
pub(crate) fn vibrations(scene: &Scene, models: &[Model]) -> Result<Vec<SystemModes>, Failure> {
    let of_system = |motion: &TiedMotion| of_motion(scene, motion).map(|(modes, _)| modes);
    motions_at(scene, models, None)?.iter().map(of_system).collect()
}

fn motions_at(scene: &Scene, models: &[Model], time: Option<f64>) -> Result<Vec<TiedMotion>, Failure> {
    match time {
        Some(time) if time > 0.0 => tied_motions_at(scene, models, time),
        _ => tied_motions(scene, models),
    }
}

/// Advice on the systems of a scene: by their vibrations at rest, and by what the forces of the start do to these.
///
/// # Errors
/// [`Failure`].
pub(crate) fn system_advice(
    scene: &Scene,
    builder: &Builder,
    progress: impl FnMut(BuildProgress),
) -> Result<Vec<Report>, Failure> {
    let models = builder.models(scene, progress)?;
    let of_system = |motion: &TiedMotion| {
        let (modes, _) = of_motion(scene, motion)?;
        let flexible = motion.bodies.iter().copied().filter(|body| models[*body].body.flexible() > 0);
        let flexible = body_names(scene, &flexible.collect::<Vec<_>>());
        let stiffening = stiffening::stiffened(scene, &models, motion);
        Ok(advice::advice(&modes.report, &flexible, stiffening, &scene.units))
    };
    tied_motions(scene, &models)?.iter().map(of_system).collect()
}

fn of_motion(scene: &Scene, motion: &TiedMotion) -> Result<(SystemModes, SteadyState), Failure> {
    let failed = |source| failed(scene, source);
    let of_motion = motion.run.motion();
    let rotors = Rotors::of(of_motion, |_| false);
    let steady = rotors.steady_state(of_motion, &CommonSpin::REST).map_err(failed)?;
    let vibrations = steady.linear.vibrations().map_err(failed)?;
    let report = SystemModesReport::new(scene, motion, &steady, &vibrations, rotors);
    Ok((SystemModes { bodies: motion.bodies.clone(), states: steady.states(), vibrations, report }, steady))
}

fn failed(scene: &Scene, source: SteadyError) -> Failure {
    source.in_file(&scene.path)
}
