//! Linear answers: state spaces, frequency responses, random responses, shock response spectra.

mod curves;
pub mod frequencies;
pub mod frf;
pub mod linearize;
mod names;
pub mod psd;
pub mod shock;
pub mod spectra;
pub mod srs;
mod table;
