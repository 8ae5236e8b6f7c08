//! The loads of a body in steady motion, with their first order.
//!
//! A load is a law of the motion, which may come from outside, so its first order is found by central differences at two steps. Of a law of
//! fourth degree they are exact but for rounding: so are all of this crate in the attitude, and in the modes but for forces that turn
//! with the material, for which the error is the fourth power of the step, 1e-12. The attitude is not turned but changed along its tangent.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rigid_kin::cross_matrix;

use crate::body::motion_state::MotionState;
use crate::conservative::ConservativeBody;
use crate::conservative::manifold::BentShape;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};
use crate::vibration::system::configuration::BodyConfiguration;

/// Step of the differences: of turns in rad, and of displacements and velocities relative to their scales.
const STEP: f64 = 1e-3;

/// Generalised forces of loads, and their first order.
pub(crate) struct LoadForces {
    pub forces: Vec<f64>,
    /// By ρ, φ and δq (n×n).
    pub by_place: Mat<f64>,
    /// By V, ω and q̇ (n×n).
    pub by_velocity: Mat<f64>,
}

/// A place and a motion that loads see, the attitude as a matrix that need not be a rotation.
#[derive(Clone)]
struct Seen {
    body_from_global: Matrix3<f64>,
    origin: Vector3<f64>,
    velocity_global: Vector3<f64>,
    omega_body: Vector3<f64>,
    q: Vec<f64>,
    rate: Vec<f64>,
}

/// The loads at a time.
pub(crate) fn load_forces(body: &ConservativeBody, at: &BodyConfiguration, time: f64) -> LoadForces {
    let origin = body.frame.global_place(&at.origin, time);
    let nf = at.q.len();
    let n = 6 + nf;
    let here = Seen {
        body_from_global: at.body_from_global,
        origin,
        velocity_global: at.body_from_global.tr_mul(&at.velocity) + at.carried,
        omega_body: at.omega,
        q: at.q.clone(),
        rate: vec![0.0; nf],
    };
    let lengths = [body.radius_of_gyration(), at.origin.norm(), 1.0];
    // Of a point mass the distance from the origin.
    let length = lengths.into_iter().find(|length| *length > 0.0).unwrap_or(1.0);
    let amplitude = body.mass().sqrt() * length;
    let axes: [Vector3<f64>; 3] = std::array::from_fn(|k| here.body_from_global.row(k).transpose());
    let difference = |scale: f64, change: &dyn Fn(&mut Seen, f64)| {
        let step = STEP * scale;
        let at = |by: f64| {
            let mut seen = here.clone();
            change(&mut seen, by * step);
            forces(body, &seen, time, body.loads(), false)
        };
        let ([far_back, back], [ahead, far_ahead]) = ([-2.0, -1.0].map(at), [1.0, 2.0].map(at));
        // (8 (f₁ − f₋₁) − (f₂ − f₋₂)) / 12 h
        (0..n)
            .map(|i| (8.0 * (ahead[i] - back[i]) - (far_ahead[i] - far_back[i])) / (12.0 * step))
            .collect::<Vec<f64>>()
    };
    let column = |k: usize, of_velocity: bool| match (k, of_velocity) {
        (0..3, false) => difference(length, &|seen, step| seen.origin += axes[k] * step),
        (3..6, false) => difference(1.0, &|seen, step| {
            let turn = cross_matrix(&(Vector3::ith(k - 3, 1.0) * step));
            seen.body_from_global -= turn * at.body_from_global;
            seen.velocity_global = seen.body_from_global.tr_mul(&at.velocity) + at.carried;
        }),
        (_, false) => difference(amplitude, &|seen, step| seen.q[k - 6] += step),
        (0..3, true) => difference(length, &|seen, step| seen.velocity_global += axes[k] * step),
        (3..6, true) => difference(1.0, &|seen, step| seen.omega_body[k - 3] += step),
        (_, true) => difference(amplitude, &|seen, step| seen.rate[k - 6] += step),
    };
    let [by_place, by_velocity] = [false, true].map(|of_velocity| {
        let columns: Vec<Vec<f64>> = (0..n).map(|k| column(k, of_velocity)).collect();
        Mat::from_fn(n, n, |i, k| columns[k][i])
    });
    LoadForces { forces: forces(body, &here, time, body.loads(), false), by_place, by_velocity }
}

impl ConservativeBody {
    /// Generalised forces (6+nf) of each of its loads where its history is 1: force and moment about the origin in body axes, and modal
    /// forces. Inputs of a linear model act by them.
    pub fn unit_forces(&self, at: &MotionState) -> Vec<Vec<f64>> {
        let seen = Seen {
            body_from_global: at.attitude.global_to_body(),
            origin: at.origin_global,
            velocity_global: at.velocity_global,
            omega_body: at.omega_body,
            q: at.modal_displacement.clone(),
            rate: at.modal_velocity.clone(),
        };
        self.loads().iter().map(|load| forces(self, &seen, at.time, std::slice::from_ref(load), true)).collect()
    }
}

/// `unit`: where histories are 1.
fn forces(body: &ConservativeBody, seen: &Seen, time: f64, loads: &[SharedLoad], unit: bool) -> Vec<f64> {
    let mut forces = vec![0.0; 6 + seen.q.len()];
    let shape = BentShape::of(body, &seen.q);
    let bent = shape.as_ref().map(BentShape::place);
    let [displacement, velocity] = match bent {
        Some(bent) => [bent.coordinates(), bent.rates_of_coordinates(&seen.rate)],
        None => [seen.q.clone(), seen.rate.clone()],
    };
    let on_manifold = bent.map(|_| [&seen.q[..], &seen.rate[..]]);
    let coordinates = Coordinates { first: 6, displacement: &displacement, velocity: &velocity, on_manifold };
    let motion = Kinematics {
        time,
        branch_time: time,
        body_from_global: &seen.body_from_global,
        origin_global: seen.origin,
        frame_origin_global: seen.origin,
        origin_velocity_global: seen.velocity_global,
        omega_body: seen.omega_body,
        coordinates,
        unit,
    };
    let (rigid, modal) = forces.split_at_mut(6);
    let mut in_shapes = vec![0.0; displacement.len()];
    let mut applied = match bent {
        Some(_) => Applied::new(coordinates, Vector3::zeros(), &mut in_shapes).on_manifold(modal),
        None => Applied::new(coordinates, Vector3::zeros(), modal),
    };
    loads.iter().for_each(|load| load.apply(&motion, &mut applied));
    rigid[..3].copy_from_slice(applied.force_body.as_slice());
    rigid[3..].copy_from_slice(applied.moment_body.as_slice());
    if let Some(bent) = bent {
        bent.add_from_shapes(&in_shapes, &mut forces[6..]);
    }
    forces
}
