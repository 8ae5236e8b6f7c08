//! Elements of a file that are no tetrahedra.

/// gmsh's type of the triangles of second order.
pub(super) const TRI6: i32 = 9;

/// Points, lines or triangles of one entity.
pub(super) struct Block {
    pub dimension: usize,
    pub entity: i32,
    /// gmsh's element type.
    pub kind: i32,
    pub tags: Vec<u64>,
    /// Tags of the nodes, element after element.
    pub nodes: Vec<u64>,
}
