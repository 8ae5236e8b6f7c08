//! Responses to stationary random inputs, Eq. (F6): S_y = H S_u Hᴴ.

use std::f64::consts::TAU;

use faer::{Mat, Side, c64};

use crate::error::LinearError;
use crate::frequency_response::FrequencyResponse;

/// A part of the trace by which rounding may make a matrix of densities negative.
const ROUNDING: f64 = 1e-10;

/// One-sided power spectral densities of the inputs at the frequencies of a response, unit² per cycle per time.
#[derive(Debug, Clone)]
pub enum RandomInput {
    /// Densities of inputs that are not correlated: one for each input, at each frequency.
    Independent(Vec<Vec<f64>>),
    /// The Hermitian matrix (m×m) of each frequency.
    Correlated(Vec<Mat<c64>>),
}

/// The response of one output.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomResponse {
    /// One-sided power spectral density at each frequency.
    pub density: Vec<f64>,
    /// Root of its integral.
    pub rms: f64,
    /// Root of the integral of the rate.
    pub rate_rms: f64,
}

impl RandomResponse {
    /// Upward crossings of a level per time, by Rice, Eq. (F7): ν = σ'/(2πσ) exp(−level²/2σ²). Of the level 0 it is the apparent frequency.
    pub fn crossings(&self, level: f64) -> f64 {
        let Self { rms, rate_rms, .. } = *self;
        if rms > 0.0 { rate_rms / (TAU * rms) * (-0.5 * (level / rms).powi(2)).exp() } else { 0.0 }
    }
}

impl FrequencyResponse {
    /// The responses of all outputs to random inputs, with the weights of an integral over the frequencies
    /// ([`Quadrature`](crate::Quadrature)).
    ///
    /// # Errors
    /// [`LinearError::Spectrum`] for densities that are negative or of other sizes, [`LinearError::Size`].
    pub fn random(&self, input: &RandomInput, weights: &[f64]) -> Result<Vec<RandomResponse>, LinearError> {
        let outputs = self.values.first().map_or(0, Mat::nrows);
        let forms: Vec<Vec<(usize, usize, f64)>> = (0..outputs).map(|i| vec![(i, i, 1.0)]).collect();
        self.quadratic(input, weights, &forms)
    }

    /// The equivalent stress of six outputs, the components xx, yy, zz, xy, yz, xz of one place: the quadratic form σᵀ Q σ of von Mises,
    /// Eq. (F8), by Segalman, Fulcher, Reese and Field (1998). Its density is that of the form's mean square.
    ///
    /// # Errors
    /// As [`Self::random`].
    pub fn random_von_mises(
        &self,
        stress: [usize; 6],
        input: &RandomInput,
        weights: &[f64],
    ) -> Result<RandomResponse, LinearError> {
        let mut form = Vec::new();
        for i in 0..3 {
            form.extend([(i, i, 1.0), (i, (i + 1) % 3, -1.0), (3 + i, 3 + i, 3.0)]);
        }
        let form = form.into_iter().map(|(i, j, factor)| (stress[i], stress[j], factor)).collect();
        let mut found = self.quadratic(input, weights, &[form])?;
        Ok(found.remove(0))
    }

    /// Mean squares Σ factor·E[y_i y_j] of some forms, each a list of i, j and factor.
    fn quadratic(
        &self,
        input: &RandomInput,
        weights: &[f64],
        forms: &[Vec<(usize, usize, f64)>],
    ) -> Result<Vec<RandomResponse>, LinearError> {
        let size = match input {
            RandomInput::Independent(lists) => lists.len(),
            RandomInput::Correlated(matrices) => matrices.len(),
        };
        for (what, found) in [("the spectra of the inputs", size), ("the weights of the frequencies", weights.len())] {
            if found != self.frequencies.len() {
                return Err(LinearError::Size { what, found: [found, 1], expected: [self.frequencies.len(), 1] });
            }
        }
        let mut densities = vec![Vec::with_capacity(size); forms.len()];
        for (k, h) in self.values.iter().enumerate() {
            let by_input = h * self.density(input, k, h.ncols())?;
            let cross =
                |i: usize, j: usize| (0..h.ncols()).map(|m| (by_input[(i, m)] * h[(j, m)].conj()).re).sum::<f64>();
            for (list, form) in densities.iter_mut().zip(forms) {
                list.push(form.iter().map(|(i, j, factor)| factor * cross(*i, *j)).sum::<f64>().max(0.0));
            }
        }
        let integral = |density: &[f64], factor: &dyn Fn(f64) -> f64| {
            let terms = density.iter().zip(weights).zip(&self.frequencies);
            terms.map(|((s, weight), f)| s * weight * factor(*f)).sum::<f64>().max(0.0).sqrt()
        };
        let response = |density: Vec<f64>| RandomResponse {
            rms: integral(&density, &|_| 1.0),
            rate_rms: integral(&density, &|f| (TAU * f).powi(2)),
            density,
        };
        Ok(densities.into_iter().map(response).collect())
    }

    fn density(&self, input: &RandomInput, k: usize, inputs: usize) -> Result<Mat<c64>, LinearError> {
        let frequency = self.frequencies[k];
        let refuse = |found: String, expected| Err(LinearError::Spectrum { frequency, found, expected });
        let (matrix, is_diagonal) = match input {
            RandomInput::Independent(lists) => {
                let list = &lists[k];
                let own = |i: usize, j: usize| c64::new(if i == j { list[i] } else { 0.0 }, 0.0);
                (Mat::from_fn(list.len(), list.len(), own), true)
            }
            RandomInput::Correlated(matrices) => (matrices[k].clone(), false),
        };
        if matrix.nrows() != inputs || matrix.ncols() != inputs {
            return refuse(format!("of {} inputs", matrix.nrows()), "one for each input of the response");
        }
        for i in 0..inputs {
            let own = matrix[(i, i)];
            if !(own.re >= 0.0 && own.re.is_finite() && own.im == 0.0) {
                return refuse(format!("{}", own.re), "a density that is not negative");
            }
            for j in 0..i {
                let (one, other) = (matrix[(i, j)], matrix[(j, i)].conj());
                let most = (own.re * matrix[(j, j)].re).sqrt();
                if !((one - other).norm() <= 1e-12 * most && one.norm() <= (1.0 + 1e-12) * most) {
                    return refuse(
                        format!("{one} between two inputs"),
                        "a Hermitian matrix whose coherence is at most 1",
                    );
                }
            }
        }
        if !is_diagonal && inputs > 2 {
            let trace: f64 = (0..inputs).map(|i| matrix[(i, i)].re).sum();
            let failed = LinearError::Eigen { size: inputs };
            let least = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|_| failed)?[0];
            if least < -ROUNDING * trace {
                return refuse(
                    format!("one of eigenvalue {least:.3e}"),
                    "coherences and phases that inputs can have together: no eigenvalue below 0",
                );
            }
        }
        Ok(matrix)
    }
}
