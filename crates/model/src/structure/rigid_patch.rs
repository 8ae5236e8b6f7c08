//! Nodes that are to move as one rigid body.

use faer::Mat;
use modal::Modes;
use nalgebra::{DMatrix, Vector3};

/// A motion of nodes below this part of the largest is rounding: that about a line which they are on.
const LINE: f64 = 1e-9;

/// Displacements of the nodes of a patch in the modes, beside its best rigid motion (3n×nf).
pub(super) fn rigid_rows(modes: &Modes, dofs: usize, positions: &[[f64; 3]], nodes: &[u32]) -> Mat<f64> {
    let at = |node: &u32| Vector3::from(positions[*node as usize]);
    let center = nodes.iter().map(at).sum::<Vector3<f64>>() / nodes.len() as f64;
    let size = nodes.iter().map(|node| (at(node) - center).norm()).fold(f64::MIN_POSITIVE, f64::max);
    let motion = DMatrix::from_fn(3 * nodes.len(), 6, |row, k| {
        let arm = (at(&nodes[row / 3]) - center) / size;
        if k < 3 { f64::from(u8::from(row % 3 == k)) } else { Vector3::ith(k - 3, 1.0).cross(&arm)[row % 3] }
    });
    let svd = motion.svd(true, false);
    let largest = svd.singular_values.max();
    let known: Vec<usize> =
        (0..svd.singular_values.len()).filter(|k| svd.singular_values[*k] > LINE * largest).collect();
    let shape = |row: usize, mode: usize| modes.shapes[(dofs * nodes[row / 3] as usize + row % 3, mode)];
    let mut rows = Mat::from_fn(3 * nodes.len(), modes.shapes.ncols(), shape);
    let Some(u) = svd.u else { return rows };
    for mut column in rows.as_mut().col_iter_mut() {
        for k in &known {
            let part: f64 = (0..column.nrows()).map(|i| u[(i, *k)] * column[i]).sum();
            (0..column.nrows()).for_each(|i| column[i] -= u[(i, *k)] * part);
        }
    }
    rows
}
