//! Errors of linear models.

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
    #[error("order {found}: expected 1 to {most}, the order of the model that is reduced")]
    Order {
        /// It.
        found: usize,
        /// The largest.
        most: usize,
    },
    /// Balanced truncation of a model that does not decay.
    #[error(
        "a pole {real:.3e} ± {imaginary:.6e} i per time does not decay, so no order can be balanced; expected damping of all modes, \
         and rigid motions taken out (without rigid motions, `damping_ratio` in `[modes]`)"
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
