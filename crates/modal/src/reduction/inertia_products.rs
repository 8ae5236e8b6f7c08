//! The constants of a reduced body that come from products of its mass matrix with modes.

use faer::Mat;

/// See the fields of [`reduced_body::Constants`] with these names.
pub(crate) struct Products {
    pub rotation_products: [[Mat<f64>; 3]; 3],
    pub position_products: [[Vec<f64>; 3]; 3],
    pub inertia_first: [Vec<f64>; 6],
    pub inertia_second: [Mat<f64>; 6],
    pub gyroscopic: [Mat<f64>; 3],
    pub translation_first: [Vec<f64>; 3],
    pub rotation_first: [Vec<f64>; 3],
}

/// Rows and columns of E_ab that belong to translations, as the geometry has them: a translation couples to another one
/// only, since all other modes leave the centre of mass where it is. With rounding left in them, a long motion would
/// leak momentum.
pub(crate) fn set_translations(product: &mut Mat<f64>, a: usize, b: usize) {
    for i in 0..3 {
        for j in 0..product.ncols() {
            product[(i, j)] = 0.0;
            product[(j, i)] = 0.0;
        }
    }
    product[(a, b)] = 1.0;
}
