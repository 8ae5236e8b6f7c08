//! The forces that a rigid motion of the undeformed body puts on its nodes, up to the sign: mass times acceleration.

use faer::Mat;
use nalgebra::Vector3;

use crate::mass::NodalMass;
use crate::reduced::ReducedBody;

/// f_ij (3n×6, pairs as in [`ReducedBody::PAIRS`]): `−M (I⊗sym([e_i×][e_j×])) X`, X from `origin`, mesh axes.
///
/// A body that spins at ω about the origin meets the centrifugal force `Σ ω_iω_j f_ij` over all nine ij, so each of the
/// last three columns counts twice. `Ψ_fᵀ f_ij` is [`crate::Constants::inertia_first`].
pub fn centrifugal_fields(mass: &NodalMass, positions: &[[f64; 3]], origin: &Vector3<f64>) -> Mat<f64> {
    let mut fields = Mat::zeros(3 * positions.len(), ReducedBody::PAIRS.len());
    for (node, position) in positions.iter().enumerate() {
        let x = Vector3::from(*position) - origin;
        for (pair, (i, j)) in ReducedBody::PAIRS.into_iter().enumerate() {
            // −sym([e_i×][e_j×]) = δ_ij I − sym(e_i e_jᵀ)
            let mut acceleration = if i == j { x } else { Vector3::zeros() };
            acceleration[i] -= 0.5 * x[j];
            acceleration[j] -= 0.5 * x[i];
            for axis in 0..3 {
                fields[(3 * node + axis, pair)] = acceleration[axis];
            }
        }
    }
    mass.product(fields.as_ref())
}

/// `M (1⊗e_i)` (3n×3): the weight of a unit acceleration of gravity along each axis of the mesh.
pub fn acceleration_fields(mass: &NodalMass) -> Mat<f64> {
    mass.product(Mat::from_fn(3 * mass.node_count(), 3, |i, axis| f64::from(i % 3 == axis)).as_ref())
}

/// `M (I⊗[a×]) X` (3n×1), X from `origin`: minus the Euler force of a unit angular acceleration about `axis` (a).
pub fn turning_field(mass: &NodalMass, positions: &[[f64; 3]], origin: &Vector3<f64>, axis: &Vector3<f64>) -> Mat<f64> {
    let velocity = |i: usize| axis.cross(&(Vector3::from(positions[i / 3]) - origin))[i % 3];
    mass.product(Mat::from_fn(3 * positions.len(), 1, |i, _| velocity(i)).as_ref())
}
