//! The file that grows with a run: its layout, its seal, its lock.

pub(crate) mod description;
pub(crate) mod lock;
pub(crate) mod paths;
pub(crate) mod room;
pub(crate) mod seal;
pub(crate) mod store;
pub(crate) mod structure;
