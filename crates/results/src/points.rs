//! The points of a results file.

/// The points of a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points {
    pub count: usize,
    /// Whether it has their stress.
    pub stress: bool,
}
