//! A body reduced to modes, and how it begins.

pub(crate) mod center_of_mass;
pub(crate) mod components;
pub(crate) mod effect;
pub(crate) mod initial;
pub(crate) mod model;
pub(crate) mod motion_state;
pub(crate) mod patch_turn;
pub(crate) mod physics;
pub(crate) mod second_order;
pub(crate) mod shapes;
pub(crate) mod spin_stiffness;
