//! A rigid body without a mesh: the reduced body that has no flexible modes.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::body::{Constants, ReducedBody};
use crate::error::{BodyError, check_finite};
use crate::rigid_motion::RigidMotion;

/// Entries of the inertia that differ from their mirror image by more than this, relative to its norm, are no rounding.
const SYMMETRY: f64 = 1e-12;

impl ReducedBody {
    /// The rigid body of this mass, centre of mass (mesh's frame) and inertia about its origin (mesh axes), which is
    /// the centre of mass of a free or sliding body and the point of one that is held.
    ///
    /// # Errors
    /// [`BodyError::NoInertia`] where the mass, or the inertia against a rotation that is free, is not positive;
    /// [`BodyError::NotSymmetric`], [`BodyError::NotFinite`], [`BodyError::NotUnit`].
    pub fn rigid(
        mass: f64,
        center_of_mass: Vector3<f64>,
        inertia_about_origin: Matrix3<f64>,
        motion: RigidMotion,
    ) -> Result<Self, BodyError> {
        let inertia = inertia_about_origin;
        check_finite("inertia", inertia.iter().copied())?;
        for (row, column) in [(1, 0), (2, 0), (2, 1)] {
            let (value, mirrored) = (inertia[(row, column)], inertia[(column, row)]);
            if (value - mirrored).abs() > SYMMETRY * inertia.norm() {
                return Err(BodyError::NotSymmetric { row, column, value, mirrored });
            }
        }
        let bases = motion.bases(mass, &inertia)?;
        Self::of_moments(mass, center_of_mass, inertia, motion, bases)
    }

    /// A point mass: a free rigid body that has no moments of inertia, so that it does not turn.
    ///
    /// # Errors
    /// [`BodyError::NoInertia`] where the mass is not positive; [`BodyError::NotFinite`].
    pub fn point(mass: f64, place: Vector3<f64>) -> Result<Self, BodyError> {
        let motion = RigidMotion::free();
        let (translation_basis, _) = motion.bases(mass, &Matrix3::identity())?;
        Self::of_moments(mass, place, Matrix3::zeros(), motion, (translation_basis, Matrix3::zeros()))
    }

    fn of_moments(
        mass: f64,
        center_of_mass: Vector3<f64>,
        inertia: Matrix3<f64>,
        motion: RigidMotion,
        (translation_basis, rotation_basis): (Matrix3<f64>, Matrix3<f64>),
    ) -> Result<Self, BodyError> {
        let origin = motion.fixed_point().unwrap_or(center_of_mass);

        // The shape of mode k is T_k + B_k × X. Where there is any T, the origin is the centre of mass and ∫ρX is zero.
        let second = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
        let constant = |k: usize| if k < 3 { translation_basis.column(k).into() } else { Vector3::zeros() };
        let linear = |k: usize| {
            if k < 3 { Matrix3::zeros() } else { rotation_basis.column(k - 3).into_owned().cross_matrix() }
        };
        let with_position: [Matrix3<f64>; 6] = std::array::from_fn(|k| linear(k) * second);
        let with_shape = |k: usize, l: usize| -> Matrix3<f64> {
            mass * constant(k) * constant(l).transpose() + with_position[k] * linear(l).transpose()
        };
        Self::from_constants(Constants {
            mass,
            center_of_mass,
            motion,
            origin,
            inertia,
            translation_basis,
            rotation_basis,
            circular_frequencies: Vec::new(),
            natural_modes: 0,
            rotation_products: std::array::from_fn(|a| {
                std::array::from_fn(|b| Mat::from_fn(6, 6, |k, l| with_shape(k, l)[(a, b)]))
            }),
            position_products: std::array::from_fn(|a| {
                std::array::from_fn(|b| with_position.iter().map(|product| product[(a, b)]).collect())
            }),
            inertia_first: Default::default(),
            inertia_second: std::array::from_fn(|_| Mat::new()),
            gyroscopic: std::array::from_fn(|_| Mat::new()),
            translation_first: Default::default(),
            rotation_first: Default::default(),
            stress_stiffness: None,
        })
    }
}
