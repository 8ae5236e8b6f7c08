//! Reproducible scattered vectors for the tests.

use nalgebra::{Matrix3, Vector3};

use crate::rotation::transformation_matrix;

/// A stream of numbers in (−1, 1): Weyl's sequence of the golden ratio through a mixing hash
/// (splitmix64).
pub struct Samples(u64);

impl Samples {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.number())
    }

    pub fn unit_vector(&mut self) -> Vector3<f64> {
        loop {
            let v = self.vector();
            let length = v.norm();
            if (0.1..=1.0).contains(&length) {
                return v / length;
            }
        }
    }

    /// A full (not diagonal) inertia of a real body: that of scattered point masses.
    pub fn inertia_matrix(&mut self) -> Matrix3<f64> {
        let axes = transformation_matrix(&(3.0 * self.unit_vector()));
        let second_moments = self.vector().map(|s| 1.5 + s);
        let principal = Matrix3::from_diagonal(&second_moments.map(|s| second_moments.sum() - s));
        let inertia = axes.transpose() * principal * axes;
        0.5 * (inertia + inertia.transpose())
    }
}
