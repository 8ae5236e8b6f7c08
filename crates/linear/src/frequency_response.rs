//! Frequency responses, Eq. (F4).

use std::f64::consts::TAU;

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use rayon::prelude::*;

use crate::error::LinearError;
use crate::second_order::{Rate, SecondOrder};

/// Damping of a frequency response beside that of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// The damping of the equations alone.
    OfEquations,
    /// Structural damping in the place of that of the equations: K (1 + i g) with a loss factor g.
    Structural(f64),
}

/// Responses of all outputs to unit inputs at some frequencies.
#[derive(Debug, Clone)]
pub struct FrequencyResponse {
    /// Frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// A matrix (p×m) for each.
    pub values: Vec<Mat<c64>>,
}

impl SecondOrder {
    /// The responses at frequencies ≥ 0, cycles per time. Coordinates that nothing couples to others cost a division each.
    ///
    /// # Errors
    /// [`LinearError::Resonance`] at a frequency of an undamped vibration or a rigid motion; as [`Self::check`].
    pub fn frequency_response(&self, frequencies: &[f64], damping: Damping) -> Result<FrequencyResponse, LinearError> {
        self.check()?;
        if let Some(found) = frequencies.iter().copied().find(|f| !(f.is_finite() && *f >= 0.0)) {
            return Err(LinearError::Value { what: "a frequency", found, expected: "a finite number, 0 or more" });
        }
        if let Damping::Structural(found) = damping
            && !(found.is_finite() && found >= 0.0)
        {
            return Err(LinearError::Value { what: "the loss factor", found, expected: "a finite number, 0 or more" });
        }
        let coupled = self.coupled(damping);
        let values = frequencies.par_iter().map(|frequency| self.response(*frequency, damping, &coupled));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        Ok(FrequencyResponse { frequencies: frequencies.to_vec(), values })
    }

    /// Coordinates that stiffness or damping couples to others.
    fn coupled(&self, damping: Damping) -> Vec<usize> {
        let n = self.size();
        let damps = damping == Damping::OfEquations;
        let is_coupled = |i: usize, j: usize| self.stiffness[(i, j)] != 0.0 || (damps && self.damping[(i, j)] != 0.0);
        (0..n).filter(|i| (0..n).any(|j| *i != j && (is_coupled(*i, j) || is_coupled(j, *i)))).collect()
    }

    /// The dynamic stiffness K − ω² + i ω C between two coordinates.
    fn dynamic_stiffness(&self, [i, j]: [usize; 2], omega: f64, damping: Damping) -> c64 {
        let own = if i == j { omega * omega } else { 0.0 };
        let stiffness = self.stiffness[(i, j)];
        match damping {
            Damping::OfEquations => c64::new(stiffness - own, omega * self.damping[(i, j)]),
            Damping::Structural(loss) => c64::new(stiffness - own, loss * stiffness),
        }
    }

    fn response(&self, frequency: f64, damping: Damping, coupled: &[usize]) -> Result<Mat<c64>, LinearError> {
        let omega = TAU * frequency;
        let (n, m) = (self.size(), self.inputs.len());
        let mut eta = Mat::<c64>::zeros(n, m);
        let mut is_coupled = vec![false; n];
        coupled.iter().for_each(|k| is_coupled[*k] = true);
        for k in (0..n).filter(|k| !is_coupled[*k]) {
            let z = self.dynamic_stiffness([k, k], omega, damping);
            for j in 0..m {
                // Nothing moves what has no force on it, not even at its resonance.
                let force = self.forces[(k, j)];
                eta[(k, j)] = if force == 0.0 { c64::new(0.0, 0.0) } else { c64::new(force, 0.0) / z };
            }
        }
        if !coupled.is_empty() {
            let c = coupled.len();
            let z = Mat::from_fn(c, c, |i, j| self.dynamic_stiffness([coupled[i], coupled[j]], omega, damping));
            let forces = Mat::from_fn(c, m, |i, j| c64::new(self.forces[(coupled[i], j)], 0.0));
            let solved = z.partial_piv_lu().solve(forces);
            (0..m).for_each(|j| coupled.iter().enumerate().for_each(|(i, k)| eta[(*k, j)] = solved[(i, j)]));
        }
        let values = Mat::from_fn(self.outputs.len(), m, |i, j| {
            let output = &self.outputs[i];
            let factor = match output.rate {
                Rate::Place => c64::new(1.0, 0.0),
                Rate::Velocity => c64::new(0.0, omega),
                Rate::Acceleration => c64::new(-omega * omega, 0.0),
            };
            let seen: c64 =
                output.row.iter().zip(eta.col(j).iter()).filter(|(r, _)| **r != 0.0).map(|(r, x)| *x * *r).sum();
            seen * factor
        });
        let is_finite = values.col_iter().all(|column| column.iter().all(|x| x.re.is_finite() && x.im.is_finite()));
        if is_finite { Ok(values) } else { Err(LinearError::Resonance { frequency }) }
    }
}
