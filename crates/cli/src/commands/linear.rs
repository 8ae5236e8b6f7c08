//! Linear models and what follows from them.

pub mod fit;
pub mod frf;
pub mod gradient;
pub mod linearize;
pub mod psd;
pub mod shock;
pub mod srs;
