//! The cross product on every vector of a field.

use faer::{Mat, MatRef};

/// `(I⊗[e_axis×])·X`: each displacement of X, and each rotation where there are any, crossed with the unit vector.
pub(crate) fn turned(x: MatRef<'_, f64>, axis: usize) -> Mat<f64> {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    Mat::from_fn(x.nrows(), x.ncols(), |i, k| {
        let component = i % 3;
        // e_1 × a = a_2 e_3 − a_3 e_2 and cyclic.
        if component == last {
            x[(i - component + next, k)]
        } else if component == next {
            -x[(i - component + last, k)]
        } else {
            0.0
        }
    })
}
