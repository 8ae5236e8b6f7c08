//! The vibrations of modes that are left out: a run compared with one that has twice the modes.
//!
//! A check at rows sees what modes leave out of the answer to the forces of the row, and not that it rings after them.

use model::Model;
use nalgebra::Vector3;
use results::{BodyResults, Results};

use super::stated::STILL;

/// Rows and nodes that are compared at the most.
const ROWS: usize = 200;
const NODES: usize = 2000;

/// A run of a body: its results, its number among the bodies, and its model.
#[derive(Clone, Copy)]
pub(super) struct OfBody<'a> {
    pub results: &'a Results,
    pub body: usize,
    pub model: &'a Model,
}

impl<'a> OfBody<'a> {
    fn of(self) -> Option<BodyResults<'a>> {
        self.results.bodies().nth(self.body)
    }

    /// Displacements by deformation of some nodes in a row, linear in the modes.
    fn displacements(self, row: usize) -> Option<Vec<Vector3<f64>>> {
        let shapes = &self.model.meshed.as_ref()?.modes.shapes;
        let table = self.of()?.table("modal/displacement")?;
        let q = table.row(row)?;
        let nodes = shapes.nrows() / 3;
        let at = |node: usize| {
            let along = |axis: usize| q.iter().enumerate().map(|(k, q)| shapes[(3 * node + axis, k)] * q).sum::<f64>();
            Vector3::new(along(0), along(1), along(2))
        };
        Some((0..nodes).step_by(nodes.div_ceil(NODES).max(1)).map(at).collect())
    }
}

/// The largest difference of two runs of a body with the same rows over the largest displacements by deformation: of all nodes together, and of
/// each point of the output. `None` where they have other rows.
pub(super) fn difference(run: OfBody<'_>, other: OfBody<'_>) -> Option<f64> {
    let rows = run.results.rows();
    if rows == 0 || rows != other.results.rows() {
        return None;
    }
    let norm = |u: &[Vector3<f64>]| u.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    let (mut apart, mut size, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in (0..rows).step_by(rows.div_ceil(ROWS)) {
        let (u, v) = (run.displacements(row)?, other.displacements(row)?);
        let difference: Vec<Vector3<f64>> = u.iter().zip(&v).map(|(u, v)| u - v).collect();
        apart = apart.max(norm(&difference));
        size = size.max(norm(&v));
        largest = v.iter().map(Vector3::norm).fold(largest, f64::max);
    }
    let mut worst = ratio(apart, size);
    for name in &run.of()?.metadata.point_names {
        let path = format!("points/{name}/elastic_displacement_body");
        let (of, others) = (run.of()?, other.of()?);
        let (Some(u), Some(v)) = (of.vectors::<3>(&path), others.vectors::<3>(&path)) else { continue };
        let [mut apart, mut size] = [0.0_f64, STILL * largest];
        for (u, v) in u.iter().zip(v) {
            let [u, v] = [u, v].map(|u| Vector3::from(*u));
            (apart, size) = (apart.max((u - v).norm()), size.max(v.norm()));
        }
        worst = worst.max(ratio(apart, size));
    }
    Some(worst)
}

fn ratio(part: f64, whole: f64) -> f64 {
    if part > 0.0 { part / whole } else { 0.0 }
}
