//! Connections of bodies: markers, joints, springs, bushings and couplings, as they are written and as plain data.

pub(crate) mod joint;
pub(crate) mod marker;
pub(crate) mod section;
