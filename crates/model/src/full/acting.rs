//! Forces on the displaced nodes of a full body at a time.

use nalgebra::Vector3;
use nonlinear::{Acting, ExternalForces};
use rigid_kin::Attitude;

use crate::full::FullModel;
use crate::load::mesh_load::{Action, MeshLoad};
use crate::load::rotation::Rotation;
use crate::tie::place::Place;

/// A force and a moment at a marker, global components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TieForce {
    /// Its number among the markers of the body.
    pub marker: usize,
    /// One of its places, where it is several; `None` for their mean.
    pub part: Option<usize>,
    /// The force on the body.
    pub force_global: Vector3<f64>,
    /// The moment on the body about that place.
    pub moment_global: Vector3<f64>,
}

impl FullModel {
    /// The loads at a time in an attitude of the body, and the forces of joints.
    pub fn forces(&self, time: f64, attitude: &Attitude, joints: &[TieForce]) -> ExternalForces {
        let nodes = self.assembled.mesh.positions().len();
        let mut dead = vec![0.0; 3 * nodes];
        let mut others = Vec::new();
        for load in &self.loads {
            act(load, time, attitude, &mut dead, &mut others);
        }
        for TieForce { marker, part, force_global, moment_global } in joints {
            let Some(marker) = self.markers.get(*marker) else { continue };
            if let Some(place) = marker.place(*part) {
                let [force, moment] = [force_global, moment_global].map(|vector| attitude.to_body(vector));
                let arm = if part.is_none() { marker.arm() } else { Vector3::zeros() };
                act_at(place, &force, moment + arm.cross(&force), &mut dead, &mut others);
            }
        }
        others.push(Acting::Dead(dead));
        ExternalForces(others)
    }
}

fn act(load: &MeshLoad, time: f64, attitude: &Attitude, dead: &mut [f64], others: &mut Vec<Acting>) {
    let factor = load.size() * load.history.at(time, time);
    if factor == 0.0 {
        return;
    }
    let vector = load.vector_in(attitude) * factor;
    match (&load.action, &load.turning) {
        (Action::Force { nodes, weights, .. }, Some(Rotation::Mean(patch))) => others.push(Acting::Turning {
            nodes: nodes.clone(),
            weights: weights.clone(),
            patch: patch.clone(),
            force: vector,
        }),
        (Action::Moment { patch: Rotation::Mean(patch), .. }, _) => {
            others.push(Acting::Moment { patch: patch.clone(), moment: vector, turns: false });
        }
        (Action::Field { group, pressure, .. }, _) => {
            others.push(Acting::Pressure { group: group.clone(), pressure: pressure * factor });
        }
        _ => load.add_unit_nodal_forces(Some(vector), faer::ColMut::from_slice_mut(dead)),
    }
}

fn act_at(place: &Place, force: &Vector3<f64>, moment: Vector3<f64>, dead: &mut [f64], others: &mut Vec<Acting>) {
    for (node, weight) in place.nodes.iter().zip(&place.weights) {
        for axis in 0..3 {
            dead[3 * *node as usize + axis] += force[axis] * weight;
        }
    }
    if let Some(Rotation::Mean(patch)) = &place.rotation
        && moment != Vector3::zeros()
    {
        others.push(Acting::Moment { patch: patch.clone(), moment, turns: false });
    }
}
