//! The surface of a body, for pictures: boundary triangles over their own list of points.

use fem_tet10::Mesh;
use figures::{facets, sharp_edges};
use nalgebra::Vector3;
use rigid_kin::Attitude;
use scene::{Meshed, Model};

/// Surface of the undeformed body, and how its points move.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Triangles, by indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// Sharp edges, by indices of points.
    pub edges: Vec<[u32; 2]>,
    /// Undeformed points, mesh axes.
    pub points: Vec<[f64; 3]>,
    /// Indices of the points among the nodes of the mesh.
    pub(crate) nodes: Vec<u32>,
}

impl Surface {
    /// The surface of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let on_mesh = mesh.outer_faces();
        let mut nodes: Vec<u32> = on_mesh.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| nodes.partition_point(|n| *n < node) as u32;
        let faces: Vec<[u32; 6]> = on_mesh.iter().map(|face| face.map(place)).collect();
        let points: Vec<[f64; 3]> = nodes.iter().map(|n| mesh.positions()[*n as usize]).collect();
        Self { edges: sharp_edges(&points, &faces), triangles: facets(&faces), points, nodes }
    }

    /// The nodes of a body that has no elements, without triangles and edges: `most` of them at the most, evenly among all.
    pub(crate) fn of_nodes(mesh: &Mesh, most: usize) -> Self {
        let count = mesh.positions().len();
        let kept = count.min(most);
        let nodes: Vec<u32> = (0..kept).map(|i| (i * count / kept) as u32).collect();
        let points = nodes.iter().map(|n| mesh.positions()[*n as usize]).collect();
        Self { triangles: Vec::new(), edges: Vec::new(), points, nodes }
    }

    /// Displacements of the points, body axes, in the coordinates of the modes and of the shapes that follow them
    /// ([`Model::coordinates`]); those that are not given are zero.
    pub fn displacements(&self, meshed: &Meshed, coordinates: &[f64]) -> Vec<Vector3<f64>> {
        let shapes = || meshed.modes.shapes.col_iter().chain(meshed.following.col_iter());
        // Nodes of matrices from elsewhere may have rotations, too.
        let freedoms = meshed.modes.shapes.nrows() / meshed.mesh.positions().len().max(1);
        self.nodes
            .iter()
            .map(|node| {
                let row = freedoms * *node as usize;
                let of =
                    |(shape, xi): (faer::ColRef<'_, f64>, &f64)| Vector3::from_fn(|axis, _| shape[row + axis]) * *xi;
                shapes().zip(coordinates).map(of).sum()
            })
            .collect()
    }

    /// Where the points are in space when the body's origin is at `origin_global`, displaced by `displacements`.
    pub fn placed(
        &self,
        model: &Model,
        origin_global: &Vector3<f64>,
        attitude: &Attitude,
        displacements: &[Vector3<f64>],
    ) -> Vec<[f64; 3]> {
        let origin = model.body.origin;
        self.points
            .iter()
            .zip(displacements)
            .map(|(x, u)| (origin_global + attitude.to_global(&(Vector3::from(*x) - origin + u))).into())
            .collect()
    }
}
