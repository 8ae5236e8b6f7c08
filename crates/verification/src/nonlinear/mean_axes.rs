//! The mean axes of a free body: against them its displacements have no part along rigid motions.

use nalgebra::{Matrix3, Vector3};

use crate::nonlinear::solid::Solid;

/// The frame of the linear modes in a displaced body.
pub struct MeanAxes {
    /// Takes body components to global components.
    pub rotation: Matrix3<f64>,
    /// Displacements against the frame, body components (3n).
    pub displacement: Vec<f64>,
}

/// The mean axes of a displaced solid. Their displacements have `Σ m u = 0` and `Σ m X × u = 0`.
pub fn mean_axes(solid: &Solid, u: &[f64]) -> MeanAxes {
    let place = |i: usize| Vector3::from(solid.mesh().positions()[i]);
    let moved = |i: usize| place(i) + Vector3::from_column_slice(&u[3 * i..3 * i + 3]);
    let count = u.len() / 3;
    let center = |position: &dyn Fn(usize) -> Vector3<f64>| {
        let all: Vec<f64> = (0..count).flat_map(|i| <[f64; 3]>::from(position(i))).collect();
        let ones = |axis: usize| (0..3 * count).map(|k| f64::from(u8::from(k % 3 == axis))).collect::<Vec<_>>();
        let momentum = solid.momentum(&all);
        let mass: f64 = solid.momentum(&ones(0)).iter().sum();
        Vector3::from_fn(|axis, _| momentum.iter().skip(axis).step_by(3).sum::<f64>() / mass)
    };
    let (from, to) = (center(&place), center(&moved));
    let arms: Vec<f64> = (0..count).flat_map(|i| <[f64; 3]>::from(moved(i) - to)).collect();
    let momentum = solid.momentum(&arms);
    let mut product = Matrix3::zeros();
    for i in 0..count {
        product += Vector3::from_column_slice(&momentum[3 * i..3 * i + 3]) * (place(i) - from).transpose();
    }
    let svd = product.svd(true, true);
    let rotation = svd.u.unwrap_or_default() * svd.v_t.unwrap_or_default();
    let displacement =
        (0..count).flat_map(|i| <[f64; 3]>::from(rotation.tr_mul(&(moved(i) - to)) - (place(i) - from))).collect();
    MeanAxes { rotation, displacement }
}
