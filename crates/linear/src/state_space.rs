//! State spaces, Eq. (F3).

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::channel::Channel;
use crate::error::LinearError;

/// x' = A x + B u, y = C x + D u.
#[derive(Debug, Clone)]
pub struct StateSpace {
    /// A (n×n).
    pub a: Mat<f64>,
    /// B (n×m).
    pub b: Mat<f64>,
    /// C (p×n).
    pub c: Mat<f64>,
    /// D (p×m).
    pub d: Mat<f64>,
    /// States (n).
    pub states: Vec<Channel>,
    /// Inputs (m).
    pub inputs: Vec<Channel>,
    /// Outputs (p).
    pub outputs: Vec<Channel>,
}

impl StateSpace {
    /// Eigenvalues of A, slowest first.
    ///
    /// # Errors
    /// [`LinearError::Eigen`].
    pub fn poles(&self) -> Result<Vec<c64>, LinearError> {
        let size = self.a.nrows();
        if size == 0 {
            return Ok(Vec::new());
        }
        let mut poles = self.a.eigenvalues().map_err(|_| LinearError::Eigen { size })?;
        poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im)));
        Ok(poles)
    }

    /// C (iω − A)⁻¹ B + D (p×m) at a circular frequency, rad per time.
    ///
    /// # Errors
    /// [`LinearError::Resonance`] where it has none.
    pub fn response(&self, circular_frequency: f64) -> Result<Mat<c64>, LinearError> {
        let complex =
            |matrix: &Mat<f64>| Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| c64::new(matrix[(i, j)], 0.0));
        let n = self.a.nrows();
        let shifted =
            Mat::from_fn(n, n, |i, j| c64::new(-self.a[(i, j)], if i == j { circular_frequency } else { 0.0 }));
        let response = complex(&self.c) * shifted.partial_piv_lu().solve(complex(&self.b)) + complex(&self.d);
        let is_finite = response.col_iter().all(|column| column.iter().all(|x| x.re.is_finite() && x.im.is_finite()));
        if is_finite {
            Ok(response)
        } else {
            Err(LinearError::Resonance { frequency: circular_frequency / std::f64::consts::TAU })
        }
    }
}
