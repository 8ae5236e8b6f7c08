//! The motions of a scene as data, from which a page makes them again.

use live::{LiveMotion, LiveRun};
use model::{BuildError, Model};
use scene::Scene;

use super::beginning::{StartSettings, run_of_body, run_of_system, tied};

/// The motions of a scene, and what data do not hold of them.
pub(crate) struct Described {
    pub run: LiveRun,
    /// Names of the springs and bushings of each motion.
    pub elements: Vec<Vec<String>>,
}

/// All that the motions of [`begin`](super::begin) begin with: there is a model of each body.
pub(crate) fn describe(scene: &Scene, models: &[&Model], beginning: &StartSettings) -> Result<Described, BuildError> {
    let tied = tied(scene, models, beginning)?;
    let is_alone = |number: &usize| tied.iter().all(|tied| !tied.bodies.contains(number));
    let alone = (0..models.len()).filter(is_alone).map(|number| {
        let run = run_of_body(&scene.bodies[number], models[number], &beginning.bodies[number], beginning);
        LiveMotion { run, bodies: vec![number] }
    });
    let mut motions: Vec<LiveMotion> = alone.collect();
    let mut elements = vec![Vec::new(); motions.len()];
    for tied in tied {
        elements.push(tied.elements.clone());
        let bodies = tied.bodies.clone();
        let run = run_of_system(scene, models, tied, beginning);
        motions.push(LiveMotion { run, bodies });
    }
    Ok(Described { run: LiveRun { motions }, elements })
}
