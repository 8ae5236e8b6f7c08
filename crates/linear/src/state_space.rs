//! State spaces, Eq. (F3).

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::channel::Channel;
use crate::error::LinearError;

/// Distance of the shift of an inverse iteration from its pole, relative to it, and the number of iterations.
const BESIDE: f64 = 1e-9;
const ITERATIONS: usize = 3;

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

/// A matrix of the same eigenvalues, whose rows are about as large as their columns: slow ones then have less of the rounding of the fastest
/// (Parlett and Reinsch 1969). Scales are powers of 2, so that it has no rounding of its own.
fn balanced(mut a: Mat<f64>) -> Mat<f64> {
    let n = a.nrows();
    loop {
        let mut is_balanced = true;
        for k in 0..n {
            let others = |entry: &dyn Fn(usize) -> f64| (0..n).filter(|i| *i != k).map(|i| entry(i).abs()).sum::<f64>();
            let (column, row) = (others(&|i| a[(i, k)]), others(&|j| a[(k, j)]));
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let scale = (0.5 * (row / column).log2()).round().exp2();
            if scale * column + row / scale < 0.95 * (column + row) {
                is_balanced = false;
                (0..n).for_each(|i| a[(i, k)] *= scale);
                (0..n).for_each(|j| a[(k, j)] /= scale);
            }
        }
        if is_balanced {
            return a;
        }
    }
}

impl StateSpace {
    /// Eigenvalues of A, slowest first. States that nothing couples are apart, so that a motion that nothing resists has poles of zero and no
    /// rounding.
    ///
    /// # Errors
    /// [`LinearError::Eigen`].
    pub fn poles(&self) -> Result<Vec<c64>, LinearError> {
        let mut poles = Vec::with_capacity(self.a.nrows());
        for group in self.groups() {
            let size = group.len();
            if let [x, v] = group[..] {
                let at = |i: usize, j: usize| self.a[(i, j)];
                let (mean, half) = (0.5 * (at(x, x) + at(v, v)), 0.5 * (at(x, x) - at(v, v)));
                let root = c64::new(half * half + at(x, v) * at(v, x), 0.0).sqrt();
                poles.extend([root, -root].map(|root| root + mean));
                continue;
            }
            let own = Mat::from_fn(size, size, |i, j| self.a[(group[i], group[j])]);
            poles.extend(balanced(own).eigenvalues().map_err(|_| LinearError::Eigen { size })?);
        }
        poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im)));
        Ok(poles)
    }

    /// The outputs (p) in the complex mode of a pole s: C v with (A − s) v = 0, by inverse iteration. Of poles that are one it is one of their
    /// modes. Their scale is any.
    pub fn complex_mode(&self, pole: c64) -> Vec<c64> {
        let n = self.a.nrows();
        let fastest = self.a.norm_max();
        let shift = pole + BESIDE * if pole.norm() > 0.0 { pole.norm() } else { fastest };
        let shifted = Mat::from_fn(n, n, |i, j| c64::new(self.a[(i, j)], 0.0) - if i == j { shift } else { c64::ZERO });
        let factor = shifted.partial_piv_lu();
        // No mode is at right angles to all of these.
        let mut v = Mat::from_fn(n, 1, |i, _| c64::new(1.0, (1.0 + i as f64).sin()));
        for _ in 0..ITERATIONS {
            v = factor.solve(&v);
            let size = v.norm_max();
            v = Mat::from_fn(n, 1, |i, _| v[(i, 0)] / size);
        }
        (0..self.c.nrows()).map(|i| (0..n).map(|j| v[(j, 0)] * self.c[(i, j)]).sum()).collect()
    }

    /// States that A couples, directly or by others.
    fn groups(&self) -> Vec<Vec<usize>> {
        let n = self.a.nrows();
        let mut is_free = vec![true; n];
        let mut groups = Vec::new();
        for first in 0..n {
            if !std::mem::take(&mut is_free[first]) {
                continue;
            }
            let (mut group, mut next) = (vec![first], 0);
            while next < group.len() {
                let at = group[next];
                next += 1;
                for (other, is_free) in is_free.iter_mut().enumerate() {
                    let is_coupled = self.a[(at, other)] != 0.0 || self.a[(other, at)] != 0.0;
                    if is_coupled && std::mem::take(is_free) {
                        group.push(other);
                    }
                }
            }
            groups.push(group);
        }
        groups
    }

    /// C (iω − A)⁻¹ B + D (p×m) at a circular frequency, rad per time.
    ///
    /// # Errors
    /// [`LinearError::Resonance`] where it has none.
    pub fn response(&self, circular_frequency: f64) -> Result<Mat<c64>, LinearError> {
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

/// A real matrix as a complex one.
pub(crate) fn complex(matrix: &Mat<f64>) -> Mat<c64> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| c64::new(matrix[(i, j)], 0.0))
}
