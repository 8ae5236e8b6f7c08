//! The inertia tensor of a real body, checked once.

use nalgebra::{Matrix3, Vector3};

/// Errors of a matrix that is not the inertia tensor of a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InertiaError {
    /// Some entry is NaN or infinite.
    #[error("entry ({row}, {column}) of the inertia tensor (counted from 1) is {value}; give nine finite numbers")]
    NotFinite {
        /// Row of the entry, from 1.
        row: usize,
        /// Column of the entry, from 1.
        column: usize,
        /// The entry found.
        value: f64,
    },
    /// The matrix differs from its transpose.
    #[error(
        "the inertia tensor is not symmetric: entries ({row}, {column}) and ({column}, {row}) \
         (counted from 1) differ by {difference:e}; products of inertia appear twice with the \
         same sign"
    )]
    NotSymmetric {
        /// Row of the entry, from 1.
        row: usize,
        /// Column of the entry, from 1.
        column: usize,
        /// Difference of the two entries.
        difference: f64,
    },
    /// A principal moment is zero or negative.
    #[error(
        "the inertia tensor has the principal moments {moments:?}, and all three must be \
         positive; a body that is a point or a line has no attitude to follow"
    )]
    NotPositiveDefinite {
        /// Principal moments, ascending.
        moments: [f64; 3],
    },
    /// The largest moment exceeds the sum of the others.
    #[error(
        "the inertia tensor has the principal moments {moments:?}, and no body has one that \
         exceeds the sum of the other two; check the units, and the signs of the products of \
         inertia (off the diagonal stands −∫xy dm)"
    )]
    BreaksTriangleInequality {
        /// Principal moments, ascending.
        moments: [f64; 3],
    },
}

/// The inertia tensor of a body, body axes (mass × length²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    matrix: Matrix3<f64>,
    inverse: Matrix3<f64>,
    principal_moments: [f64; 3],
    principal_axes: Matrix3<f64>,
}

impl Inertia {
    /// Checks and takes the inertia tensor `matrix` (body axes; off the diagonal −∫xy dm).
    ///
    /// # Errors
    /// [`InertiaError`] if it is not finite, not symmetric (to 1e-10 of its largest entry), not
    /// positive definite, or has a principal moment above the sum of the others (by 1e-9 of it).
    pub fn new(matrix: Matrix3<f64>) -> Result<Self, InertiaError> {
        if let Some(index) = matrix.iter().position(|entry| !entry.is_finite()) {
            let (row, column) = (index % 3 + 1, index / 3 + 1);
            return Err(InertiaError::NotFinite { row, column, value: matrix[index] });
        }
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let difference = matrix[(row, column)] - matrix[(column, row)];
            if difference.abs() > 1e-10 * matrix.amax() {
                let (row, column) = (row + 1, column + 1);
                return Err(InertiaError::NotSymmetric { row, column, difference });
            }
        }
        let matrix = 0.5 * (matrix + matrix.transpose());
        let (principal_moments, principal_axes) = principal(&matrix);
        let moments = principal_moments;
        let not_positive_definite = InertiaError::NotPositiveDefinite { moments };
        if moments[0] <= 1e-14 * moments[2].abs() {
            return Err(not_positive_definite);
        }
        if moments[2] > (moments[0] + moments[1]) * (1.0 + 1e-9) {
            return Err(InertiaError::BreaksTriangleInequality { moments });
        }
        let inverse = matrix.try_inverse().ok_or(not_positive_definite)?;
        Ok(Self { matrix, inverse, principal_moments, principal_axes })
    }

    /// The tensor J itself: `angular_momentum_body = J omega_body`.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.matrix
    }

    /// J⁻¹.
    pub fn inverse(&self) -> &Matrix3<f64> {
        &self.inverse
    }

    /// Principal moments, ascending.
    pub fn principal_moments(&self) -> [f64; 3] {
        self.principal_moments
    }

    /// Principal axes as columns in body components, right-handed, in the order of
    /// [`Inertia::principal_moments`].
    pub fn principal_axes(&self) -> &Matrix3<f64> {
        &self.principal_axes
    }
}

