//! Loads, and how they and motions go with time.

pub(crate) mod history;
pub(crate) mod load;
pub(crate) mod unit_vector;
