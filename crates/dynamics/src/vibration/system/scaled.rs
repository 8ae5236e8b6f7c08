//! Equations of small motions as a matrix of frequencies.

use faer::Mat;

/// η̈ + C η̇ + K η = 0 over x = s η and y = η̇, in scales s by which all entries are frequencies.
#[derive(Debug, Clone)]
pub struct ScaledEquations {
    /// The matrix (2n×2n) of (x, y)' = matrix (x, y).
    pub matrix: Mat<f64>,
    /// s (n), rad per time.
    pub scales: Vec<f64>,
}

impl ScaledEquations {
    /// The equations of K and C (n×n).
    pub fn new(stiffness: &Mat<f64>, damping: &Mat<f64>) -> Self {
        let size = stiffness.nrows();
        let scales: Vec<f64> = (0..size).map(|k| scale(stiffness, damping, k)).collect();
        let matrix = Mat::from_fn(2 * size, 2 * size, |row, column| match (row < size, column < size) {
            (true, true) => 0.0,
            (true, false) => {
                if row == column - size {
                    scales[row]
                } else {
                    0.0
                }
            }
            (false, true) => -stiffness[(row - size, column)] / scales[column],
            (false, false) => -damping[(row - size, column - size)],
        });
        Self { matrix, scales }
    }

    /// The largest scale.
    pub fn fastest(&self) -> f64 {
        self.scales.iter().copied().fold(0.0, f64::max)
    }

    /// The size below which eigenvalues are zeros that rounding has parted: two parts by its root, in the scale `slow` of the motions that may have
    /// them, and one alone by `rounding` of the fastest.
    pub fn zero(&self, slow: f64, rounding: f64) -> f64 {
        let fastest = self.fastest();
        (10.0 * (f64::EPSILON * fastest * slow).sqrt()).max(rounding * fastest)
    }
}

/// A frequency that a coordinate is measured by.
fn scale(stiffness: &Mat<f64>, damping: &Mat<f64>, k: usize) -> f64 {
    let own = stiffness[(k, k)].abs().sqrt().max(damping[(k, k)].abs());
    if own > 0.0 {
        return own;
    }
    let n = stiffness.nrows();
    let of = |j: usize| stiffness[(j, k)].abs().sqrt().max(damping[(j, k)].abs()).max(damping[(k, j)].abs());
    let largest = (0..n).map(of).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}
