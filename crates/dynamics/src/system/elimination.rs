//! The structured Newton system: bodies by 3×3 matrices, then the rows of the joints.

pub(crate) mod bent;
pub(crate) mod inverse;
pub(crate) mod joint_matrix;
pub(crate) mod matrices;
pub(crate) mod newton;
pub(crate) mod number;
pub(crate) mod patterns;
pub(crate) mod tension;
