//! The stiffness in the modes by the stress of the spin.
//!
//! Where the static answer to the spin bends the body, as about a pin beside the axis of a bar, its initial displacement
//! couples bending to stretching. The stretching modes then relieve the bending ones by an energy of second order in that
//! answer. In the exact nonlinear body terms of fourth order balance it, and here they are missing. Where the initial
//! displacement couples modes strongly whose frequencies are far apart, so that one follows the other as a static answer
//! does, only the initial stress is taken: what is left out there but for this relief is of second order in the answer, too.

use faer::Mat;

/// Modes are far apart where their frequencies differ by more than this factor.
const APART: f64 = 4.0;
/// They are coupled strongly where the initial displacement of a spin at the lowest frequency has more than this part of
/// √(λ_k λ_l). Between the bending modes of a straight bar, which the spin only stretches, it has far less; between the
/// bending and the stretching of one that is pinned at a corner up to 60.
const STRONG: f64 = 0.01;

/// The stiffness by the static answers to the spin, of each pair of axes.
pub(super) struct SpinStress {
    /// By all terms.
    all: Vec<Mat<f64>>,
    /// By the initial stress alone.
    initial: Vec<Mat<f64>>,
    /// λ of the modes.
    eigenvalues: Vec<f64>,
}

impl SpinStress {
    /// In modes with these eigenvalues, by all terms and by the initial stress.
    pub fn new([all, initial]: [Vec<Mat<f64>>; 2], eigenvalues: &[f64]) -> Self {
        Self { all, initial, eigenvalues: eigenvalues.to_vec() }
    }

    /// By all terms and by the initial stress, in the first of the modes.
    pub fn of_first(&self, modes: usize) -> [Vec<Mat<f64>>; 2] {
        [&self.all, &self.initial].map(|k| k.iter().map(|k| k.get(..modes, ..modes).to_owned()).collect())
    }

    /// K_ij of each pair.
    pub fn stiffness(&self) -> Vec<Mat<f64>> {
        (0..self.all.len()).map(|pair| self.settled(pair, &self.all[pair], &self.initial[pair])).collect()
    }

    /// Another stiffness by all terms and by the initial stress: of each, where K of a pair is of it.
    pub fn settled(&self, pair: usize, all: &Mat<f64>, initial: &Mat<f64>) -> Mat<f64> {
        let lowest = self.eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        let change = |a: usize, b: usize| (self.all[pair][(a, b)] - self.initial[pair][(a, b)]).abs();
        Mat::from_fn(all.nrows(), all.ncols(), |a, b| {
            let [x, y] = [self.eigenvalues[a], self.eigenvalues[b]];
            let are_apart = x.max(y) > APART * APART * x.min(y);
            let is_strong = lowest * change(a, b) > STRONG * (x * y).sqrt();
            if are_apart && is_strong { initial[(a, b)] } else { all[(a, b)] }
        })
    }
}
