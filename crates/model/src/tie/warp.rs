//! How the faces of a marker warp under the forces of its joints, which its mean does not see.

use faer::MatRef;
use fem_tet10::{Mesh, Patch};
use nalgebra::Vector3;

/// Most patches that are looked at.
const MOST: usize = 6;
/// One mean is too soft from this part on: at 0.14 a weld of two halves of a plate has frequencies that are 6 % too low, at 0.013 one of a
/// bar 0.1 %.
const TOO_SOFT: f64 = 0.05;
/// Part of that which one mean leaves out that enough patches leave out.
const ENOUGH: f64 = 0.4;

/// Warping of the faces of a marker in its own static shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Warp {
    /// The largest root mean square, over the faces and over the static shapes of the marker, of what the mean displacement and the
    /// mean rotation leave out of the displacements of the faces, over these: of 1, 2, 3, … patches.
    pub left_out: Vec<f64>,
    /// Direction (unit vector, mesh axes) in which these patches follow each other, where the faces extend as far in two directions and
    /// do not tell it themselves.
    pub along: Option<Vector3<f64>>,
}

impl Warp {
    /// How many patches the faces should have, where one is too soft: the fewest that leave out much less, or the most that were
    /// looked at.
    pub fn patches(&self) -> Option<usize> {
        let one = self.left_out.first().filter(|one| **one > TOO_SOFT)?;
        let enough = self.left_out.iter().position(|left| *left < ENOUGH * one);
        Some(enough.map_or(self.left_out.len(), |place| place + 1))
    }

    /// Warp of faces in responses of the mesh to forces on them (N×k). Where they extend as far in two directions, that one counts whose
    /// patches leave out less.
    pub fn new(mesh: &Mesh, faces: &[[u32; 6]], dofs: usize, responses: MatRef<'_, f64>) -> Option<Self> {
        if let Some(along) = mesh.longest(faces) {
            let left_out = Self::left_out(mesh, faces, dofs, responses, &along);
            return Some(Self { left_out, along: None });
        }
        let of_direction = |along: Vector3<f64>| {
            let left_out = Self::left_out(mesh, faces, dofs, responses, &along);
            Self { left_out, along: Some(along) }
        };
        let sum = |warp: &Self| warp.left_out.iter().sum::<f64>();
        mesh.directions(faces).into_iter().map(of_direction).min_by(|a, b| sum(a).total_cmp(&sum(b)))
    }

    /// Parts left out by 1, 2, 3, … patches that follow each other along a direction.
    fn left_out(
        mesh: &Mesh,
        faces: &[[u32; 6]],
        dofs: usize,
        responses: MatRef<'_, f64>,
        along: &Vector3<f64>,
    ) -> Vec<f64> {
        let field =
            |column: usize, node: u32| Vector3::from_fn(|axis, _| responses[(dofs * node as usize + axis, column)]);
        // Means of the squares of all displacements, and of what is left of them.
        let squares = |patch: &Patch, column: usize| {
            let at = |node: u32| Vector3::from(mesh.positions()[node as usize]) - patch.position;
            let nodes = || patch.nodes.iter().copied().zip(patch.weights.iter().copied());
            let mean: Vector3<f64> = nodes().map(|(node, w)| field(column, node) * w).sum();
            let turn: Vector3<f64> = patch
                .nodes
                .iter()
                .zip(&patch.rotation_per_displacement)
                .map(|(node, rotation)| rotation * field(column, *node))
                .sum();
            let left = |node: u32| field(column, node) - mean - turn.cross(&at(node));
            let sum =
                |of: &dyn Fn(u32) -> Vector3<f64>| nodes().map(|(node, w)| w * of(node).norm_squared()).sum::<f64>();
            [sum(&|node| field(column, node)), sum(&left)]
        };
        let left_out = (1..=MOST).map(|count| {
            let strips = mesh.strips(faces, along, count);
            let of_column = |column: usize| {
                let parts = strips.iter().map(|strip| squares(&strip.patch, column).map(|square| strip.part * square));
                let [all, left] = parts.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
                (left.max(0.0) / all.max(f64::MIN_POSITIVE)).sqrt()
            };
            (0..responses.ncols()).map(of_column).fold(0.0, f64::max)
        });
        left_out.collect()
    }
}
