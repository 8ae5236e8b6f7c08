//! Files for ParaView.

pub(crate) mod fields;
pub(crate) mod vtkhdf;
pub(crate) mod vtu;
