//! The forces that a rigid motion of the undeformed body puts on its nodes, up to the sign: mass times acceleration.

use faer::Mat;
use nalgebra::Vector3;

use crate::error::ModalError;
use crate::input::check_rows;
use crate::matrix::mass_matrix::{MassMatrix, Turning};
use crate::reduction::turned::turned;
use crate::support::rigid_fields::rigid_fields;
use reduced_body::ReducedBody;

/// Name of the positions in messages.
const POSITIONS: &str = "positions";

/// f_ij (N×6, pairs as in [`ReducedBody::PAIRS`]): `−M (I⊗sym([e_i×][e_j×])) X`, X from `origin`, mesh axes. With a mass that
/// is not a scalar for each pair of nodes, `−sym((I⊗[e_j×]) M H_i)` with the unit rotations `H_i = [e_i × X; e_i]`, which is
/// the same where M acts alike on all axes.
///
/// A body that spins at ω about the origin meets the centrifugal force `Σ ω_iω_j f_ij` over all nine ij, so each of the
/// last three columns counts twice. `Ψ_fᵀ f_ij` is [`reduced_body::Constants::inertia_first`].
///
/// # Errors
/// [`ModalError::Size`] where there are more or fewer positions than nodes.
pub fn centrifugal_fields(
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    origin: &Vector3<f64>,
) -> Result<Mat<f64>, ModalError> {
    check_rows(POSITIONS, positions.len(), mass.nodes())?;
    Ok(match mass.turning() {
        Turning::Nodal(_) => mass.product(centrifugal_accelerations(positions, origin).as_ref()),
        Turning::Tied(tied) => tied.forces(centrifugal_accelerations(&tied.positions(positions), origin).as_ref()),
        Turning::Anisotropic(general) => {
            let fields = rigid_fields(positions, origin, general.dofs);
            let momenta = mass.product(fields.subcols(3, 3));
            let forces: [Mat<f64>; 3] = std::array::from_fn(|axis| turned(momenta.as_ref(), axis));
            Mat::from_fn(momenta.nrows(), ReducedBody::PAIRS.len(), |row, pair| {
                let (i, j) = ReducedBody::PAIRS[pair];
                -0.5 * (forces[j][(row, i)] + forces[i][(row, j)])
            })
        }
    })
}

/// `−(I⊗sym([e_i×][e_j×])) X` (3n×6), X from `origin`: [`centrifugal_fields`] of a mass that is a scalar for each pair of nodes is M times it.
pub fn centrifugal_accelerations(positions: &[[f64; 3]], origin: &Vector3<f64>) -> Mat<f64> {
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
    fields
}

/// `M (1⊗e_i)` (N×3): the weight of a unit acceleration of gravity along each axis of the mesh.
pub fn acceleration_fields(mass: &MassMatrix<'_>) -> Mat<f64> {
    let translations = match mass {
        MassMatrix::Nodal(mass) => Mat::from_fn(3 * mass.node_count(), 3, |i, axis| f64::from(i % 3 == axis)),
        MassMatrix::General(mass) => mass.translations(),
    };
    mass.product(translations.as_ref())
}

/// `M (I⊗[a×]) X` (N×1), X from `origin`: minus the Euler force of a unit angular acceleration about `axis` (a).
///
/// # Errors
/// [`ModalError::Size`] where there are more or fewer positions than nodes.
pub fn turning_field(
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    origin: &Vector3<f64>,
    axis: &Vector3<f64>,
) -> Result<Mat<f64>, ModalError> {
    check_rows(POSITIONS, positions.len(), mass.nodes())?;
    let rotations = rigid_fields(positions, origin, mass.dofs()).subcols(3, 3).to_owned();
    Ok(mass.product((rotations * Mat::from_fn(3, 1, |i, _| axis[i])).as_ref()))
}
