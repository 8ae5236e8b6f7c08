//! Sparse matrices over nodes and dense ones over modes, and their products.

pub(crate) mod columns;
pub(crate) mod dense;
pub(crate) mod mass;
pub(crate) mod mass_matrix;
pub(crate) mod node_pairs;
pub(crate) mod packed_rows;
pub(crate) mod pattern;
pub(crate) mod products;
pub(crate) mod renumbering;
pub(crate) mod row_chunks;
pub(crate) mod stiffness;
pub(crate) mod symmetry;
pub(crate) mod tall;
pub(crate) mod tied_mass;
