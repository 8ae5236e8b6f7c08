//! Frequency responses, Eq. (F4), at a cost that goes with the number of modes.

use std::f64::consts::TAU;

use faer::{Mat, c64};
use rayon::prelude::*;

use crate::error::LinearError;
use crate::modal_form::Coupled;
use crate::rows::Rows;
use crate::second_order::{Damping, SecondOrder};
use crate::values::Values;

/// Responses of all outputs to unit inputs at some frequencies.
#[derive(Debug, Clone)]
pub struct FrequencyResponse {
    /// Frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// A matrix (p×m) for each.
    pub values: Vec<Mat<c64>>,
}

impl SecondOrder {
    /// The responses at frequencies ≥ 0, cycles per time. Each mode costs a division at each frequency; coordinates that nothing
    /// couples to others are modes, of others the complex modes are found once. Where these are too near to each other to be told
    /// apart, their dynamic stiffness is factored at each frequency.
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
        let together = self.together(damping);
        let alone: Vec<usize> = (0..self.size()).filter(|k| !together.contains(k)).collect();
        let rows = Rows::new(self);
        let coupled = Coupled::new(self, &rows, together, damping);
        let values = frequencies.par_iter().map(|frequency| {
            let omega = TAU * frequency;
            let mut values = Values::new(&rows, self.inputs.len());
            for k in &alone {
                let z = self.dynamic_stiffness([*k; 2], omega, damping);
                values.add_coordinate(&rows, *k, omega, |j| {
                    // Nothing moves what has no force on it, not even at its resonance.
                    let force = self.forces[(*k, j)];
                    if force == 0.0 { c64::new(0.0, 0.0) } else { c64::new(force, 0.0) / z }
                });
            }
            coupled.add_to(self, &rows, omega, &mut values);
            values.finished(&rows, *frequency)
        });
        Ok(FrequencyResponse { frequencies: frequencies.to_vec(), values: values.collect::<Result<_, _>>()? })
    }

    /// Coordinates that stiffness or damping couples to others.
    fn together(&self, damping: Damping) -> Vec<usize> {
        let n = self.size();
        let damps = damping == Damping::OfEquations;
        let is_coupled = |i: usize, j: usize| self.stiffness[(i, j)] != 0.0 || (damps && self.damping[(i, j)] != 0.0);
        (0..n).filter(|i| (0..n).any(|j| *i != j && (is_coupled(*i, j) || is_coupled(j, *i)))).collect()
    }
}
