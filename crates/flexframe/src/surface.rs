//! The surface of a body, for pictures.

use fem_tet10::von_mises;
use figures::{facets, sharp_edges};
use model::{BuildError, Model};
use nalgebra::Vector3;
use results::Shapes;
use rigid_kin::Attitude;

use crate::drawn::{shapes_of, surface_shapes_of};

/// Surface of the undeformed body, and how its points move.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Triangles, by indices of points.
    pub triangles: Vec<[u32; 3]>,
    /// Sharp edges, by indices of points.
    pub edges: Vec<[u32; 2]>,
    /// The points and their shapes.
    pub shapes: Shapes,
}

impl Surface {
    /// The surface of a body with these shapes.
    pub fn new(shapes: Shapes) -> Self {
        Self { edges: sharp_edges(&shapes.positions, &shapes.faces), triangles: facets(&shapes.faces), shapes }
    }

    /// The surface of a model; of a rigid body without a mesh, the solid that stands for it.
    pub fn of_model(model: &Model) -> Self {
        Self::new(shapes_of(model))
    }

    /// The same with its stress.
    ///
    /// # Errors
    /// [`BuildError`] where the stress cannot be computed, for want of memory.
    pub(crate) fn with_stress(model: &Model) -> Result<Self, BuildError> {
        Ok(Self::new(surface_shapes_of(model)?))
    }

    /// Von Mises stress at the points in the coordinates of the stress ([`Shapes::stress_coordinates`]); those that are not given
    /// are zero. At a node between materials it is the largest one. Zero without stress shapes.
    pub fn von_mises(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut greatest = vec![0.0_f64; self.shapes.positions.len()];
        let Some(stress) = &self.shapes.stress else { return greatest };
        let mut sums = vec![[0.0; 6]; stress.nodes.len()];
        for (shape, coordinate) in stress.shapes.iter().zip(coordinates).filter(|(_, coordinate)| **coordinate != 0.0) {
            for (sum, of_shape) in sums.iter_mut().zip(shape) {
                sum.iter_mut().zip(of_shape).for_each(|(sum, s)| *sum += coordinate * s);
            }
        }
        for (node, sum) in stress.nodes.iter().zip(&sums) {
            let at_node = &mut greatest[*node as usize];
            *at_node = at_node.max(von_mises(sum));
        }
        greatest
    }

    /// Displacements of the points, body axes, in the coordinates ξ of all shapes ([`Shapes::coordinates`]); those that are
    /// not given are zero.
    pub fn displacements(&self, xi: &[f64]) -> Vec<Vector3<f64>> {
        self.shapes.displaced(xi).into_iter().map(Vector3::from).collect()
    }

    /// Positions of the points in space when the body's origin, at `origin` in the mesh, is at `origin_global`, displaced by
    /// `displacements`.
    pub fn placed(
        &self,
        origin: &Vector3<f64>,
        origin_global: &Vector3<f64>,
        attitude: &Attitude,
        displacements: &[Vector3<f64>],
    ) -> Vec<[f64; 3]> {
        self.shapes
            .positions
            .iter()
            .zip(displacements)
            .map(|(x, u)| (origin_global + attitude.to_global(&(Vector3::from(*x) - origin + u))).into())
            .collect()
    }
}
