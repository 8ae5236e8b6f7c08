//! The rigid modes that a body has, from its geometry alone.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::eigen::polynomials::{Field, rigid_field};
use crate::error::ModalError;
use crate::matrix::dense::whitening;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::support::rigid_fields::{General, rigid_fields};
use reduced_body::{BodyError, RigidMotion};

/// ‖K r‖ relative to ‖D r‖, D the diagonal of K, that rounding in the assembly of K may leave.
const FREE: f64 = 1e-9;

/// Rigid modes, M-orthonormal, Eq. (M6) of `docs/method/modes.md`, and the rigid body that they belong to. All in mesh axes.
///
/// There is a column for each of the three translations and rotations, zero for a motion that the body does not have.
/// The first three are translations `T[:,i]`, the others rotations `B[:,i] × X` with X measured from the origin. So the
/// velocity of the origin of modal velocities y is `T y[..3]`, and the angular velocity `B y[3..6]`. The rotation of a node
/// with six degrees of freedom is `B[:,i]`. Where the motions are [`RigidMotion::others`], T and B are zero, and the first
/// columns of the shapes are combinations of them.
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
    /// The modes (3n×6, or 6n×6 of nodes with rotations).
    pub shapes: Mat<f64>,
}

impl RigidModes {
    /// Mass properties and rigid modes of the nodes at `positions` (n×3) with the mass matrix `mass`.
    ///
    /// # Errors
    /// [`ModalError::Length`] where there are not as many positions as nodes, or none; [`ModalError::Body`] where a motion meets neither mass nor inertia, or a direction is not a unit vector;
    /// [`ModalError::NoRigidBodyMass`] of a body that moves.
    pub fn new(mass: &MassMatrix<'_>, positions: &[[f64; 3]], motion: RigidMotion) -> Result<Self, ModalError> {
        if positions.len() != mass.nodes() || positions.is_empty() {
            let what = "the list of positions";
            return Err(ModalError::Length { what, found: positions.len(), expected: mass.nodes().max(1) });
        }
        // Measured from the first node, so that a body far from the mesh's origin loses no digits.
        let first = Vector3::from(positions[0]);
        let (total, moment) = match mass {
            MassMatrix::Nodal(mass) => {
                let nodal = mass.row_sums();
                let of_node = |(x, m): (&[f64; 3], &f64)| (Vector3::from(*x) - first) * *m;
                (nodal.iter().sum(), positions.iter().zip(&nodal).map(of_node).sum())
            }
            MassMatrix::General(mass) => {
                let general = General::new(mass, positions, &first);
                if motion.count() > 0 {
                    general.check_rigid_body()?;
                }
                (general.mass(), general.moment())
            }
        };
        let moment: Vector3<f64> = moment;
        let center_of_mass = first + moment / total;
        let origin = motion.fixed_point().unwrap_or(center_of_mass);
        let arm = motion.fixed_point().map_or(moment / total, |point| point - first);
        let offset = |node: usize| (Vector3::from(positions[node]) - first) - arm;

        let inertia = match mass {
            MassMatrix::Nodal(mass) => {
                // M is the same for each axis: ∫ρ X_a X_b needs X_b on the axis a, so the three axes make three vectors.
                let on_axis =
                    Mat::from_fn(3 * positions.len(), 3, |i, b| if i % 3 == 0 { offset(i / 3)[b] } else { 0.0 });
                let second = tall::inner(on_axis.as_ref(), mass.product(on_axis.as_ref()).as_ref());
                let second = Matrix3::from_fn(|a, b| 0.5 * (second[(a, b)] + second[(b, a)]));
                Matrix3::identity() * second.trace() - second
            }
            MassMatrix::General(mass) => General::new(mass, positions, &(first + arm)).inertia(),
        };
        let (translation_basis, rotation_basis) = motion.bases(total, &inertia)?;
        let dofs = mass.dofs();
        let shapes = if motion.others().is_empty() {
            Mat::from_fn(dofs * positions.len(), 6, |i, mode| {
                let (node, dof) = (i / dofs, i % dofs);
                match (mode.checked_sub(3), dof.checked_sub(3)) {
                    (None, None) => translation_basis[(dof, mode)],
                    (None, Some(_)) => 0.0,
                    (Some(axis), None) => rotation_basis.column(axis).cross(&offset(node))[dof],
                    (Some(axis), Some(about)) => rotation_basis[(about, axis)],
                }
            })
        } else {
            orthonormal_motions(mass, positions, &motion, &origin)?
        };
        Ok(Self { motion, mass: total, center_of_mass, origin, inertia, translation_basis, rotation_basis, shapes })
    }

