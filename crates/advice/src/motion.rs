//! Bounds of the motion, from what excites it.

pub(crate) mod case;
pub(crate) mod course;
pub(crate) mod excitation;
pub(crate) mod response;
pub(crate) mod rigid;
pub(crate) mod source;
pub(crate) mod tensor;
pub(crate) mod turning;
