//! How the reduction of a body goes through its nodes, and the memory of its sums.

/// Columns beside those of the modes: X and 1.
pub(crate) const GEOMETRY: usize = 2;
/// Nodes that are worked on together: so few that all their rows stay in the processor's cache.
pub(crate) const NODES: usize = 512;
/// Such pieces of a task, whose products are added up one after the other.
pub(crate) const PIECES: usize = 16;

/// Bytes of the products of so many flexible shapes while they are added up.
pub(crate) fn products_bytes(nodes: usize, flexible: usize) -> usize {
    let columns = 6 + flexible + GEOMETRY;
    // Each of six products once for each task, their sum, and the transposes.
    8 * columns * columns * (6 * nodes.div_ceil(NODES * PIECES) + 9)
}
