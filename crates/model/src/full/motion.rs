//! A state of a model on all nodes of its body: displacements, accelerations, and how they go with the coordinates.

use dynamics::Observation;
use faer::Mat;
use nalgebra::Vector3;
use nonlinear::{ExternalForces, FullState};

use crate::model::{Meshed, Model};

/// Weights of the values at −2, −1, 1 and 2 steps for a first derivative: exact for polynomials to the fourth degree.
const FIRST: [f64; 4] = [1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0];
/// The same for a second derivative, to the fifth degree, with that of the value between.
const SECOND: [f64; 4] = [-1.0 / 12.0, 16.0 / 12.0, 16.0 / 12.0, -1.0 / 12.0];
const SECOND_BETWEEN: f64 = -30.0 / 12.0;
const PLACES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

impl Model {
    /// The state that an observed motion is on all nodes of the body, under these forces; `None` without a mesh.
    pub fn full_state(&self, motion: &Observation, forces: ExternalForces) -> Option<FullState> {
        let meshed = self.meshed.as_ref()?;
        let q = &motion.modal_displacement;
        let xi = self.coordinates(q);
        let [rate, curved] = [1, 2].map(|order| self.along(q, &motion.modal_velocity, order));
        let change: Vec<f64> =
            self.along(q, &motion.modal_acceleration, 1).iter().zip(&curved).map(|(a, b)| a + b).collect();
        let [mut displacement, velocity, relative] = [&xi, &rate, &change].map(|xi| field(meshed, xi));
        if let Some(reference) = &meshed.reference {
            displacement.iter_mut().zip(reference.col(0).iter()).for_each(|(u, of_reference)| *u += of_reference);
        }
        let (omega, alpha) = (motion.omega_body, motion.alpha_body);
        let of_origin = motion.attitude.to_body(&motion.origin_acceleration_global);
        let at = |list: &[f64], node: usize| Vector3::from_column_slice(&list[3 * node..3 * node + 3]);
        let acceleration = meshed
            .mesh
            .positions()
            .iter()
            .enumerate()
            .flat_map(|(node, x)| {
                let arm = Vector3::from(*x) - self.body.origin + at(&displacement, node);
                let turning = alpha.cross(&arm) + omega.cross(&omega.cross(&arm));
                let coriolis = 2.0 * omega.cross(&at(&velocity, node));
                <[f64; 3]>::from(of_origin + turning + coriolis + at(&relative, node))
            })
            .collect();
        Some(FullState { displacement, acceleration, omega_body: omega, alpha_body: alpha, forces })
    }

    /// ∂u/∂q of all nodes (3n×nf) at modal displacements; `None` without a mesh.
    pub(crate) fn slopes(&self, q: &[f64]) -> Option<Mat<f64>> {
        let meshed = self.meshed.as_ref()?;
        let columns: Vec<Vec<f64>> = (0..q.len())
            .map(|k| {
                let mut unit = vec![0.0; q.len()];
                unit[k] = 1.0;
                field(meshed, &self.along(q, &unit, 1))
            })
            .collect();
        Some(Mat::from_fn(meshed.modes.shapes.nrows(), q.len(), |row, k| columns[k][row]))
    }

    /// The first or the second derivative of ξ(q) along a direction. ξ is a polynomial of low degree.
    fn along(&self, q: &[f64], direction: &[f64], order: i32) -> Vec<f64> {
        let largest = |list: &[f64]| list.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let (size, speed) = (largest(q), largest(direction));
        let here = self.coordinates(q);
        if speed == 0.0 {
            return vec![0.0; here.len()];
        }
        // As far as the body is from rest, so that rounding counts as little as it can.
        let h = if size > 0.0 { size / speed } else { 1.0 / speed };
        let weights = if order == 1 { FIRST } else { SECOND };
        let mut sum: Vec<f64> = match order {
            1 => vec![0.0; here.len()],
            _ => here.iter().map(|xi| SECOND_BETWEEN * xi).collect(),
        };
        for (place, weight) in PLACES.iter().zip(weights) {
            let moved: Vec<f64> = q.iter().zip(direction).map(|(q, d)| q + place * h * d).collect();
            sum.iter_mut().zip(self.coordinates(&moved)).for_each(|(sum, xi)| *sum += weight * xi);
        }
        sum.iter().map(|sum| sum / h.powi(order)).collect()
    }
}

/// The displacements of all nodes by the coordinates of modes and following shapes (3n).
fn field(meshed: &Meshed, xi: &[f64]) -> Vec<f64> {
    let modes = &meshed.modes.shapes;
    let mut u = vec![0.0; modes.nrows()];
    let columns = modes.col_iter().chain(meshed.following.col_iter());
    for (column, xi) in columns.zip(xi).filter(|(_, xi)| **xi != 0.0) {
        u.iter_mut().zip(column.iter()).for_each(|(u, shape)| *u += xi * shape);
    }
    u
}
