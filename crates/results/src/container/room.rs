//! How much a results file has room for.

/// Sizes that a store is made for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    /// Rows.
    pub rows: usize,
    /// Words of a checkpoint; none in a finished file.
    pub checkpoint_words: Option<usize>,
}
