//! Forces on the displaced nodes of a body.

use faer::ColRef;
use fem_tet10::{MeanRotation, Mesh};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::error::NonlinearError;

/// Most iterations towards the rotation of a patch.
const ROTATIONS: usize = 200;

/// Something that acts on a body, in the axes of its frame.
#[derive(Debug, Clone)]
pub enum Acting {
    /// Forces that do not depend on the displacements (3n).
    Dead(Vec<f64>),
    /// A pressure on a physical surface, which turns and grows with it.
    Pressure {
        /// The surface.
        group: String,
        /// Force per area, into the body.
        pressure: f64,
    },
    /// A moment that does its work on the rotation of a patch. With the best rotation Q of its nodes it is the forces
    /// `Q R_iᵀ Qᵀ m`.
    Moment {
        /// The nodes, with the R_i.
        patch: MeanRotation,
        /// The moment m.
        moment: Vector3<f64>,
        /// True if m turns with the patch.
        turns: bool,
    },
    /// A force on the weighted mean of nodes that turns with the material of a patch.
    Turning {
        /// The nodes.
        nodes: Vec<u32>,
        /// Their weights.
        weights: Vec<f64>,
        /// The nodes that it turns with.
        patch: MeanRotation,
        /// The force on the undeformed body.
        force: Vector3<f64>,
    },
}

/// All that acts on a body.
#[derive(Debug, Clone, Default)]
pub struct ExternalForces(pub Vec<Acting>);

impl ExternalForces {
    /// Dead forces alone.
    pub fn dead(forces: Vec<f64>) -> Self {
        Self(vec![Acting::Dead(forces)])
    }

    /// True if some forces depend on the displacements.
    pub fn follow(&self) -> bool {
        self.0.iter().any(|acting| !matches!(acting, Acting::Dead(_)))
    }

    /// The same times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |acting: &Acting| match acting.clone() {
            Acting::Dead(forces) => Acting::Dead(forces.into_iter().map(|force| factor * force).collect()),
            Acting::Pressure { group, pressure } => Acting::Pressure { group, pressure: factor * pressure },
            Acting::Moment { patch, moment, turns } => Acting::Moment { patch, moment: moment * factor, turns },
            Acting::Turning { nodes, weights, patch, force } => {
                Acting::Turning { nodes, weights, patch, force: force * factor }
            }
        };
        Self(self.0.iter().map(scaled).collect())
    }

    /// The forces on the nodes displaced by `u` (3n).
    ///
    /// # Errors
    /// A surface that the mesh does not have.
    pub fn at(&self, mesh: &Mesh, u: &[f64]) -> Result<Vec<f64>, NonlinearError> {
        let mut forces = vec![0.0; u.len()];
        let mut add = |node: u32, force: Vector3<f64>| {
            let first = 3 * node as usize;
            forces[first..first + 3].iter_mut().zip(force.iter()).for_each(|(to, f)| *to += f);
        };
        for acting in &self.0 {
            match acting {
                Acting::Dead(dead) => {
                    for (node, force) in (0..).zip(dead.chunks_exact(3)) {
                        add(node, Vector3::from_column_slice(force));
                    }
                }
                Acting::Pressure { group, pressure } => {
                    let (nodes, unit) = mesh.surface_pressure_on(group, ColRef::from_slice(u))?;
                    nodes.iter().zip(unit).for_each(|(node, force)| add(*node, force * *pressure));
                }
                Acting::Moment { patch, moment, turns } => {
                    let turn = rotation(mesh, patch, u);
                    // In the axes that turn with the patch a dead moment turns back.
                    let there = if *turns { *moment } else { turn.transpose() * moment };
                    for (node, rotated) in patch.nodes.iter().zip(&patch.rotation_per_displacement) {
                        add(*node, turn * rotated.tr_mul(&there));
                    }
                }
                Acting::Turning { nodes, weights, patch, force } => {
                    let turned = rotation(mesh, patch, u) * force;
                    nodes.iter().zip(weights).for_each(|(node, weight)| add(*node, turned * *weight));
                }
            }
        }
        Ok(forces)
    }
}

/// The rotation of the nodes of a patch that fits their displacements best, in the sum of squares.
fn rotation(mesh: &Mesh, patch: &MeanRotation, u: &[f64]) -> Matrix3<f64> {
    let place = |node: u32| Vector3::from(mesh.positions()[node as usize]);
    let moved = |node: u32| place(node) + Vector3::from_column_slice(&u[3 * node as usize..3 * node as usize + 3]);
    let count = patch.nodes.len().max(1) as f64;
    let mean = |position: &dyn Fn(u32) -> Vector3<f64>| {
        patch.nodes.iter().map(|node| position(*node)).sum::<Vector3<f64>>() / count
    };
    let (from, to) = (mean(&place), mean(&moved));
    let product: Matrix3<f64> =
        patch.nodes.iter().map(|node| (moved(*node) - to) * (place(*node) - from).transpose()).sum();
    let size = product.norm();
    if !(size > 0.0 && size.is_finite()) {
        return Matrix3::identity();
    }
    Rotation3::from_matrix_eps(&(product / size), 1e-15, ROTATIONS, Rotation3::identity()).into_inner()
}
