//! The stiffness in the modes by the stress of the spin.
//!
//! Where the static answer to the spin bends the body, as about a pin beside the axis of a bar, its initial displacement
//! couples bending to stretching. The stretching modes then relieve the bending ones by an energy of second order in that
//! answer. In the exact nonlinear body terms of fourth order balance it, and here they are missing. Between modes whose
//! frequencies are far apart, so that one follows the other as a static answer does, only the initial stress is taken: what
//! the initial displacement does there but for this relief is of second order in the answer, too.

use faer::Mat;

/// Modes are far apart where their frequencies differ by more than this factor.
const APART: f64 = 4.0;

/// The stiffness in modes with these eigenvalues, of those by all terms and by the initial stress.
pub(super) fn of_spin(all: &Mat<f64>, stress: &Mat<f64>, eigenvalues: &[f64]) -> Mat<f64> {
    Mat::from_fn(all.nrows(), all.ncols(), |a, b| {
        let [low, high] = [eigenvalues[a].min(eigenvalues[b]), eigenvalues[a].max(eigenvalues[b])];
        if high > APART * APART * low { stress[(a, b)] } else { all[(a, b)] }
    })
}
