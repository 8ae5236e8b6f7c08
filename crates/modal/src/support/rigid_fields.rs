//! Rigid motions as fields on the nodes, and what a mass matrix of any kind makes of them.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::error::ModalError;
use crate::matrix::mass_matrix::GeneralMass;
use crate::matrix::tall;

/// How far the mass of a translation may be from m·I, and the momentum of a rotation from m ω×c, relative to m and to m times
/// the radius of gyration.
const RIGID_BODY: f64 = 1e-9;

/// The unit translations `[e_i; 0]` and rotations `[e_i × X; e_i]` (N×6), X from `origin`.
pub(crate) fn rigid_fields(positions: &[[f64; 3]], origin: &Vector3<f64>, dofs: usize) -> Mat<f64> {
    let mut fields = Mat::zeros(dofs * positions.len(), 6);
    for (node, position) in positions.iter().enumerate() {
        let turned = (Vector3::from(*position) - origin).cross_matrix().transpose();
        for axis in 0..3 {
            fields[(dofs * node + axis, axis)] = 1.0;
            for i in 0..3 {
                fields[(dofs * node + i, 3 + axis)] = turned[(i, axis)];
            }
            if dofs == 6 {
                fields[(dofs * node + 3 + axis, 3 + axis)] = 1.0;
            }
        }
    }
    fields
}

/// The mass matrix of the rigid motions about a point (6×6).
pub(crate) struct General {
    translation: Matrix3<f64>,
    /// Momentum of the unit rotations, a column each.
    momentum: Matrix3<f64>,
    rotation: Matrix3<f64>,
}

impl General {
    pub(crate) fn new(mass: &GeneralMass<'_>, positions: &[[f64; 3]], origin: &Vector3<f64>) -> Self {
        let fields = rigid_fields(positions, origin, mass.dofs);
        let product = crate::matrix::products::symmetric_product(mass.matrix, fields.as_ref());
        let all = tall::inner(fields.as_ref(), product.as_ref());
        let part = |row: usize, column: usize| {
            Matrix3::from_fn(|i, j| 0.5 * (all[(row + i, column + j)] + all[(column + j, row + i)]))
        };
        Self { translation: part(0, 0), momentum: part(0, 3), rotation: part(3, 3) }
    }

    /// m, the mean over the three axes.
    pub(crate) fn mass(&self) -> f64 {
        self.translation.trace() / 3.0
    }

    /// m c: the momentum of the rotation ω is m ω×c.
    pub(crate) fn moment(&self) -> Vector3<f64> {
        let p = self.momentum;
        0.5 * Vector3::new(p[(1, 2)] - p[(2, 1)], p[(2, 0)] - p[(0, 2)], p[(0, 1)] - p[(1, 0)])
    }

    /// Inertia about the point.
    pub(crate) fn inertia(&self) -> Matrix3<f64> {
        self.rotation
    }

    /// Refuses a mass that no rigid body has.
    pub(crate) fn check_rigid_body(&self) -> Result<(), ModalError> {
        let mass = self.mass();
        let radius = (self.rotation.trace() / mass).sqrt();
        let anisotropy = (self.translation - Matrix3::identity() * mass).norm() / mass;
        let symmetric = 0.5 * (self.momentum + self.momentum.transpose()).norm() / (mass * radius);
        for (what, relative) in [("the mass along the axes", anisotropy), ("the momentum of a rotation", symmetric)] {
            // What has no mass is refused by its inertia.
            if relative > RIGID_BODY {
                return Err(ModalError::NoRigidBodyMass { what, relative, limit: RIGID_BODY });
            }
        }
        Ok(())
    }
}
