//! The motion in a results file on the mesh of its body: shapes times modal coordinates.

use std::path::Path;

use fem_tet10::von_mises;
use figures::facets;
use nalgebra::{Matrix3, Vector3};
use results::{CellKind, Grid, Results, Shapes, StressShapes};
use rigid_kin::Attitude;

use super::error::ExportError;
use super::rows::ExportRows;
use crate::drawn::{Drawn, Part};

/// The rows of a results file, and the shapes of its body.
#[derive(Debug)]
pub struct Motion {
    pub(super) results: Results,
    pub(super) shapes: Shapes,
    pub(super) grid: Grid,
    /// A sentence about stress that is not known.
    pub(super) without_stress: Option<String>,
}

/// Positions of all points of the grid at a row, and their stress.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Displacement by deformation, body components, point by point.
    pub elastic: Vec<f64>,
    /// Displacement from the place in the mesh, global components.
    pub displacement: Vec<f64>,
    /// Von Mises stress; where materials meet, the larger one. Empty where it is not known.
    pub von_mises: Vec<f64>,
}

impl Motion {
    /// Reads a results file, finished or not, with the shapes of its body on the surface, which it carries, or in the whole
    /// volume, which is in the body file.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn open(file: &Path, volume: bool) -> Result<Self, ExportError> {
        let part = if volume { Part::Volume } else { Part::Surface };
        let Drawn { results, shapes, tetrahedra, body_file } = Drawn::open(file, part)?;
        let Some(mesh) = &results.metadata.body.mesh else {
            return Err(ExportError::NoMesh { path: file.to_owned() });
        };
        let Some(shapes) = shapes.filter(|_| mesh.elements > 0) else {
            return Err(ExportError::NoElements { path: file.to_owned() });
        };
        let points = shapes.positions.clone();
        let grid = if volume {
            // VTK has the middles of 13 and 23 the other way round.
            let connectivity = tetrahedra
                .iter()
                .flat_map(|&[a, b, c, d, ab, bc, ac, ad, cd, bd]| [a, b, c, d, ab, bc, ac, ad, bd, cd]);
            Grid { points, connectivity: connectivity.collect(), cells: CellKind::QuadraticTetrahedron }
        } else {
            Grid { points, connectivity: facets(&shapes.faces).into_flattened(), cells: CellKind::Triangle }
        };
        let without_stress = body_file.filter(|_| shapes.stress.is_none()).map(|file| {
            let file = file.display();
            format!("{file} has no stress, so that the export has none: flexframe reduce SCENE --stress -o {file} makes it with it")
        });
        Ok(Self { results, shapes, grid, without_stress })
    }

    /// A warning about an export of these results.
    pub(super) fn warning(&self) -> Option<String> {
        let sentences: Vec<String> =
            ExportRows::warning(&self.results).into_iter().chain(self.without_stress.clone()).collect();
        (!sentences.is_empty()).then(|| sentences.join("; "))
    }

    /// The stress of a coordinate at all points, in the order of VTK's symmetric tensors, which is that of
    /// [`fem_tet10::COMPONENTS`]; where materials meet, that with the larger von Mises stress.
    pub(super) fn stress_of(&self, stress: &StressShapes, coordinate: usize) -> Vec<f64> {
        let mut larger = vec![[0.0; 6]; self.grid.points.len()];
        for (node, value) in stress.nodes.iter().zip(stress.shapes.get(coordinate).into_iter().flatten()) {
            let so_far = &mut larger[*node as usize];
            if von_mises(value) >= von_mises(so_far) {
                *so_far = *value;
            }
        }
        larger.into_flattened()
    }

    /// Positions of the points at a row, `r + Aᵀ (X + Ψ ξ)`, and their stress.
    pub(super) fn place(&self, row: usize, out: &mut Placed) {
        let history = |path: &str| self.results.table(path).and_then(|table| table.row(row)).unwrap_or_default();
        let vector = |path: &str| Vector3::from_iterator(history(path).iter().copied().chain([0.0; 3]));
        let q = history("modal/displacement");
        out.elastic = self.shapes.displaced(&self.shapes.coordinates(q)).into_flattened();
        let attitude = history("attitude").try_into().ok().and_then(|wxyz| Attitude::from_wxyz(wxyz).ok());
        let to_global: Matrix3<f64> = attitude.unwrap_or(Attitude::identity()).global_to_body().transpose();
        let (origin, at_origin) = (Vector3::from(self.results.metadata.body.origin), vector("origin"));
        out.displacement.clear();
        for (x, u) in self.grid.points.iter().zip(out.elastic.as_chunks::<3>().0) {
            let x = Vector3::from(*x);
            let moved = at_origin + to_global * (x - origin + Vector3::from(*u)) - x;
            out.displacement.extend(moved.iter());
        }
        out.von_mises.clear();
        if let Some(stress) = &self.shapes.stress {
            out.von_mises.resize(self.grid.points.len(), 0.0);
            let values = stress.combined(&self.shapes.stress_coordinates(q));
            for (node, value) in stress.nodes.iter().zip(&values) {
                let largest = &mut out.von_mises[*node as usize];
                *largest = largest.max(von_mises(value));
            }
        }
    }
}
