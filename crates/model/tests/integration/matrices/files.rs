//! Files as other programs write them.

use std::fmt::Write;

use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use fem_tet10::Mesh;
use nalgebra::Vector3;

use super::Files;

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

/// The eight corners of a cube of 100, each with a mass of 1, and bars between all of them: K by one triangle, M by both.
pub fn cube() -> Files {
    let corners: Vec<Vector3<f64>> =
        (0..8_u32).map(|i| Vector3::from_fn(|axis, _| f64::from(i >> axis & 1) * 100.0)).collect();
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for a in 0..8 {
        for b in (0..8).filter(|b| *b != a) {
            let along = (corners[b] - corners[a]).normalize();
            let stiffness = along * along.transpose() * 1e3;
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                k.push(Triplet::new(3 * a + i, 3 * a + j, stiffness[(i, j)]));
                k.push(Triplet::new(3 * a + i, 3 * b + j, -stiffness[(i, j)]));
            }
        }
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            m.push(Triplet::new(3 * a + i, 3 * a + j, f64::from(u8::from(i == j))));
        }
    }
    let matrix = |entries: &[Triplet<usize, usize, f64>]| {
        SparseColMat::<usize, f64>::try_new_from_triplets(24, 24, entries).unwrap()
    };
    let files = Files::new();
    files.write("K.mtx", &matrix_market(matrix(&k).as_ref(), true));
    files.write("M.mtx", &matrix_market(matrix(&m).as_ref(), false));
    let nodes: String =
        (1..).zip(&corners).map(|(label, x)| format!("{label},{:?},{:?},{:?}\n", x.x, x.y, x.z)).collect();
    files.write("nodes.csv", &format!("node,x,y,z\n{nodes}"));
    files
}
