//! Bodies of a scene that are tied together, put together at the start.

use dynamics::{Rows, StepControl, SystemSetup, SystemSimulation};
use model::{Model, StartError, Tied, tie};
use scene::System;

use super::error::SystemModesError;

/// Bodies that are tied together, at the start.
pub(crate) struct TiedMotion {
    /// Numbers of the bodies in the scene.
    pub bodies: Vec<usize>,
    /// Names of force elements.
    pub elements: Vec<String>,
    /// The bodies, put together.
    pub simulation: SystemSimulation,
}

/// All bodies of a scene that are tied together, by systems.
pub(crate) fn tied_motions(system: &System, models: &[Model]) -> Result<Vec<TiedMotion>, SystemModesError> {
    tie(system, models)?.into_iter().map(|tied| tied_motion(system, tied)).collect()
}

fn tied_motion(system: &System, tied: Tied) -> Result<TiedMotion, SystemModesError> {
    let Tied { bodies, elements, system: of_bodies, states, .. } = tied;
    let scene = &system.bodies[bodies[0]];
    let setup = SystemSetup {
        points: bodies.iter().map(|_| Vec::new()).collect(),
        system: of_bodies,
        states,
        relaxed: false,
        scheme: scene.time.system_scheme,
        // No step is taken.
        control: StepControl::Tolerance(1e-3),
        end: scene.time.end,
        rows: Rows::Interval(scene.time.end),
    };
    let refused =
        |source| SystemModesError::Setup { scene: scene.path.clone(), source: Box::new(StartError::from(source)) };
    let simulation = SystemSimulation::new(setup).map_err(refused)?;
    Ok(TiedMotion { bodies, elements, simulation })
}
