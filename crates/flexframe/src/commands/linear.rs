//! Linear answers: state spaces, frequency responses, shock response spectra.

pub mod frequencies;
pub mod frf;
pub mod linearize;
pub mod srs;
