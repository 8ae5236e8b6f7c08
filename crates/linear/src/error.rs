//! Errors of linear models.

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// A linear model that has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// A matrix of another size than the others ask for.
    #[error("{what}: found {found:?}, expected {expected:?} rows and columns")]
    Size {
        /// The matrix.
        what: &'static str,
        /// Its rows and columns.
        found: [usize; 2],
        /// The expected ones.
        expected: [usize; 2],
    },
    /// A number that is not finite, or out of range.
    #[error("{what}: found {found}, expected {expected}")]
    Value {
        /// The number.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The expected ones.
        expected: &'static str,
    },
    /// The order of a reduced model is out of range.
    #[error(
        "order {found}: expected {least} to {most}, from the states that do not decay to the order of the model that is reduced, and no \
         conjugate pair split"
    )]
    Order {
        /// It.
        found: usize,
        /// The smallest.
        least: usize,
        /// The largest.
        most: usize,
    },
    /// A motion that goes on or grows under random inputs.
    #[error(
        "a pole {real:.3e} ± {imaginary:.6e} i per time does not decay, so that the response to random inputs has no mean square; \
         expected damping of all modes (`damping_ratio` in `[modes]`), a band above 0 where motions are rigid, and no motion that grows"
    )]
    NotStable {
        /// Growth of the pole.
        real: f64,
        /// Its circular frequency.
        imaginary: f64,
    },
    /// Inputs and outputs that no state connects.
    #[error(
        "nothing connects inputs and outputs: found Hankel values of zero, expected an output that sees what an input does"
    )]
    Unconnected,
    /// A response at a frequency where there is none.
    #[error(
        "no response at {frequency} cycles per time: an undamped vibration or a rigid motion is there; expected damping, or frequencies \
         beside it"
    )]
    Resonance {
        /// The frequency.
        frequency: f64,
    },
    /// Spectra of inputs that are none.
    #[error("the spectrum of the inputs at {frequency} cycles per time is {found}; expected {expected}")]
    Spectrum {
        /// The frequency.
        frequency: f64,
        /// The fault.
        found: String,
        /// The expected spectrum.
        expected: &'static str,
    },
    /// An eigenvalue problem that the linear algebra could not solve.
    #[error("the eigenvalues of a matrix of size {size} did not converge")]
    Eigen {
        /// Its size.
        size: usize,
    },
}

impl Diagnostic for LinearError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Refused.alone()
    }
}
