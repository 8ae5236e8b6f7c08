//! How the reduction of a body goes through its nodes, and what it holds beside the modes.

use crate::matrix::products::WIDTH;

/// Columns beside those of the modes: X and 1.
pub(crate) const GEOMETRY: usize = 2;
/// Nodes that are worked on together: so few that all their rows stay in the processor's cache.
pub(crate) const NODES: usize = 512;
/// Such pieces of a task, whose products are added up one after the other.
pub(crate) const PIECES: usize = 16;

/// Vectors that a reduction to `flexible` shapes holds where the mass is one over nodes: X and 1, products of all columns with
/// M, and a packed block.
pub(crate) fn nodal_vectors(flexible: usize) -> usize {
    6 + flexible + 2 * GEOMETRY + WIDTH
}

/// The same where the mass is a general one: all columns, the shapes turned about three axes, products of both with M, and the rows
/// of the columns and their products by axes.
pub(crate) fn general_vectors(flexible: usize) -> usize {
    10 * flexible + 36 + WIDTH
}

/// Bytes of the products of `flexible` shapes while they are added up.
pub(crate) fn products_bytes(nodes: usize, flexible: usize) -> usize {
    let columns = 6 + flexible + GEOMETRY;
    // Each of six products once for each task, their sum, and the transposes.
    8 * columns * columns * (6 * nodes.div_ceil(NODES * PIECES) + 9)
}
