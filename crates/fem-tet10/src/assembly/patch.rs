//! A patch of a surface as a place with axes: the mean displacement and the mean rotation of its faces.
//!
//! Eqs. (J1) of `docs/method/systems.md`:
//!
//! ```text
//! X = Σ w_n X_n      u = Σ w_n u_n      θ = I_w⁻¹ Σ w_n [d_n ×] u_n      I_w = Σ w_n (|d_n|² 1 − d_n d_nᵀ)      d_n = X_n − X
//! ```

use faer::Mat;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::MeshError;
use crate::mesh::checked::Mesh;

/// A moment of inertia below this fraction of the largest is zero: the patch is a line.
const LINE: f64 = 1e-10;

/// A place on the surface of a body that faces or nodes carry together.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Node indices, ascending.
    pub nodes: Vec<u32>,
    /// w: the part of each node in the mean; the sum is 1.
    pub weights: Vec<f64>,
    /// X, length, axes of the mesh.
    pub position: Vector3<f64>,
    /// `θ = Σ rotation_per_displacement_i · u_i`, radians per length, axes of the mesh.
    pub rotation_per_displacement: Vec<Matrix3<f64>>,
    /// True if its nodes are on a line: it then has no rotation about the line.
    pub is_line: bool,
}

impl Mesh {
    /// The faces of a physical surface as a patch, each with its area.
    ///
    /// # Errors
    /// [`MeshFault::NoGroup`](crate::MeshFault::NoGroup) with the names of the surfaces there are.
    pub fn surface_patch(&self, group: &str) -> Result<Patch, MeshError> {
        Ok(self.patch_of_areas(self.surface_weights(group)?))
    }

    /// The faces on the surface of the body whose nodes are all where `holds` is true, as a patch, each with its area; `None`
    /// where there is no such face.
    pub fn outer_patch(&self, holds: impl Fn(&Vector3<f64>) -> bool) -> Option<Patch> {
        let is_in = |node: &u32| holds(&self.positions()[*node as usize].into());
        let faces = self.outer_faces().into_iter().filter(|nodes| nodes.iter().all(is_in));
        let (nodes, areas) = self.weights_of_faces(faces);
        (!nodes.is_empty()).then(|| self.patch_of_areas((nodes, areas)))
    }

    fn patch_of_areas(&self, (nodes, areas): (Vec<u32>, Vec<f64>)) -> Patch {
        let area: f64 = areas.iter().sum();
        let weights = areas.iter().map(|part| part / area).collect();
        Patch::new(nodes, weights, self.positions())
    }
}

impl Patch {
    /// Nodes with weights whose sum is 1.
    pub fn new(nodes: Vec<u32>, weights: Vec<f64>, positions: &[[f64; 3]]) -> Self {
        let at = |node: &u32| Vector3::from(positions[*node as usize]);
        let position: Vector3<f64> = nodes.iter().zip(&weights).map(|(node, w)| at(node) * *w).sum();
        let arms: Vec<Vector3<f64>> = nodes.iter().map(|node| at(node) - position).collect();
        let inertia = |d: &Vector3<f64>| Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose();
        let sum: Matrix3<f64> = arms.iter().zip(&weights).map(|(d, w)| inertia(d) * *w).sum();
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(sum);
        let least = LINE * eigenvalues.max();
        let inverses = eigenvalues.map(|moment| if moment > least { 1.0 / moment } else { 0.0 });
        let inverse = eigenvectors * Matrix3::from_diagonal(&inverses) * eigenvectors.transpose();
        let rotation_per_displacement =
            arms.iter().zip(&weights).map(|(d, w)| inverse * d.cross_matrix() * *w).collect();
        let is_line = eigenvalues.min() <= least;
        Self { nodes, weights, position, rotation_per_displacement, is_line }
    }

    /// Nodal forces (3n×6, row `3·node + axis`) of unit forces along the axes of the mesh and unit moments about them.
    pub fn forces(&self, nodes: usize) -> Mat<f64> {
        let mut forces = Mat::zeros(3 * nodes, 6);
        for ((node, weight), rotation) in self.nodes.iter().zip(&self.weights).zip(&self.rotation_per_displacement) {
            for axis in 0..3 {
                let row = 3 * *node as usize + axis;
                forces[(row, axis)] = *weight;
                for moment in 0..3 {
                    forces[(row, 3 + moment)] = rotation[(moment, axis)];
                }
            }
        }
        forces
    }

    /// Mean rotation vectors (3×k) of fields of displacements (3n×k).
    pub fn rotations(&self, fields: faer::MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(3, fields.ncols(), |axis, field| {
            let of_node = |(node, rotation): (&u32, &Matrix3<f64>)| -> f64 {
                (0..3).map(|b| rotation[(axis, b)] * fields[(3 * *node as usize + b, field)]).sum()
            };
            self.nodes.iter().zip(&self.rotation_per_displacement).map(of_node).sum()
        })
    }
}
