//! Bodies of a scene that are tied together, put together at the start, and where they are later.

use diagnostic::{Diagnostic, Failure};
use dynamics::{Island, Reached, Rows, Simulation, Start, StepControl, StepError, SystemRun};
use model::Model;
use scene::Scene;

use crate::motion::{StartSettings, begin_tied};

/// Bodies that are tied together, at one time.
pub(crate) struct TiedMotion {
    /// Numbers of the bodies in the scene.
    pub bodies: Vec<usize>,
    /// Numbers of their joints in the scene.
    pub joints: Vec<usize>,
    /// Names of force elements.
    pub elements: Vec<String>,
    /// The bodies, put together.
    pub run: SystemRun,
}

/// All bodies of a scene that are tied together, by systems, at the start.
pub(crate) fn tied_motions(scene: &Scene, models: &[Model]) -> Result<Vec<TiedMotion>, Failure> {
    // Deformed they are by who asks.
    let start = if scene.start == Start::Equilibrium { Start::Equilibrium } else { Start::AsPlaced };
    motions_from(scene, models, start)
}

/// The same where the scene places them.
pub(crate) fn placed_motions(scene: &Scene, models: &[Model]) -> Result<Vec<TiedMotion>, Failure> {
    motions_from(scene, models, Start::AsPlaced)
}

fn motions_from(scene: &Scene, models: &[Model], start: Start) -> Result<Vec<TiedMotion>, Failure> {
    // No step is taken.
    let at_start = |of| StartSettings { control: StepControl::Tolerance(1e-3), start, ..of };
    motions(scene, models, at_start, |_| Ok(()))
}

/// The same where a run of the scene has them at a time.
pub(crate) fn tied_motions_at(scene: &Scene, models: &[Model], time: f64) -> Result<Vec<TiedMotion>, Failure> {
    let lead = |simulation: &mut Simulation| {
        simulation.set_stop_time(Some(time));
        while !matches!(simulation.advance(u64::MAX)?, Reached::Stop | Reached::End) {}
        Ok(())
    };
    motions(scene, models, |of| of, lead)
}

fn motions(
    scene: &Scene,
    models: &[Model],
    begun: impl FnOnce(StartSettings) -> StartSettings,
    lead: impl Fn(&mut Simulation) -> Result<(), StepError>,
) -> Result<Vec<TiedMotion>, Failure> {
    let models: Vec<&Model> = models.iter().collect();
    let beginning = begun(StartSettings { rows: Rows::Interval(scene.time.end), ..StartSettings::of(scene, &models) });
    let springs = scene.springs.iter().map(|spring| &spring.name);
    let names: Vec<&String> = springs.chain(scene.bushings.iter().map(|bushing| &bushing.name)).collect();
    let mut motions = Vec::new();
    for Island { mut motion, bodies, joints, elements } in begin_tied(scene, &models, &beginning)? {
        lead(&mut motion).map_err(|source| source.in_file(&scene.path))?;
        let elements = elements.iter().map(|number| names[number - scene.joints.len()].clone()).collect();
        motions.extend(motion.system().map(|run| TiedMotion { bodies, joints, elements, run: run.clone() }));
    }
    Ok(motions)
}