/// Ascending eigenvalues and right-handed eigenvectors of a symmetric matrix.
fn principal(matrix: &Matrix3<f64>) -> ([f64; 3], Matrix3<f64>) {
    let is_diagonal = [(0, 1), (0, 2), (1, 2)].iter().all(|&index| matrix[index] == 0.0);
    // A body given in principal axes keeps its moments to the last digit.
    let (moments, axes) = if is_diagonal {
        (matrix.diagonal(), Matrix3::identity())
    } else {
        let eigen = matrix.symmetric_eigen();
        (eigen.eigenvalues, eigen.eigenvectors)
    };
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
    let mut columns = order.map(|i| Vector3::from(axes.column(i)));
    if columns[0].cross(&columns[1]).dot(&columns[2]) < 0.0 {
        columns[1] = -columns[1];
    }
    (order.map(|i| moments[i]), Matrix3::from_columns(&columns))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Samples;

    /// Conserved: A Λ Aᵀ is the matrix.
    #[test]
    fn principal_axes_diagonalise() {
        let mut samples = Samples::new(6);
        for _ in 0..200 {
            let matrix = samples.inertia_matrix();
            let inertia = Inertia::new(matrix).unwrap();
            let axes = inertia.principal_axes();
            let moments = Vector3::from(inertia.principal_moments());
            let rebuilt = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
            assert!((rebuilt - matrix).amax() < 1e-14 * moments.max());
            assert!((axes.determinant() - 1.0).abs() < 1e-14);
            assert!(moments[0] <= moments[1] && moments[1] <= moments[2]);
            assert!((inertia.inverse() * matrix - Matrix3::identity()).amax() < 1e-13);
        }
        let inertia = Inertia::new(Matrix3::from_diagonal(&Vector3::new(3.0, 0.7, 2.9))).unwrap();
        assert_eq!(inertia.principal_moments(), [0.7, 2.9, 3.0]);
        assert_eq!(inertia.principal_axes().determinant(), 1.0);
    }

    #[test]
    fn what_is_no_inertia_is_refused() {
        let diagonal = |a, b, c| Matrix3::from_diagonal(&Vector3::new(a, b, c));
        let mut skewed = diagonal(1.0, 1.0, 1.0);
        skewed[(2, 1)] = 1e-3;
        assert_eq!(Inertia::new(skewed), Err(InertiaError::NotSymmetric { row: 2, column: 3, difference: -1e-3 }));
        assert_eq!(
            Inertia::new(diagonal(1.0, 0.0, 1.0)),
            Err(InertiaError::NotPositiveDefinite { moments: [0.0, 1.0, 1.0] })
        );
        assert!(matches!(Inertia::new(Matrix3::zeros()), Err(InertiaError::NotPositiveDefinite { .. })));
        assert!(matches!(Inertia::new(diagonal(-1.0, -2.0, -3.0)), Err(InertiaError::NotPositiveDefinite { .. })));
        assert_eq!(
            Inertia::new(diagonal(1.0, 3.0, 1.0)),
            Err(InertiaError::BreaksTriangleInequality { moments: [1.0, 1.0, 3.0] })
        );
        let mut infinite = Matrix3::identity();
        infinite[(1, 2)] = f64::INFINITY;
        assert_eq!(Inertia::new(infinite), Err(InertiaError::NotFinite { row: 2, column: 3, value: f64::INFINITY }));
        assert!(Inertia::new(Matrix3::repeat(f64::NAN)).is_err());
        // A lamina meets the inequality with equality, to rounding.
        assert!(Inertia::new(diagonal(0.1, 0.2, 0.1 + 0.2)).is_ok());
    }
}
