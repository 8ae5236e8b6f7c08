//! The parts of a state space that decay, and those that do not: rigid motions, undamped vibrations, unstable motions.
//!
//! The projector on what does not decay is ½ (1 + sign(A + σ)), with σ just above rounding. Newton's iteration finds the sign, also where
//! poles are double, as those of a rigid motion, and have no eigenvectors of their own.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;

use crate::channel::Channel;
use crate::error::LinearError;
use crate::state_space::StateSpace;

/// A decay below this part of the fastest pole is none: the double pole of a rigid motion has the root of rounding.
const NONE: f64 = 1e-7;
/// Iterations for the sign of a matrix, and its change at which it is found.
const MOST: usize = 120;
const FOUND: f64 = 1e-12;

/// A state space in two parts, whose responses add. D is with the part that decays.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    pub lasting: StateSpace,
    pub decaying: StateSpace,
}

impl StateSpace {
    pub(crate) fn parts(&self) -> Result<Parts, LinearError> {
        let n = self.a.nrows();
        let scales = self.scales();
        let scaled = Mat::from_fn(n, n, |i, j| self.a[(i, j)] * scales[j] / scales[i]);
        let poles = Self { a: scaled.clone(), ..self.clone() }.poles()?;
        let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        let count = poles.iter().filter(|pole| pole.re >= -NONE * fastest).count();
        let no_d = || Mat::zeros(self.d.nrows(), self.d.ncols());
        let nothing = |d| self.in_states(&Mat::zeros(n, 0), &Mat::zeros(0, n), d);
        if count == 0 {
            return Ok(Parts { lasting: nothing(no_d()), decaying: self.clone() });
        }
        if count == n {
            return Ok(Parts { lasting: Self { d: no_d(), ..self.clone() }, decaying: nothing(self.d.clone()) });
        }
        // Halfway, by ratio, between rounding and the slowest decay.
        let slowest =
            poles.iter().map(|pole| -pole.re).filter(|decay| *decay > NONE * fastest).fold(f64::INFINITY, f64::min);
        let shift = (NONE * fastest * slowest).sqrt();
        let sign = sign(Mat::from_fn(n, n, |i, j| scaled[(i, j)] + if i == j { shift } else { 0.0 }))?;
        let projector =
            |part: f64| Mat::from_fn(n, n, |i, j| 0.5 * (part * sign[(i, j)] + if i == j { 1.0 } else { 0.0 }));
        let failed = LinearError::Eigen { size: n };
        let basis = |of: Mat<f64>, columns: usize| {
            let svd = of.svd().map_err(|_| failed.clone())?;
            Ok::<_, LinearError>(svd.U().get(.., ..columns).to_owned())
        };
        let (lasting, decaying) = (basis(projector(1.0), count)?, basis(projector(-1.0), n - count)?);
        let both = Mat::from_fn(n, n, |i, j| if j < count { lasting[(i, j)] } else { decaying[(i, j - count)] });
        let inverse = both.partial_piv_lu().inverse();
        let right = Mat::from_fn(n, n, |i, j| scales[i] * both[(i, j)]);
        let left = Mat::from_fn(n, n, |i, j| inverse[(i, j)] / scales[j]);
        let of = |range: std::ops::Range<usize>, d| {
            self.in_states(&right.get(.., range.clone()).to_owned(), &left.get(range, ..).to_owned(), d)
        };
        Ok(Parts { lasting: of(0..count, no_d()), decaying: of(count..n, self.d.clone()) })
    }

    /// With states x = right·z, z = left·x.
    pub(crate) fn in_states(&self, right: &Mat<f64>, left: &Mat<f64>, d: Mat<f64>) -> Self {
        Self {
            a: left * (&self.a * right),
            b: left * &self.b,
            c: &self.c * right,
            d,
            states: (1..=right.ncols()).map(|k| Channel::new(format!("z{k}"), "")).collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        }
    }

    /// Both parts side by side, their states named.
    pub(crate) fn beside(&self, other: &Self, name: &str) -> Self {
        let (n, m, p) = (self.a.nrows(), self.b.ncols(), self.c.nrows());
        let size = n + other.a.nrows();
        let at = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => self.a[(i, j)],
            (false, false) => other.a[(i - n, j - n)],
            _ => 0.0,
        };
        Self {
            a: Mat::from_fn(size, size, at),
            b: Mat::from_fn(size, m, |i, j| if i < n { self.b[(i, j)] } else { other.b[(i - n, j)] }),
            c: Mat::from_fn(p, size, |i, j| if j < n { self.c[(i, j)] } else { other.c[(i, j - n)] }),
            d: &self.d + &other.d,
            states: (1..=size)
                .map(|k| Channel::new(if k <= n { format!("lasting{k}") } else { format!("{name}{}", k - n) }, ""))
                .collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        }
    }

    /// Scales of the states in which rows and columns of A are of like size (Osborne 1960).
    fn scales(&self) -> Vec<f64> {
        let n = self.a.nrows();
        let mut scales = vec![1.0_f64; n];
        for _ in 0..20 {
            for k in 0..n {
                let others = || (0..n).filter(|i| *i != k);
                let row: f64 = others().map(|j| (self.a[(k, j)] * scales[j] / scales[k]).abs()).sum();
                let column: f64 = others().map(|i| (self.a[(i, k)] * scales[k] / scales[i]).abs()).sum();
                if row > 0.0 && column > 0.0 {
                    scales[k] *= (row / column).sqrt();
                }
            }
        }
        scales
    }
}

/// The sign of a matrix without eigenvalues on the imaginary axis: Newton's iteration, scaled by the determinant.
fn sign(mut x: Mat<f64>) -> Result<Mat<f64>, LinearError> {
    let n = x.nrows();
    for _ in 0..MOST {
        let lu = x.partial_piv_lu();
        let inverse = lu.inverse();
        let logarithm: f64 = (0..n).map(|k| lu.U()[(k, k)].abs().ln()).sum::<f64>() / n as f64;
        let scale = if (logarithm.abs()) < 0.1 { 1.0 } else { (-logarithm).exp() };
        let next = Mat::from_fn(n, n, |i, j| 0.5 * (scale * x[(i, j)] + inverse[(i, j)] / scale));
        let (change, size) = ((&next - &x).norm_l2(), next.norm_l2());
        x = next;
        if !size.is_finite() {
            break;
        }
        if change <= FOUND * size {
            return Ok(x);
        }
    }
    // Rounding may keep the last digits moving.
    let square = &x * &x;
    let missed = (&square - Mat::<f64>::identity(n, n)).norm_l2();
    if missed <= 1e-6 * x.norm_l2() * x.norm_l2() { Ok(x) } else { Err(LinearError::Eigen { size: n }) }
}
