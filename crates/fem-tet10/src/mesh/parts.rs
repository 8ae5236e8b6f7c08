//! The raw parts of a mesh.

/// The raw parts of a mesh, from a file or from a program; [`Mesh::new`](crate::Mesh::new) checks them.
#[derive(Debug, Clone, Default)]
pub struct MeshParts {
    /// Name of the mesh in messages: the file's path.
    pub source: String,
    /// Tags of the nodes, in the file's numbering.
    pub node_tags: Vec<u64>,
    /// Positions of the nodes (n×3).
    pub positions: Vec<[f64; 3]>,
    /// Tags of the elements, in the file's numbering.
    pub element_tags: Vec<u64>,
    /// Node *tags* of each element, in gmsh's order: corners, then mid-edges 01 12 02 03 23 13.
    pub elements: Vec<[u64; 10]>,
    /// Names of the volume physical groups.
    pub groups: Vec<String>,
    /// The regions of the body (gmsh's volume entities): for each, the indices of the groups it is in.
    pub regions: Vec<Vec<usize>>,
    /// For each element, the index of its region.
    pub element_regions: Vec<usize>,
    /// The surface physical groups.
    pub surfaces: Vec<SurfaceGroup>,
    /// The physical groups of curves and points.
    pub node_groups: Vec<NodeGroup>,
}

/// A physical group of surfaces, among the parts of a mesh.
#[derive(Debug, Clone, Default)]
pub struct SurfaceGroup {
    /// Its name.
    pub name: String,
    /// Tags of its triangles, in the file's numbering.
    pub triangle_tags: Vec<u64>,
    /// Node *tags* of each triangle, in gmsh's order: corners, either way round, then mid-edges 01 12 20.
    pub triangles: Vec<[u64; 6]>,
}

/// A physical group of curves or points, among the parts of a mesh.
#[derive(Debug, Clone)]
pub struct NodeGroup {
    /// Its name.
    pub name: String,
    /// 0 for points, 1 for curves.
    pub dimension: usize,
    /// Tags of the nodes of its elements, in any order, each as often as it comes.
    pub nodes: Vec<u64>,
}
