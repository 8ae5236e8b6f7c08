//! The products of modes with a spin, `G_i = Ψᵀ M (I⊗[e_i×]) Ψ`.

use dynamics::faer::linalg::matmul::matmul;
use dynamics::faer::{Accum, ColMut, ColRef, Mat, Par};
use dynamics::reduced_body::ReducedBody;

/// G_1, G_2, G_3 of all modes (6+nf square): [e_1×] = e_3 e_2ᵀ − e_2 e_3ᵀ and cyclic.
pub(crate) fn cross_products(body: &ReducedBody) -> [Mat<f64>; 3] {
    [(2, 1), (0, 2), (1, 0)].map(|(a, b)| &body.rotation_products[a][b] - &body.rotation_products[b][a])
}

/// `y = M x`
pub(crate) fn multiply(matrix: &Mat<f64>, x: &[f64], y: &mut [f64]) {
    matmul(ColMut::from_slice_mut(y), Accum::Replace, matrix, ColRef::from_slice(x), 1.0, Par::Seq);
}
