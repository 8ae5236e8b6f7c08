//! Linear answers: state spaces, frequency responses, random responses, shock response spectra; rates and fits.

pub mod fit;
pub mod frequencies;
pub mod frf;
pub mod gradient;
pub mod linearize;
mod names;
pub mod psd;
pub mod shock;
pub mod spectra;
pub mod srs;
mod table;
