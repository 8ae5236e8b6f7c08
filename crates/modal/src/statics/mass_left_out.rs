//! The part of the mass that the large rotation of a body leaves out.

use faer::Mat;

use crate::matrix::mass_matrix::{MassMatrix, Turning};
use crate::matrix::products::symmetric_product;
use crate::matrix::tall::inner;
use crate::reduction::turned::turned;
use crate::solve::Modes;

/// The part of the mass that [`Modes::reduced`](crate::Modes::reduced) leaves out because it does not commute with rotations, relative to the modal
/// mass, which is 1: the largest entry of the symmetric parts of `Ψᵀ M (I⊗[e_i×]) Ψ` and of
/// `Eᵀ [M, I⊗[e_i×]] Ψ/√m`, E the unit translations. Zero of a scalar mass for each pair of nodes, also with points that move with nodes.
pub fn mass_left_out(mass: &MassMatrix<'_>, modes: &Modes) -> f64 {
    let Turning::Anisotropic(mass) = mass.turning() else { return 0.0 };
    let shapes = modes.shapes.as_ref();
    let translations = mass.translations();
    let momentum = |fields: &Mat<f64>| inner(translations.as_ref(), fields.as_ref());
    let of_modes = momentum(&symmetric_product(mass.matrix, shapes));
    let count = shapes.ncols();
    let mut largest = 0.0_f64;
    for axis in 0..3 {
        let momenta = symmetric_product(mass.matrix, turned(shapes, axis).as_ref());
        let products = inner(shapes, momenta.as_ref());
        for (k, l) in (0..count).flat_map(|k| (0..count).map(move |l| (k, l))) {
            largest = largest.max(0.5 * (products[(k, l)] + products[(l, k)]).abs());
        }
        // A scalar mass gives a turned mode the turned momentum.
        let (found, scalar) = (momentum(&momenta), turned(of_modes.as_ref(), axis));
        for (i, k) in (0..3).flat_map(|i| (0..count).map(move |k| (i, k))) {
            largest = largest.max((found[(i, k)] - scalar[(i, k)]).abs() / modes.rigid.mass.sqrt());
        }
    }
    largest
}
