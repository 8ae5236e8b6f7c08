//! Small rotations of the material at places of the mesh.

use dynamics::{PatchTurn, RotationShapes};
use faer::{ColMut, Mat};
use fem_tet10::{Location, MeanRotation, Mesh};
use modal::Modes;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;
use scene::Body;

use crate::error::{BuildError, refuse};

/// A small rotation of the material at some place.
pub(crate) enum Rotation {
    /// The mean rotation of nodes, by their displacements.
    Mean(MeanRotation),
    /// The rotation of a node that has one.
    OfNode(u32),
}

impl Rotation {
    /// The rotation of the material at a point: of the node there where nodes have rotations, otherwise of the elements around it.
    pub fn at(body: &Body, mesh: &Mesh, dofs: usize, key: &str, at: [f64; 3]) -> Result<Self, BuildError> {
        if mesh.has_elements() {
            return Ok(Self::Mean(mesh.mean_rotation(at, None).map_err(|error| refuse(body, key, error))?));
        }
        let Location { nodes, .. } = mesh.locate(at).map_err(|error| refuse(body, key, error))?;
        if dofs == 6 {
            return Ok(Self::OfNode(nodes[0]));
        }
        Err(body
            .refuse(
                key,
                "the rotation at a node of a body of matrices, whose nodes only have translations",
                "a rotation that the matrices know",
                "give a moment a `radius` with three nodes or more in it; give a force `frame = \"body\"`",
            )
            .into())
    }

    /// Adds the forces of a moment (3n, or 6n with the moments on nodes).
    pub fn add_unit_nodal_forces(&self, dofs: usize, moment: &Vector3<f64>, mut forces: ColMut<'_, f64>) {
        let mut add = |first: usize, vector: &Vector3<f64>| {
            for axis in 0..3 {
                forces[first + axis] += vector[axis];
            }
        };
        match self {
            Self::OfNode(node) => add(dofs * *node as usize + 3, moment),
            Self::Mean(patch) => {
                for (node, turned) in patch.nodes.iter().zip(&patch.rotation_per_displacement) {
                    add(dofs * *node as usize, &turned.tr_mul(moment));
                }
            }
        }
    }

    /// How the material is turned by the modes of a body.
    pub fn shapes(&self, dofs: usize, body: &ReducedBody, modes: &Modes) -> RotationShapes {
        let turned = self.by_mode(dofs, body, modes);
        RotationShapes::new(body, Mat::from_fn(3, turned.len(), |axis, k| turned[k][axis]).as_ref())
    }

    /// The rotation vector of each mode of a body.
    pub fn by_mode(&self, dofs: usize, body: &ReducedBody, modes: &Modes) -> Vec<Vector3<f64>> {
        let shape = |first: usize, k: usize| Vector3::from_fn(|axis, _| modes.shapes[(first + axis, k)]);
        let of_mode = |k: usize| -> Vector3<f64> {
            match self {
                Self::Mean(patch) => {
                    let of = patch.nodes.iter().zip(&patch.rotation_per_displacement);
                    of.map(|(node, a)| a * shape(dofs * *node as usize, k)).sum()
                }
                Self::OfNode(node) => shape(dofs * *node as usize + 3, k),
            }
        };
        (0..body.flexible()).map(of_mode).collect()
    }

    /// The turn of the nodes of a patch in the modes, however far it goes. Nodes count by their `weights`, if these are of the same
    /// nodes, or all alike.
    pub fn patch_turn(
        &self,
        mesh: &Mesh,
        dofs: usize,
        modes: &Modes,
        weights: Option<(&[u32], &[f64])>,
    ) -> Option<PatchTurn> {
        let Self::Mean(patch) = self else { return None };
        let position = |node: &u32| Vector3::from(mesh.positions()[*node as usize]);
        let alike = vec![1.0; patch.nodes.len()];
        let weights =
            weights.filter(|(nodes, _)| *nodes == &patch.nodes[..]).map_or(&alike[..], |(_, weights)| weights);
        let weighted = || patch.nodes.iter().zip(weights);
        let mean = weighted().map(|(node, weight)| position(node) * *weight).sum::<Vector3<f64>>();
        let mean = mean / weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let of = |moved: &dyn Fn(u32) -> Vector3<f64>| -> Matrix3<f64> {
            weighted().map(|(node, weight)| moved(*node) * (position(node) - mean).transpose() * *weight).sum()
        };
        let shape = |node: u32, k: usize| Vector3::from_fn(|axis, _| modes.shapes[(dofs * node as usize + axis, k)]);
        let of_modes = (0..modes.shapes.ncols()).map(|k| of(&|node| shape(node, k))).collect();
        PatchTurn::new(of(&|node| position(&node) - mean), of_modes)
    }
}
