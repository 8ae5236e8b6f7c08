//! The mean rotation of a patch of nodes, and with it the nodal forces of a moment.
//!
//! ```text
//! θ = Σ R_i u_i        R_i = J⁻¹ [d_i ×]        J = Σ (d_i·d_i I₃ − d_i d_iᵀ)        d_i = X_i − X̄
//! ```
//!
//! θ is that of the rigid motion that fits the displacements best, in the sum of squares over the nodes, all alike.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::{AssemblyError, AssemblyFault};
use crate::mesh::checked::Mesh;

/// A patch whose smallest moment of inertia is below this fraction of the largest is a line.
const LINE: f64 = 1e-10;

/// The small rotation of a patch of nodes: `θ = Σ rotation_per_displacement_i · u_i`.
///
/// A moment m does the work m·θ, so it is the forces `rotation_per_displacement_iᵀ m` on the nodes, which have no
/// resultant and the moment m about every point.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanRotation {
    /// Node indices, ascending.
    pub nodes: Vec<u32>,
    /// For each node, radians per length, axes of the mesh.
    pub rotation_per_displacement: Vec<Matrix3<f64>>,
}

impl Mesh {
    /// The mean rotation of all nodes within `radius` of a point; without a radius, of the elements around the node
    /// nearest to a point of the body.
    ///
    /// # Errors
    /// [`AssemblyFault::PatchRadius`] for a radius that is not positive, [`AssemblyFault::Patch`] for a patch of fewer
    /// than three nodes or of nodes on a line; without a radius those of [`Self::locate`].
    pub fn mean_rotation(&self, at: [f64; 3], radius: Option<f64>) -> Result<MeanRotation, AssemblyError> {
        let Some(radius) = radius else {
            self.locate(at)?;
            let nearest = self.nearest_node(at).0;
            let around = self.elements().iter().filter(|nodes| nodes.contains(&nearest));
            let nodes: BTreeSet<u32> = around.flatten().copied().collect();
            return self.mean_rotation_of(nodes.into_iter().collect(), at, 0.0);
        };
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(AssemblyFault::PatchRadius { at, found: radius }.into());
        }
        self.mean_rotation_of(self.nodes_within(at, radius), at, radius)
    }

    fn mean_rotation_of(&self, nodes: Vec<u32>, at: [f64; 3], radius: f64) -> Result<MeanRotation, AssemblyError> {
        let position = |node: &u32| Vector3::from(self.positions()[*node as usize]) - Vector3::from(at);
        let mean = nodes.iter().map(position).sum::<Vector3<f64>>() / nodes.len().max(1) as f64;
        let arms: Vec<Vector3<f64>> = nodes.iter().map(|node| position(node) - mean).collect();
        let inertia: Matrix3<f64> =
            arms.iter().map(|d| Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose()).sum();
        let moments = SymmetricEigen::new(inertia).eigenvalues;
        let inverse = inertia.try_inverse().filter(|_| moments.min() > LINE * moments.max());
        match inverse {
            Some(inverse) => {
                let rotation_per_displacement = arms.iter().map(|d| inverse * d.cross_matrix()).collect();
                Ok(MeanRotation { nodes, rotation_per_displacement })
            }
            None => Err(AssemblyFault::Patch { at, radius, count: nodes.len(), distance: self.nearest_node(at).1 }
                .of(self.source())),
        }
    }
}
