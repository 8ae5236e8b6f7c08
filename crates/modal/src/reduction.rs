//! The reduced body, constants of its motion.

pub(crate) mod body;
pub(crate) mod fields;
pub(crate) mod general;
pub(crate) mod inertia_products;
pub(crate) mod nodal;
pub(crate) mod parts;
pub(crate) mod turned;
