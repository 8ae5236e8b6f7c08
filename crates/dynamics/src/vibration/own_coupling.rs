//! Coupling of modes of like frequency, by the spin and by the stress of loads.

use faer::Mat;

use crate::history::History;

/// Frequencies that differ by less than this part are alike.
const ALIKE: f64 = 0.2;

/// The largest entries of the N_ij and of the G_i, by which each mode is coupled to itself and to modes of like frequency.
/// The modes are the first rows and columns of each.
pub(crate) fn own_coupling(circular_frequencies: &[f64], matrices: [&[Mat<f64>]; 2]) -> Vec<[f64; 2]> {
    let coupled = |k: usize, matrices: &[Mat<f64>]| {
        largest_alike(circular_frequencies, k, |l| {
            matrices.iter().map(|matrix| matrix[(k, l)].abs()).fold(0.0, f64::max)
        })
    };
    (0..circular_frequencies.len()).map(|k| matrices.map(|matrices| coupled(k, matrices))).collect()
}

/// The largest `entry` of a row k at k itself and at modes of like frequency.
pub(crate) fn largest_alike(circular_frequencies: &[f64], k: usize, entry: impl Fn(usize) -> f64) -> f64 {
    let a = circular_frequencies[k];
    let alike = circular_frequencies.iter().enumerate().filter(|(_, b)| (a - **b).abs() <= ALIKE * a);
    alike.map(|(l, _)| entry(l)).fold(0.0, f64::max)
}

/// The stress of a load couples each mode to itself and to modes of like frequency.
#[derive(Debug, Clone)]
pub(crate) struct LoadCoupling {
    history: History,
    /// Largest stiffness for each mode where the history is 1 (nf).
    of_modes: Vec<f64>,
}

impl LoadCoupling {
    /// With the largest stiffness for each mode where the history is 1 (nf).
    pub(crate) fn new(history: History, of_modes: Vec<f64>) -> Self {
        Self { history, of_modes }
    }

    /// Largest stiffness by which a mode is coupled at a time.
    pub(crate) fn stiffness(&self, mode: usize, time: f64) -> f64 {
        self.history.at(time, time).abs() * self.of_modes[mode]
    }
}
