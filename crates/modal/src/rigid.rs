//! The six rigid modes of a free body, from its geometry alone.

use faer::Mat;
use faer::sparse::SparseColMatRef;
use nalgebra::{Matrix3, Vector3};

use crate::error::ModalError;
use crate::mass::NodalMass;
use crate::products::symmetric_product;
use crate::tall;

/// ‖K r‖ relative to ‖D r‖, D the diagonal of K, that rounding in the assembly of K may leave.
const FREE: f64 = 1e-9;
const MOTIONS: [&str; 6] = [
    "translation along x",
    "translation along y",
    "translation along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
];

/// Rigid modes, M-orthonormal, and the rigid body that they belong to.
///
/// The first three are translations `e_i / √m`; the others are rotations about the centre of mass,
/// `B[:,i] × X` with `B = L⁻ᵀ` and `J₀ = L Lᵀ`. So the angular velocity of modal velocities y is `B y[3..6]`,
/// and no principal axes are needed, which a sphere has not got.
#[derive(Debug, Clone)]
pub struct RigidModes {
    /// Total mass m.
    pub mass: f64,
    /// Centre of mass, in the mesh's frame.
    pub center_of_mass: Vector3<f64>,
    /// Inertia J₀ about the centre of mass, mesh axes.
    pub inertia: Matrix3<f64>,
    /// B (3×3): columns are the angular velocities of the rotation modes.
    pub rotation_basis: Matrix3<f64>,
    /// The modes (3n×6).
    pub shapes: Mat<f64>,
}

impl RigidModes {
    /// Mass properties and rigid modes of the nodes at `positions` (n×3) with the mass matrix `mass`.
    ///
    /// # Errors
    /// [`ModalError::NoInertia`] for bodies without mass or extension.
    pub fn new(mass: &NodalMass, positions: &[[f64; 3]]) -> Result<Self, ModalError> {
        let nodal = mass.row_sums();
        let total: f64 = nodal.iter().sum();
        // Measured from the first node, so that a body far from the origin loses no digits.
        let origin = Vector3::from(positions[0]);
        let moment: Vector3<f64> = positions.iter().zip(&nodal).map(|(x, m)| (Vector3::from(*x) - origin) * *m).sum();
        let center_of_mass = origin + moment / total;
        let offset = |node: usize| (Vector3::from(positions[node]) - origin) - moment / total;

        // M is the same for each axis: ∫ρ X_a X_b needs X_b on the axis a, so the three axes make three vectors.
        let on_axis = Mat::from_fn(3 * positions.len(), 3, |i, b| if i % 3 == 0 { offset(i / 3)[b] } else { 0.0 });
        let second = tall::inner(on_axis.as_ref(), mass.product(on_axis.as_ref()).as_ref());
        let second = Matrix3::from_fn(|a, b| 0.5 * (second[(a, b)] + second[(b, a)]));
        let inertia = Matrix3::identity() * second.trace() - second;
        let no_inertia = || ModalError::NoInertia { mass: total, inertia: inertia.diagonal().into() };
        if !(total > 0.0 && total.is_finite()) {
            return Err(no_inertia());
        }
        let factor = inertia.cholesky().ok_or_else(no_inertia)?.l();
        let rotation_basis = factor.transpose().try_inverse().ok_or_else(no_inertia)?;

        let shapes = Mat::from_fn(3 * positions.len(), 6, |i, mode| {
            let (node, axis) = (i / 3, i % 3);
            if mode < 3 {
                if mode == axis { 1.0 / total.sqrt() } else { 0.0 }
            } else {
                rotation_basis.column(mode - 3).cross(&offset(node))[axis]
            }
        });
        Ok(Self { mass: total, center_of_mass, inertia, rotation_basis, shapes })
    }

    /// Checks that K resists none of the rigid motions.
    pub(crate) fn check_free(&self, stiffness: SparseColMatRef<'_, usize, f64>) -> Result<(), ModalError> {
        let forces = symmetric_product(stiffness, self.shapes.as_ref());
        let diagonal: Vec<f64> = (0..forces.nrows()).map(|i| stiffness.get(i, i).copied().unwrap_or(0.0)).collect();
        let scales = Mat::from_fn(forces.nrows(), 6, |i, mode| diagonal[i] * self.shapes[(i, mode)]);
        for (mode, motion) in MOTIONS.into_iter().enumerate() {
            let relative = forces.col(mode).norm_l2() / scales.col(mode).norm_l2();
            if relative.is_nan() || relative >= FREE {
                return Err(ModalError::NotFree { motion, relative, limit: FREE });
            }
        }
        Ok(())
    }
}
