//! The motion in a results file on the meshes of its bodies: shapes times modal coordinates.

use std::path::Path;

use diagnostic::Failure;
use fem_tet10::von_mises;
use figures::facets;
use nalgebra::{Matrix3, Vector3};
use results::{BodyMetadata, BodyResults, CellKind, Grid, Results, Shapes, StressShapes};
use rigid_kin::Attitude;

use super::rows::ExportRows;
use super::rows::no_elements;
use crate::drawn::{Drawn, DrawnBody, Part};

/// The rows of a results file, and the meshes of its bodies.
#[derive(Debug)]
pub struct DrawnMotion {
    pub(super) results: Results,
    /// The bodies that have a surface, or elements where these are asked for.
    pub(super) bodies: Vec<DrawnSurface>,
}

/// A body on its surface or its elements.
#[derive(Debug)]
pub(super) struct DrawnSurface {
    /// Its number among all bodies.
    number: usize,
    pub shapes: Shapes,
    pub grid: Grid,
    /// A sentence about stress that is not known.
    pub without_stress: Option<String>,
}

/// Positions of all points of a grid at a row, and their stress.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Displacement by deformation, body components, point by point.
    pub elastic: Vec<f64>,
    /// Displacement from the place in the mesh, global components.
    pub displacement: Vec<f64>,
    /// Von Mises stress; where materials meet, the larger one. Empty where it is not known.
    pub von_mises: Vec<f64>,
}

impl DrawnMotion {
    /// Reads a results file, finished or not, with the shapes of its bodies on the surface, which it carries, or in the whole
    /// volume, which is in body files.
    ///
    /// # Errors
    /// [`Failure`]; also where no body has elements or a surface.
    pub fn open(file: &Path, volume: bool) -> Result<Self, Failure> {
        let part = if volume { Part::Volume } else { Part::Surface };
        let Drawn { results, bodies } = Drawn::open(file, part)?;
        let bodies: Vec<DrawnSurface> = (bodies.into_iter().enumerate())
            .filter_map(|(number, body)| DrawnSurface::new(number, body, volume))
            .collect();
        if bodies.is_empty() {
            return Err(no_elements(file));
        }
        Ok(Self { results, bodies })
    }

    /// True if it is of one body, and not of a system.
    pub(super) fn is_single(&self) -> bool {
        self.results.metadata.only_body().is_some()
    }

    /// A warning about an export of these results.
    pub(super) fn warning(&self) -> Option<String> {
        self.warning_with(ExportRows::warning(&self.results))
    }

    /// The same of an export without rows.
    pub(super) fn warning_without_rows(&self) -> Option<String> {
        self.warning_with(None)
    }

    fn warning_with(&self, first: Option<String>) -> Option<String> {
        let of_bodies = self.bodies.iter().filter_map(|body| body.without_stress.clone());
        let sentences: Vec<String> = first.into_iter().chain(of_bodies).collect();
        (!sentences.is_empty()).then(|| sentences.join("; "))
    }
}

impl DrawnSurface {
    fn new(number: usize, DrawnBody { shapes, tetrahedra, body_file }: DrawnBody, volume: bool) -> Option<Self> {
        let shapes = shapes.filter(|shapes| if volume { !tetrahedra.is_empty() } else { !shapes.faces.is_empty() })?;
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
        Some(Self { number, shapes, grid, without_stress })
    }

    /// Everything of it that does not change with time.
    pub fn metadata<'m>(&self, motion: &'m DrawnMotion) -> &'m BodyMetadata {
        &motion.results.metadata.bodies[self.number]
    }

    fn results<'m>(&self, motion: &'m DrawnMotion) -> Option<BodyResults<'m>> {
        motion.results.bodies().nth(self.number)
    }

    /// The stress of a coordinate at all points, in the order of VTK's symmetric tensors, which is that of
    /// [`fem_tet10::COMPONENTS`]; where materials meet, that with the larger von Mises stress.
    pub fn stress_of(&self, stress: &StressShapes, coordinate: usize) -> Vec<f64> {
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
    pub fn place(&self, motion: &DrawnMotion, row: usize, out: &mut Placed) {
        let results = self.results(motion);
        let history = |path: &str| results.and_then(|results| results.table(path)?.row(row)).unwrap_or_default();
        let vector = |path: &str| Vector3::from_iterator(history(path).iter().copied().chain([0.0; 3]));
        let q = history("modal/displacement");
        out.elastic = self.shapes.displaced(&self.shapes.coordinates(q)).into_flattened();
        let attitude = history("attitude").try_into().ok().and_then(|wxyz| Attitude::from_wxyz(wxyz).ok());
        let to_global: Matrix3<f64> = attitude.unwrap_or(Attitude::identity()).global_to_body().transpose();
        let (origin, at_origin) = (Vector3::from(self.metadata(motion).model.origin), vector("origin"));
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
