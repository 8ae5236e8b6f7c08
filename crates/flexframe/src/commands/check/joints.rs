//! Forces of joints, springs and bushings on a body in a row of a results file: those of its system in the states of the row.

use std::path::Path;

use diagnostic::{Diagnostic, Failure};
use model::{BuildError, Model, TieForce, Tied, tie};
use results::Results;
use scene::Scene;

use super::rows;

/// The bodies of a run that are tied.
pub(super) struct Ties(Vec<Tied>);

impl Ties {
    /// The systems of a scene.
    pub fn new(scene: &Scene, models: &[Model]) -> Result<Self, BuildError> {
        Ok(Self(if scene.has_ties() { tie(scene, models)? } else { Vec::new() }))
    }

    /// The forces on a body in a row, at its markers.
    pub fn forces(
        &self,
        file: &Path,
        (results, system, models): (&Results, &Scene, &[Model]),
        body: usize,
        row: usize,
    ) -> Result<Vec<TieForce>, Failure> {
        let Some(tied) = self.0.iter().find(|tied| tied.bodies.contains(&body)) else { return Ok(Vec::new()) };
        let states: Option<Vec<_>> = tied.bodies.iter().map(|body| rows::motion(results, *body, row)).collect();
        let states = states.ok_or_else(|| rows::no_rows(file))?;
        let turn = |joint: &usize| {
            let angles = results.numbers(&format!("joints/{}/angle", system.joints[*joint].name));
            angles.and_then(|angles| angles.get(row)).copied().unwrap_or_default()
        };
        let turns: Vec<f64> = tied.joints.iter().map(turn).collect();
        let number = tied.bodies.iter().position(|other| *other == body).unwrap_or_default();
        let forces = tied.forces_on(number, &models[body], &states, &turns);
        forces.map_err(|source| source.in_file(&system.bodies[body].path))
    }
}
