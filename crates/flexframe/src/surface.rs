//! The surface of a body, for pictures.

use figures::{facets, sharp_edges};
use model::Model;
use nalgebra::Vector3;
use results::Shapes;
use rigid_kin::Attitude;

use crate::drawn::shapes_of;

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

    /// The surface of a model; `None` for a rigid body without a mesh.
    pub fn of_model(model: &Model) -> Option<Self> {
        let meshed = model.meshed.as_ref()?;
        Some(Self::new(shapes_of(meshed, model.physics.large_deflection.as_ref())))
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
