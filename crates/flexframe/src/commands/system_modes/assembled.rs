//! Bodies of a scene that are tied together, put together at the start, and where they are later.

use dynamics::{Reached, Rows, StepControl, SystemSetup, SystemSimulation};
use model::{Model, StartError, Tied, tie};
use scene::System;

use super::error::SystemModesError;

/// Bodies that are tied together, at one time.
pub(crate) struct TiedMotion {
    /// Numbers of the bodies in the scene.
    pub bodies: Vec<usize>,
    /// Numbers of their joints in the scene.
    pub joints: Vec<usize>,
    /// Names of force elements.
    pub elements: Vec<String>,
    /// The bodies, put together.
    pub simulation: SystemSimulation,
}

/// All bodies of a scene that are tied together, by systems, at the start.
pub(crate) fn tied_motions(system: &System, models: &[Model]) -> Result<Vec<TiedMotion>, SystemModesError> {
    // No step is taken.
    let tied_motion = |tied: Tied| TiedMotion::new(system, tied, StepControl::Tolerance(1e-3), false);
    tie(system, models)?.into_iter().map(tied_motion).collect()
}

/// The same where a run of the scene has them at a time.
pub(crate) fn tied_motions_at(
    system: &System,
    models: &[Model],
    time: f64,
) -> Result<Vec<TiedMotion>, SystemModesError> {
    let tied_motion = |tied: Tied| {
        let scene = &system.bodies[tied.bodies[0]];
        let mut motion = TiedMotion::new(system, tied, scene.time.control, system.relaxed)?;
        motion.simulation.set_stop_time(Some(time));
        let failed = |source| SystemModesError::Run { scene: scene.path.clone(), source: Box::new(source) };
        while !matches!(motion.simulation.advance(u64::MAX).map_err(failed)?, Reached::Stop | Reached::End) {}
        Ok(motion)
    };
    tie(system, models)?.into_iter().map(tied_motion).collect()
}

impl TiedMotion {
    fn new(system: &System, tied: Tied, control: StepControl, relaxed: bool) -> Result<Self, SystemModesError> {
        let Tied { bodies, joints, elements, system: of_bodies, states, .. } = tied;
        let scene = &system.bodies[bodies[0]];
        let setup = SystemSetup {
            points: bodies.iter().map(|_| Vec::new()).collect(),
            system: of_bodies,
            states,
            relaxed,
            scheme: scene.time.method.joints.unwrap_or_default(),
            control,
            end: scene.time.end,
            rows: Rows::Interval(scene.time.end),
        };
        let refused =
            |source| SystemModesError::Setup { scene: scene.path.clone(), source: Box::new(StartError::from(source)) };
        let simulation = SystemSimulation::new(setup).map_err(refused)?;
        Ok(Self { bodies, joints, elements, simulation })
    }
}
