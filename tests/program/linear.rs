//! Linear answers: state spaces and responses, Campbell diagrams, rates and fits, bodies for other programs.

pub(crate) mod campbell;
pub(crate) mod fit;
pub(crate) mod frequency;
pub(crate) mod gradient;
pub(crate) mod hand_over;
pub(crate) mod rotors;
pub(crate) mod srs;
