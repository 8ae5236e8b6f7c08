//! Responses to stationary random inputs: S_y = H S_u Hᴴ.

use std::f64::consts::TAU;

use faer::{Mat, c64};

use crate::error::LinearError;
use crate::frequency_response::FrequencyResponse;

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
    /// Upward crossings of a level per time, by Rice: ν = σ'/(2πσ) exp(−level²/2σ²).
    pub fn crossings(&self, level: f64) -> f64 {
        let Self { rms, rate_rms, .. } = *self;
        if rms > 0.0 { rate_rms / (TAU * rms) * (-0.5 * (level / rms).powi(2)).exp() } else { 0.0 }
    }
}

impl FrequencyResponse {
    /// The responses of all outputs to random inputs; integrals by the trapezoidal rule over the frequencies.
    ///
    /// # Errors
    /// [`LinearError::Spectrum`] for densities that are negative or of other sizes.
    pub fn random(&self, input: &RandomInput) -> Result<Vec<RandomResponse>, LinearError> {
        let cross = self.cross_densities(input)?;
        let outputs = self.values.first().map_or(0, Mat::nrows);
        let of_output = |i: usize| {
            let density: Vec<f64> = cross.iter().map(|s| s[(i, i)].re).collect();
            let of_rate: Vec<f64> = density.iter().zip(&self.frequencies).map(|(s, f)| s * (TAU * f).powi(2)).collect();
            let [rms, rate_rms] = [&density, &of_rate].map(|list| self.integral(list).max(0.0).sqrt());
            RandomResponse { density, rms, rate_rms }
        };
        Ok((0..outputs).map(of_output).collect())
    }

    /// The root mean square of the equivalent stress of six outputs, the components xx, yy, zz, xy, yz, xz of one place: the
    /// quadratic form sᵀ Q s of von Mises, by Segalman, Fulcher, Reese and Field (1998).
    ///
    /// # Errors
    /// As [`Self::random`].
    pub fn random_von_mises(&self, stress: [usize; 6], input: &RandomInput) -> Result<f64, LinearError> {
        let cross = self.cross_densities(input)?;
        let density: Vec<f64> = cross
            .iter()
            .map(|s| {
                let at = |i: usize, j: usize| s[(stress[i], stress[j])].re;
                let normal = (0..3).map(|i| at(i, i)).sum::<f64>() - at(0, 1) - at(1, 2) - at(0, 2);
                normal + 3.0 * (3..6).map(|i| at(i, i)).sum::<f64>()
            })
            .collect();
        Ok(self.integral(&density).max(0.0).sqrt())
    }

    /// S_y (p×p) at each frequency.
    fn cross_densities(&self, input: &RandomInput) -> Result<Vec<Mat<c64>>, LinearError> {
        let size = match input {
            RandomInput::Independent(lists) => lists.len(),
            RandomInput::Correlated(matrices) => matrices.len(),
        };
        if size != self.frequencies.len() {
            let (found, expected) = ([size, 1], [self.frequencies.len(), 1]);
            return Err(LinearError::Size { what: "the spectra of the inputs", found, expected });
        }
        self.values.iter().enumerate().map(|(k, h)| Ok(h * self.density(input, k, h.ncols())? * h.adjoint())).collect()
    }

    fn density(&self, input: &RandomInput, k: usize, inputs: usize) -> Result<Mat<c64>, LinearError> {
        let frequency = self.frequencies[k];
        let refuse = |found: String, expected| Err(LinearError::Spectrum { frequency, found, expected });
        let matrix = match input {
            RandomInput::Independent(lists) => {
                let list = &lists[k];
                Mat::from_fn(list.len(), list.len(), |i, j| c64::new(if i == j { list[i] } else { 0.0 }, 0.0))
            }
            RandomInput::Correlated(matrices) => matrices[k].clone(),
        };
        if matrix.nrows() != inputs || matrix.ncols() != inputs {
            return refuse(format!("of {} inputs", matrix.nrows()), "one for each input of the response");
        }
        for i in 0..inputs {
            let own = matrix[(i, i)];
            if !(own.re >= 0.0 && own.re.is_finite() && own.im == 0.0) {
                return refuse(format!("{own}"), "a density that is not negative");
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
        Ok(matrix)
    }

    fn integral(&self, density: &[f64]) -> f64 {
        let steps = self.frequencies.windows(2).zip(density.windows(2));
        steps.map(|(f, s)| 0.5 * (f[1] - f[0]) * (s[0] + s[1])).sum()
    }
}
