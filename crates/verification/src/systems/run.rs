//! Systems of scenes, run.

use std::path::Path;

use dynamics::{Observation, Reached, Rows, Simulation, Start, StepControl, SystemScheme, SystemSetup};
use model::{Builder, Model, Tied, tie};
use scene::Scene;

use crate::nonlinear::SolidError;

/// The bodies of a scene, reduced, and the system that they are.
pub struct Built {
    /// The models of the bodies.
    pub models: Vec<Model>,
    /// Bodies that are connected.
    pub tied: Tied,
}

/// A scene all of whose bodies are connected; paths in it begin at a directory.
///
/// # Errors
/// Errors of the scene.
pub fn built(directory: &Path, text: &str) -> Result<Built, SolidError> {
    let failed = |error: &dyn std::error::Error| SolidError::Scene(error.to_string());
    let scene = Scene::parse(text, directory.join("scene.toml")).map_err(|error| failed(&error))?;
    let models = Builder::default().models(&scene, |_| ()).map_err(|error| failed(&error))?;
    let tied = tie(&scene, &models).map_err(|error| failed(&error))?;
    match <[Tied; 1]>::try_from(tied) {
        Ok([tied]) => Ok(Built { models, tied }),
        Err(all) => Err(SolidError::Scene(format!("{} systems in the place of one", all.len()))),
    }
}

impl Built {
    /// Begins its motion.
    ///
    /// # Errors
    /// Errors of the start.
    pub fn start(
        &self,
        control: StepControl,
        end: f64,
        interval: f64,
        relaxed: bool,
    ) -> Result<Simulation, SolidError> {
        self.start_by(SystemScheme::Radau, control, end, interval, relaxed)
    }

    /// The same by another scheme.
    ///
    /// # Errors
    /// Errors of the start.
    pub fn start_by(
        &self,
        scheme: SystemScheme,
        control: StepControl,
        end: f64,
        interval: f64,
        relaxed: bool,
    ) -> Result<Simulation, SolidError> {
        let points = |body: &usize| self.models[*body].points.iter().map(|(_, point)| point.clone()).collect();
        Simulation::of_system(SystemSetup {
            system: self.tied.system.clone(),
            states: self.tied.states.clone(),
            start: if relaxed { Start::Relaxed } else { Start::AsPlaced },
            scheme,
            control,
            end,
            rows: Rows::Interval(interval),
            points: self.tied.bodies.iter().map(points).collect(),
        })
        .map_err(|error| SolidError::Scene(error.to_string()))
    }
}

/// Each body at each row of a run, that at its start first.
///
/// # Errors
/// Errors that stop it.
pub fn rows(simulation: &mut Simulation, bodies: usize) -> Result<Vec<Vec<Observation>>, SolidError> {
    let failed = |error: &dyn std::error::Error| SolidError::Scene(error.to_string());
    let mut rows = Vec::new();
    loop {
        let mut row: Vec<Observation> = (0..bodies).map(|body| simulation.room(body)).collect();
        simulation.observe(&mut row).map_err(|error| failed(&error))?;
        rows.push(row);
        loop {
            match simulation.advance_watched(1000, |_, _| ()).map_err(|error| failed(&error))? {
                Reached::Row => break,
                Reached::End => return Ok(rows),
                _ => {}
            }
        }
    }
}
