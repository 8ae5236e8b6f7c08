//! The file that grows with a run: its layout and its lock.

pub(crate) mod lock;
pub(crate) mod paths;
pub(crate) mod store;
pub(crate) mod structure;
