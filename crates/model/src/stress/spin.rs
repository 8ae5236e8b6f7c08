//! The stiffness in the modes by the stress of the spin.
//!
//! Where the static response to the spin bends the body, as about a pin beside the axis of a bar, its initial displacement
//! couples bending to stretching. The stretching modes then relieve the bending ones by an energy of second order in that
//! answer. In the exact nonlinear body terms of fourth order balance it, and here they are missing. Where the initial
//! displacement couples modes strongly whose frequencies are far apart, so that one follows the other as a static response
//! does, only the initial stress is taken: what is left out there but for this relief is of second order in the answer, too.

use faer::Mat;
use modal::ReducedBody;

/// Modes are far apart where their frequencies differ by more than this factor.
const APART: f64 = 4.0;
/// They are coupled strongly where the initial displacement of a spin at the lowest frequency has more than this part of
/// √(λ_k λ_l), whatever the axis. Between the bending modes of a straight bar, which the spin only stretches, it has far less;
/// between the bending and the stretching of one that is pinned at a corner up to 60.
const STRONG: f64 = 0.01;

/// The stiffness by the static responses to the spin, of each pair of axes as in [`ReducedBody::PAIRS`].
pub(crate) struct SpinStress {
    /// By all terms.
    all: [Mat<f64>; 6],
    /// By the initial stress alone.
    initial: [Mat<f64>; 6],
    /// Pairs of modes between which only the initial stress is taken (nf × nf).
    only_initial: Mat<bool>,
}

impl SpinStress {
    /// In modes with these eigenvalues, by all terms and by the initial stress.
    pub fn new([all, initial]: [[Mat<f64>; 6]; 2], eigenvalues: &[f64]) -> Self {
        let lowest = eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        // The norm of the tensor of the change, the same in any axes.
        let change = |a: usize, b: usize| {
            let square = |(pair, (i, j)): (usize, (usize, usize))| {
                (all[pair][(a, b)] - initial[pair][(a, b)]).powi(2) * if i == j { 1.0 } else { 2.0 }
            };
            ReducedBody::PAIRS.into_iter().enumerate().map(square).sum::<f64>().sqrt()
        };
        let only_initial = Mat::from_fn(eigenvalues.len(), eigenvalues.len(), |a, b| {
            let [x, y] = [eigenvalues[a], eigenvalues[b]];
            x.max(y) > APART * APART * x.min(y) && lowest * change(a, b) > STRONG * (x * y).sqrt()
        });
        Self { all, initial, only_initial }
    }

    /// By all terms and by the initial stress, in the first of the modes.
    pub fn of_first(&self, modes: usize) -> [Vec<Mat<f64>>; 2] {
        [&self.all, &self.initial].map(|k| k.iter().map(|k| k.get(..modes, ..modes).to_owned()).collect())
    }

    /// K_ij of each pair.
    pub fn stiffness(&self) -> [Mat<f64>; 6] {
        std::array::from_fn(|pair| self.settled(&self.all[pair], &self.initial[pair]))
    }

    /// Another stiffness by all terms and by the initial stress: of each, where K_ij is of it.
    pub fn settled(&self, all: &Mat<f64>, initial: &Mat<f64>) -> Mat<f64> {
        let entry = |a: usize, b: usize| if self.only_initial[(a, b)] { initial[(a, b)] } else { all[(a, b)] };
        Mat::from_fn(all.nrows(), all.ncols(), entry)
    }

    /// True if all terms are taken between all modes.
    pub fn is_by_all_terms(&self) -> bool {
        self.only_initial.col_iter().all(|column| !column.iter().any(|only| *only))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: the same verdict in turned axes.
    #[test]
    fn strong_coupling_is_the_same_in_any_axes() {
        // Just strong; each entry of the turned tensor would be too small by itself.
        let change = 1.2 * STRONG * 20.0;
        let of = |tensor: [f64; 6]| {
            let all = tensor.map(|k| Mat::from_fn(2, 2, |a, b| if a == b { 0.0 } else { k }));
            SpinStress::new([all, std::array::from_fn(|_| Mat::zeros(2, 2))], &[1.0, 400.0])
        };
        let turned = of([0.0, 0.5 * change, 0.5 * change, 0.5 * change, 0.0, 0.0]);
        for spin in [of([0.0, 0.0, change, 0.0, 0.0, 0.0]), turned] {
            assert!(!spin.is_by_all_terms());
            assert!(spin.stiffness().iter().all(|k| k.norm_max() == 0.0));
        }
        assert!(of([0.0, 0.0, change / 1.5, 0.0, 0.0, 0.0]).is_by_all_terms());
    }
}
