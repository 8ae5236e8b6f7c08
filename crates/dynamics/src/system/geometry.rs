//! The geometry of joints alone, without masses: which rows others imply, and where the joints close.

pub(crate) mod closing;
pub(crate) mod loops;
pub(crate) mod posture;
pub(crate) mod rank;
pub(crate) mod tree;
