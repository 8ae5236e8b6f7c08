//! Forces of joints, springs and bushings on a body in a state of its system, at its markers.

use dynamics::{Marker, MarkerWrench, MotionState, PointShapes, RotationShapes, SystemMotion};
use nalgebra::Matrix3;

use crate::full::FullError;
use crate::full::acting::TieForce;
use crate::model::Model;
use crate::tie::body_marker::carried;
use crate::tie::tied::Tied;

impl Tied {
    /// Forces that joints with their springs and motors, couplings, springs and bushings put on a body where the bodies have these states,
    /// by its number in [`Tied::bodies`]. `turns`: the turn of each joint, which full turns are counted by.
    ///
    /// # Errors
    /// [`FullError`] for states that do not fit, and where the inertia of a body is singular.
    pub fn forces_on(
        &self,
        body: usize,
        model: &Model,
        states: &[MotionState],
        turns: &[f64],
    ) -> Result<Vec<TieForce>, FullError> {
        let mut motion = SystemMotion::new(self.system.clone(), states)?.with_turns(turns);
        let time = motion.time();
        motion.find_reactions().map_err(|error| dynamics::LoadedError::from(error.in_step(time, 0.0)))?;
        let mut forces: Vec<TieForce> = Vec::new();
        motion.each_wrench(|marker, MarkerWrench { force_global, moment_global }| {
            if marker.body() != Some(body) {
                return;
            }
            if let Some((marker, part)) = numbers(model, body, marker) {
                forces.push(TieForce { marker, part, force_global, moment_global });
            }
        });
        Ok(forces)
    }
}

/// The number of a marker among the ones of its body, and that of the part that it is.
fn numbers(model: &Model, body: usize, marker: &Marker) -> Option<(usize, Option<usize>)> {
    let manifold = model.physics.large_deflection.as_ref();
    let is_at = |point: &PointShapes, turning: &RotationShapes| {
        marker.moves_as(&carried(body, manifold, (point, turning), Matrix3::identity()))
    };
    model.markers.iter().enumerate().find_map(|(number, of_body)| match is_at(&of_body.point, &of_body.turning) {
        true => Some((number, None)),
        false => {
            let part = of_body.parts.iter().position(|part| is_at(&part.point, &part.turning));
            part.map(|part| (number, Some(part)))
        }
    })
}
