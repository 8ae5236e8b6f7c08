//! How a mesh is read.

/// How a mesh is read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ImportSettings {
    /// The largest size of an element where geometry is meshed, in the units of the file; the reader's choice if not given.
    pub mesh_size: Option<f64>,
    /// True if straight edges of first-order elements get a node in their middle.
    pub raise_order: bool,
    /// True if gmsh does all that geometry says. A `.geo` file is a program, which may run others; without this, one with such
    /// commands is refused. No scene file can set it.
    pub trust_geometry: bool,
    /// True if messages show no line of the file: another file has named it, which may come from elsewhere and name any file of the user's.
    pub hides_lines: bool,
}
