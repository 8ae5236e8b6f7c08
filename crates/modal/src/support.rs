//! What holds a body, and the rigid motions that it has left.

use nalgebra::{Matrix3, Vector3};

use crate::error::ModalError;

/// How far from 1 the length of a direction may be.
const UNIT: f64 = 1e-9;

/// The rigid motions of a body that what holds it leaves free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigidMotion {
    /// Nothing holds the body: three translations and three rotations.
    Free,
    /// Three rotations about a point, mesh axes.
    Pin {
        /// The point.
        point: Vector3<f64>,
    },
    /// A rotation about an axis, mesh axes.
    Hinge {
        /// A point of the axis.
        point: Vector3<f64>,
        /// Its direction, a unit vector.
        axis: Vector3<f64>,
    },
    /// A translation, mesh axes.
    Slider {
        /// Its direction, a unit vector.
        direction: Vector3<f64>,
    },
    /// None: the body can only deform.
    Clamp {
        /// The point that positions are measured from, e.g. a point of the axis that the clamp is turned about.
        origin: Vector3<f64>,
    },
}

/// How a body is held: the nodes that move with the support, and the motions that the support has.
///
/// A held node moves as the support does, i.e. as one of the rigid motions of [`Support::motion`] takes it along; a
/// node on the axis of a hinge or at the point of a pin does not move at all.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The rigid motions left.
    pub motion: RigidMotion,
    /// Indices of the nodes that are held.
    pub nodes: Vec<u32>,
}

impl Support {
    /// Of a body that nothing holds.
    pub fn free() -> Self {
        Self { motion: RigidMotion::Free, nodes: Vec::new() }
    }
}

impl RigidMotion {
    /// Number of rigid modes: 6, 3, 1, 1 or 0.
    pub fn count(&self) -> usize {
        match self {
            Self::Free => 6,
            Self::Pin { .. } => 3,
            Self::Hinge { .. } | Self::Slider { .. } => 1,
            Self::Clamp { .. } => 0,
        }
    }

    /// The point that stays where it is (of a clamp, the one that positions are to be measured from): the origin of a
    /// body with these motions. `None` where that is the centre of mass.
    pub fn fixed_point(&self) -> Option<Vector3<f64>> {
        match self {
            Self::Free | Self::Slider { .. } => None,
            Self::Pin { point } | Self::Hinge { point, .. } | Self::Clamp { origin: point } => Some(*point),
        }
    }

    /// T and B of a rigid body with these motions: the velocity of the origin is `T y[..3]` and the angular velocity
    /// `B y[3..6]`, where the kinetic energy is ½|y|². Columns of motions that are missing are zero.
    ///
    /// `inertia` is about the origin. B = L⁻ᵀ with J₀ = L Lᵀ where all rotations are free: no principal axes are
    /// needed, which a sphere has not got.
    ///
    /// # Errors
    /// [`ModalError::NoInertia`] where a motion meets none, [`ModalError::NotUnit`], [`ModalError::NotFinite`].
    pub(crate) fn bases(&self, mass: f64, inertia: &Matrix3<f64>) -> Result<(Matrix3<f64>, Matrix3<f64>), ModalError> {
        self.check()?;
        let no_inertia = || ModalError::NoInertia { mass, inertia: inertia.diagonal().into() };
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(no_inertia());
        }
        let (mut translation, mut rotation) = (Matrix3::zeros(), Matrix3::zeros());
        match self {
            Self::Free | Self::Pin { .. } => {
                let factor = inertia.cholesky().ok_or_else(no_inertia)?.l();
                rotation = factor.transpose().try_inverse().ok_or_else(no_inertia)?;
                if *self == Self::Free {
                    translation = Matrix3::identity() / mass.sqrt();
                }
            }
            Self::Hinge { axis, .. } => {
                let moment = axis.dot(&(inertia * axis));
                if !(moment > 0.0 && moment.is_finite()) {
                    return Err(no_inertia());
                }
                rotation.set_column(0, &(axis / moment.sqrt()));
            }
            Self::Slider { direction } => translation.set_column(0, &(direction / mass.sqrt())),
            Self::Clamp { .. } => {}
        }
        Ok((translation, rotation))
    }

    /// Displacements of the point X by each of the motions; rotations are by 1/`length`, of a free body about `center`.
    pub(crate) fn displacements(
        &self,
        position: &Vector3<f64>,
        center: &Vector3<f64>,
        length: f64,
    ) -> Vec<Vector3<f64>> {
        let axes: [Vector3<f64>; 3] = std::array::from_fn(|axis| Vector3::ith(axis, 1.0));
        let turned = |axis: &Vector3<f64>, about: &Vector3<f64>| axis.cross(&(position - about)) / length;
        match self {
            Self::Free => axes.into_iter().chain(axes.map(|axis| turned(&axis, center))).collect(),
            Self::Pin { point } => axes.map(|axis| turned(&axis, point)).into(),
            Self::Hinge { point, axis } => vec![turned(axis, point)],
            Self::Slider { direction } => vec![*direction],
            Self::Clamp { .. } => Vec::new(),
        }
    }

    /// What a message calls the motion of column `mode` of the six rigid shapes.
    pub(crate) fn name(&self, mode: usize) -> &'static str {
        match self {
            Self::Hinge { .. } => "rotation about the hinge",
            Self::Slider { .. } => "translation along the slider",
            Self::Free | Self::Pin { .. } | Self::Clamp { .. } => [
                "translation along x",
                "translation along y",
                "translation along z",
                "rotation about x",
                "rotation about y",
                "rotation about z",
            ][mode],
        }
    }

    /// Refuses points that are not finite and directions that are no unit vectors.
    pub(crate) fn check(&self) -> Result<(), ModalError> {
        let point = self.fixed_point().unwrap_or_default();
        if let Some((index, value)) = point.iter().enumerate().find(|(_, c)| !c.is_finite()) {
            return Err(ModalError::NotFinite { what: "the support's point", index, value: *value });
        }
        let direction = match self {
            Self::Hinge { axis, .. } => Some(axis),
            Self::Slider { direction } => Some(direction),
            Self::Free | Self::Pin { .. } | Self::Clamp { .. } => None,
        };
        let off = direction.map_or(0.0, |d| (d.norm() - 1.0).abs());
        match direction {
            Some(d) if off.is_nan() || off >= UNIT => Err(ModalError::NotUnit { direction: (*d).into() }),
            _ => Ok(()),
        }
    }
}