    /// Checks that K resists none of the rigid motions; returns the largest ‖K r‖/‖D r‖, D the diagonal of K.
    ///
    /// # Errors
    /// [`ModalError::NotFree`] where it is no rounding.
    pub fn check_free<'a>(&self, stiffness: impl Into<StiffnessMatrix<'a>>) -> Result<f64, ModalError> {
        let stiffness = stiffness.into();
        let forces = stiffness.product(self.shapes.as_ref());
        let diagonal = stiffness.diagonal();
        let scales = Mat::from_fn(forces.nrows(), 6, |i, mode| diagonal[i] * self.shapes[(i, mode)]);
        let of_mode = |mode: usize| [forces.col(mode).norm_l2(), scales.col(mode).norm_l2()];
        self.refuse_resistance((0..6).map(of_mode))
    }

    /// Refuses ‖K r‖ that are no rounding, by them and the ‖D r‖ of each mode; returns the largest of their ratios.
    pub(crate) fn refuse_resistance(&self, norms: impl Iterator<Item = [f64; 2]>) -> Result<f64, ModalError> {
        let mut largest = 0.0_f64;
        for (mode, [force, scale]) in norms.enumerate() {
            if !self.shapes.col(mode).iter().any(|u| *u != 0.0) {
                continue;
            }
            let relative = force / scale;
            if relative.is_nan() || relative >= FREE {
                let motion = self.motion.name(mode);
                return Err(ModalError::NotFree { motion, relative, limit: FREE });
            }
            largest = largest.max(relative);
        }
        Ok(largest)
    }

    /// The modes as polynomials in the positions from the centre of mass; none where the motions are of another kind.
    pub(crate) fn fields(&self) -> Option<Vec<Field>> {
        if !self.motion.others().is_empty() {
            return None;
        }
        let arm = self.center_of_mass - self.origin;
        let none = Vector3::zeros();
        let translations = self.translation_basis.column_iter().map(|t| rigid_field(&t.into(), &none));
        let rotations = self.rotation_basis.column_iter().map(|b| rigid_field(&b.cross(&arm), &b.into()));
        Some(translations.chain(rotations).collect())
    }
}

/// The motions of another kind, M-orthonormal, then zeros (N×6).
fn orthonormal_motions(
    mass: &MassMatrix<'_>,
    positions: &[[f64; 3]],
    motion: &RigidMotion,
    origin: &Vector3<f64>,
) -> Result<Mat<f64>, ModalError> {
    let motions = motion.others();
    let fields = rigid_fields(positions, origin, mass.dofs());
    let coefficients =
        Mat::from_fn(6, motions.len(), |i, k| if i < 3 { motions[k].velocity[i] } else { motions[k].rotation[i - 3] });
    let fields = tall::product(fields.as_ref(), coefficients.as_ref());
    let gram = tall::inner(fields.as_ref(), mass.product(fields.as_ref()).as_ref());
    let whitening = whitening(&gram).map_err(|_| BodyError::NoInertia {
        mass: gram[(0, 0)],
        inertia: std::array::from_fn(|k| gram[(k.min(motions.len() - 1), k.min(motions.len() - 1))]),
    })?;
    let mut shapes = Mat::zeros(fields.nrows(), 6);
    shapes.as_mut().subcols_mut(0, motions.len()).copy_from(tall::product(fields.as_ref(), whitening.as_ref()));
    Ok(shapes)
}
