//! Errors of shock response spectra.

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// A spectrum or a sum that has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShockError {
    /// A base motion with too few rows, or lists of other lengths.
    #[error(
        "the base motion has {times} times and {accelerations} accelerations; expected as many of both, two or more"
    )]
    Rows {
        /// Its times.
        times: usize,
        /// Its accelerations.
        accelerations: usize,
    },
    /// Rates of cubics, not one for each row.
    #[error("the base motion has {times} times and {rates} rates; expected as many of both")]
    Rates {
        /// Its times.
        times: usize,
        /// Its rates.
        rates: usize,
    },
    /// A number that is not finite or out of range.
    #[error("{what} in row {row}: found {found}, expected {expected}")]
    Row {
        /// The number.
        what: &'static str,
        /// Its row, from 1.
        row: usize,
        /// Its value.
        found: f64,
        /// The expected ones.
        expected: &'static str,
    },
    /// A number that is not finite or out of range.
    #[error("{what}: found {found}, expected {expected}")]
    Value {
        /// The number.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The expected ones.
        expected: &'static str,
    },
    /// A frequency that swings too often in a base motion.
    #[error(
        "frequency {frequency}: found {cycles:.3e} cycles in the base motion, expected at most {most:.0e}\n = cut the base motion \
         or end the spectrum lower"
    )]
    Cycles {
        /// The frequency, cycles per time.
        frequency: f64,
        /// Cycles in the base motion.
        cycles: f64,
        /// Most of them.
        most: f64,
    },
    /// A frequency outside of a spectrum.
    #[error(
        "frequency {frequency}: found a spectrum from {from} to {to} cycles per time, which does not cover it\n = make the spectrum \
         over all modes, or keep fewer of them"
    )]
    NotCovered {
        /// The frequency, cycles per time.
        frequency: f64,
        /// First frequency of the spectrum.
        from: f64,
        /// Last frequency of the spectrum.
        to: f64,
    },
}

impl Diagnostic for ShockError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Rows { .. } | Self::Rates { .. } | Self::Row { .. } => Kind::Input.alone(),
            Self::Value { .. } | Self::Cycles { .. } | Self::NotCovered { .. } => Kind::Usage.alone(),
        }
    }
}
