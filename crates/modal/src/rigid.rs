//! The rigid modes that a body has, from its geometry alone.

use faer::Mat;
use faer::sparse::SparseColMatRef;
use nalgebra::{Matrix3, Vector3};

use crate::error::ModalError;
use crate::mass::NodalMass;
use crate::products::symmetric_product;
use crate::support::RigidMotion;
use crate::tall;

/// ‖K r‖ relative to ‖D r‖, D the diagonal of K, that rounding in the assembly of K may leave.
const FREE: f64 = 1e-9;

/// Rigid modes, M-orthonormal, and the rigid body that they belong to. All in mesh axes.
///
/// There is a column for each of the three translations and rotations, zero for a motion that the body does not have.
/// The first three are translations `T[:,i]`, the others rotations `B[:,i] × X` with X measured from the origin. So the
/// velocity of the origin of modal velocities y is `T y[..3]`, and the angular velocity `B y[3..6]`.
#[derive(Debug, Clone)]
pub struct RigidModes {
    /// The motions that the body has.
    pub motion: RigidMotion,
    /// Total mass m.
    pub mass: f64,
    /// Centre of mass, in the mesh's frame.
    pub center_of_mass: Vector3<f64>,
    /// The point that X is measured from, in the mesh's frame; the centre of mass where nothing holds one.
    pub origin: Vector3<f64>,
    /// Inertia J₀ about the origin.
    pub inertia: Matrix3<f64>,
    /// T (3×3): columns are the velocities of the translation modes; I/√m of a free body, d/√m first of a slider.
    pub translation_basis: Matrix3<f64>,
    /// B (3×3): columns are the angular velocities of the rotation modes; L⁻ᵀ of a free or pinned body, J₀ = L Lᵀ,
    /// and a/√(aᵀJ₀a) first of a hinge.
    pub rotation_basis: Matrix3<f64>,
    /// The modes (3n×6).
    pub shapes: Mat<f64>,
}

impl RigidModes {
    /// Mass properties and rigid modes of the nodes at `positions` (n×3) with the mass matrix `mass`.
    ///
    /// # Errors
    /// [`ModalError::NoInertia`] where a motion meets neither mass nor inertia; [`ModalError::NotUnit`].
    pub fn new(mass: &NodalMass, positions: &[[f64; 3]], motion: RigidMotion) -> Result<Self, ModalError> {
        let nodal = mass.row_sums();
        let total: f64 = nodal.iter().sum();
        // Measured from the first node, so that a body far from the mesh's origin loses no digits.
        let first = Vector3::from(positions[0]);
        let moment: Vector3<f64> = positions.iter().zip(&nodal).map(|(x, m)| (Vector3::from(*x) - first) * *m).sum();
        let center_of_mass = first + moment / total;
        let origin = motion.fixed_point().unwrap_or(center_of_mass);
        let arm = motion.fixed_point().map_or(moment / total, |point| point - first);
        let offset = |node: usize| (Vector3::from(positions[node]) - first) - arm;

        // M is the same for each axis: ∫ρ X_a X_b needs X_b on the axis a, so the three axes make three vectors.
        let on_axis = Mat::from_fn(3 * positions.len(), 3, |i, b| if i % 3 == 0 { offset(i / 3)[b] } else { 0.0 });
        let second = tall::inner(on_axis.as_ref(), mass.product(on_axis.as_ref()).as_ref());
        let second = Matrix3::from_fn(|a, b| 0.5 * (second[(a, b)] + second[(b, a)]));
        let inertia = Matrix3::identity() * second.trace() - second;
        let (translation_basis, rotation_basis) = motion.bases(total, &inertia)?;
        let shapes = Mat::from_fn(3 * positions.len(), 6, |i, mode| {
            let (node, axis) = (i / 3, i % 3);
            if mode < 3 {
                translation_basis[(axis, mode)]
            } else {
                rotation_basis.column(mode - 3).cross(&offset(node))[axis]
            }
        });
        Ok(Self { motion, mass: total, center_of_mass, origin, inertia, translation_basis, rotation_basis, shapes })
    }

    /// Checks that K resists none of the rigid motions.
    pub(crate) fn check_free(&self, stiffness: SparseColMatRef<'_, usize, f64>) -> Result<(), ModalError> {
        let forces = symmetric_product(stiffness, self.shapes.as_ref());
        let diagonal: Vec<f64> = (0..forces.nrows()).map(|i| stiffness.get(i, i).copied().unwrap_or(0.0)).collect();
        let scales = Mat::from_fn(forces.nrows(), 6, |i, mode| diagonal[i] * self.shapes[(i, mode)]);
        let is_there = |mode: &usize| self.shapes.col(*mode).iter().any(|u| *u != 0.0);
        for mode in (0..6).filter(is_there) {
            let relative = forces.col(mode).norm_l2() / scales.col(mode).norm_l2();
            if relative.is_nan() || relative >= FREE {
                let motion = self.motion.name(mode);
                return Err(ModalError::NotFree { motion, relative, limit: FREE });
            }
        }
        Ok(())
    }
}
