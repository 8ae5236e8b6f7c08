//! The support of a body, and its rigid motions.

pub(crate) mod constraints;
pub(crate) mod held;
pub(crate) mod held_dofs;
pub(crate) mod held_problem;
pub(crate) mod rigid;
pub(crate) mod rigid_fields;
