//! Files as other programs write them.

use std::fmt::Write;

use faer::sparse::SparseColMatRef;
use fem_tet10::Mesh;

/// As SciPy writes a matrix: one triangle, or both.
pub fn matrix_market(matrix: SparseColMatRef<'_, usize, f64>, symmetric: bool) -> String {
    let entries: Vec<_> = matrix.triplet_iter().filter(|entry| !symmetric || entry.row >= entry.col).collect();
    let kind = if symmetric { "symmetric" } else { "general" };
    let mut text = format!("%%MatrixMarket matrix coordinate real {kind}\n%\n");
    writeln!(text, "{} {} {}", matrix.nrows(), matrix.ncols(), entries.len()).unwrap();
    for entry in entries {
        writeln!(text, "{} {} {:.16e}", entry.row + 1, entry.col + 1, entry.val).unwrap();
    }
    text
}

/// As Abaqus writes it: one triangle, node and degree of freedom.
pub fn abaqus(matrix: SparseColMatRef<'_, usize, f64>, label: impl Fn(usize) -> u64) -> String {
    let mut text = "** MATRIX INPUT\n".to_owned();
    for entry in matrix.triplet_iter().filter(|entry| entry.row >= entry.col) {
        let place = |row: usize| format!("{},{}", label(row / 3), row % 3 + 1);
        writeln!(text, "{}, {},  {:.16e}", place(entry.row), place(entry.col), entry.val).unwrap();
    }
    text
}

/// A table of nodes with the groups of a mesh.
pub fn table(mesh: &Mesh) -> String {
    let mut text = "node,x,y,z,groups\n".to_owned();
    for (node, (label, [x, y, z])) in mesh.node_tags().iter().zip(mesh.positions()).enumerate() {
        let groups = mesh.groups_of_node(node as u32).join(" ");
        writeln!(text, "{label},{x:?},{y:?},{z:?},{groups}").unwrap();
    }
    text
}
