//! The motion in a results file on the mesh of its scene: shapes times modal coordinates.

use std::path::Path;

use faer::ColRef;
use fem_tet10::von_mises;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use results::{CellKind, Grid, Results};
use rigid_kin::Attitude;
use scene::{BuildProgress, Cache, Meshed, Model, Scene};

use super::error::ExportError;
use crate::reopened::Reopened;
use crate::run::metadata;
use crate::surface::Surface;

/// The rows of a results file, and the body of its scene, made anew.
#[derive(Debug)]
pub struct Motion {
    pub(super) results: Results,
    pub(super) scene: Scene,
    pub(super) model: Model,
    pub(super) grid: Grid,
    /// Indices of the grid's points among the nodes of the mesh.
    nodes: Vec<u32>,
}

/// Where all points of the grid are at a row, and their stress.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Displacement by deformation, body components, point by point.
    pub elastic: Vec<f64>,
    /// Displacement from the place in the mesh, global components.
    pub displacement: Vec<f64>,
    /// Von Mises stress; where materials meet, the larger one.
    pub von_mises: Vec<f64>,
}

impl Motion {
    /// Reads a results file, finished or not, and makes the body of its scene, on its surface or in the whole volume.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn open(
        file: &Path,
        volume: bool,
        cache: &Cache,
        progress: impl FnMut(BuildProgress),
    ) -> Result<Self, ExportError> {
        let Reopened { results, scene, model } = Reopened::open(file, cache, progress)?;
        let now = metadata(&scene, &model);
        if now.body != results.metadata.body {
            return Err(ExportError::Changed { path: file.to_owned() });
        }
        let Some(Meshed { mesh, .. }) = &model.meshed else {
            return Err(ExportError::NoMesh { path: file.to_owned() });
        };
        if !mesh.has_elements() {
            return Err(ExportError::NoElements { path: file.to_owned() });
        }
        let (grid, nodes) = if volume {
            // VTK has the middles of 13 and 23 the other way round.
            let elements = mesh.elements().iter();
            let connectivity =
                elements.flat_map(|&[a, b, c, d, ab, bc, ac, ad, cd, bd]| [a, b, c, d, ab, bc, ac, ad, bd, cd]);
            let points = mesh.positions().to_vec();
            let nodes = (0..points.len() as u32).collect();
            (Grid { points, connectivity: connectivity.collect(), cells: CellKind::QuadraticTetrahedron }, nodes)
        } else {
            let Surface { triangles, points, nodes, .. } = Surface::new(mesh);
            (Grid { points, connectivity: triangles.into_flattened(), cells: CellKind::Triangle }, nodes)
        };
        Ok(Self { results, scene, model, grid, nodes })
    }

    /// Adds a shape on the mesh (3n), times `factor`, to a list of the grid's points.
    pub(super) fn add_shape(&self, shape: ColRef<'_, f64>, factor: f64, out: &mut [f64]) {
        for (out, node) in out.as_chunks_mut::<3>().0.iter_mut().zip(&self.nodes) {
            let row = 3 * *node as usize;
            out.iter_mut().enumerate().for_each(|(axis, out)| *out += shape[row + axis] * factor);
        }
    }

    /// The stress of a coordinate at all points, in the order of VTK's symmetric tensors, which is that of
    /// [`fem_tet10::COMPONENTS`]; where materials meet, that with the larger von Mises stress.
    pub(super) fn stress_of(&self, coordinate: usize) -> Vec<f64> {
        let Some(stress) = &self.model.stress else { return vec![0.0; 6 * self.grid.points.len()] };
        let mut unit = vec![0.0; coordinate + 1];
        unit[coordinate] = 1.0;
        self.nodes.iter().flat_map(|node| stress.in_coordinates(*node, &unit)).collect()
    }

    /// Where the points are at a row: `r + Aᵀ (X + Ψ ξ)`; and their stress.
    pub(super) fn place(&self, row: usize, out: &mut Placed) {
        let history = |path: &str| self.results.table(path).and_then(|table| table.row(row)).unwrap_or_default();
        let vector = |path: &str| Vector3::from_iterator(history(path).iter().copied().chain([0.0; 3]));
        out.elastic.clear();
        out.elastic.resize(3 * self.grid.points.len(), 0.0);
        if let Some(Meshed { modes, following, .. }) = &self.model.meshed {
            let shapes = modes.shapes.col_iter().chain(following.col_iter());
            let coordinates = self.model.coordinates(history("modal/displacement"));
            shapes.zip(coordinates).for_each(|(shape, xi)| self.add_shape(shape, xi, &mut out.elastic));
        }
        let attitude = history("attitude").try_into().ok().and_then(|wxyz| Attitude::from_wxyz(wxyz).ok());
        let to_global: Matrix3<f64> = attitude.unwrap_or(Attitude::identity()).global_to_body().transpose();
        let at_origin = vector("origin");
        out.displacement.clear();
        for (x, u) in self.grid.points.iter().zip(out.elastic.as_chunks::<3>().0) {
            let x = Vector3::from(*x);
            let moved = at_origin + to_global * (x - self.model.body.origin + Vector3::from(*u)) - x;
            out.displacement.extend(moved.iter());
        }
        out.von_mises.clear();
        match &self.model.stress {
            Some(stress) => {
                let coordinates = stress.coordinates(history("modal/displacement"));
                let of_node = |node: &u32| von_mises(&stress.in_coordinates(*node, &coordinates));
                self.nodes.par_iter().map(of_node).collect_into_vec(&mut out.von_mises);
            }
            None => out.von_mises.resize(self.nodes.len(), 0.0),
        }
    }
}
