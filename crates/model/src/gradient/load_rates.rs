//! Loads on the modes of a body in joints, whose shapes turn with its numbers: b' of Eq. (D21) of `docs/method/gradients.md`.

use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;

use crate::building::assembly::AssembledMesh;
use crate::error::{BuildError, modal};
use crate::gradient::varied::VariedBody;
use crate::load::mesh_load::{self, Action, UnitWeight};
use crate::load::turning;
use crate::mesh::fe_matrices::FeMatrices;

/// Rates of the forces of a load on the coordinates of a body.
#[derive(Debug, Clone)]
pub enum LoadRates {
    /// By its force, body axes (3×nf).
    Force(Mat<f64>),
    /// By its moment, body axes (3×nf).
    Moment(Mat<f64>),
    /// Whole (1×nf), of forces that are fixed in the body.
    Field(Mat<f64>),
    /// By its acceleration, body axes: those of the mass with the translations (3×6+nf). The factor is one over the mass.
    Weight(Mat<f64>, f64),
}

impl LoadRates {
    /// The rates of a load with these forces on all coordinates of the body (6+nf).
    pub fn on_coordinates(&self, forces: &[f64]) -> Vec<f64> {
        let (by, first, scale) = match self {
            Self::Force(by) => (by, Some(0), 1.0),
            Self::Moment(by) => (by, Some(3), 1.0),
            Self::Field(by) => (by, None, 1.0),
            Self::Weight(by, scale) => (by, Some(0), *scale),
        };
        let factor = |i: usize| scale * first.map_or(1.0, |first| forces[first + i]);
        // Forces on the rigid motions change with the mass alone.
        let rigid = forces.len() - by.ncols();
        let of = |k: usize| (0..by.nrows()).map(|i| factor(i) * by[(i, k)]).sum();
        std::iter::repeat_n(0.0, rigid).chain((0..by.ncols()).map(of)).collect()
    }
}

/// A load by its number in the scene.
pub(super) type Numbered = (usize, LoadForces);

/// Forces on the nodes of a load: of unit vectors (N×3), or the whole (N×1); those of weights are M times the translations.
pub(super) enum LoadForces {
    Force(Mat<f64>),
    Moment(Mat<f64>),
    Field(Mat<f64>),
    Weight,
}

/// Forces on the nodes, in all directions that they may come to have: of each load by its number, and of all loads that static shapes are made for
/// (N×k). No static shapes are made for weights: they have no static response in a free body.
pub(super) fn load_forces(varied: &VariedBody, matrices: &FeMatrices) -> Result<(Vec<Numbered>, Mat<f64>), BuildError> {
    let (scene, AssembledMesh { mesh, support, .. }) = (varied.scene(), varied.assembled());
    let FeMatrices::Assembled(matrices) = matrices else { return Ok((Vec::new(), Mat::new())) };
    let weight = UnitWeight::of_elements(matrices).map_err(modal(scene))?;
    let turning = turning::turning(&varied.assembled().needed(), support.motion, None);
    let loads = mesh_load::on_mesh(&varied.assembled().needed(), mesh, 3, &Arc::new(weight))?;
    let mut columns = Vec::new();
    let mut found = Vec::new();
    let rows = 3 * mesh.positions().len();
    let numbers = mesh_load::acting(&varied.assembled().needed()).map(|(i, _)| i);
    for (number, load) in numbers.zip(&loads).filter(|(_, load)| load.size() > 0.0) {
        let of_units = || {
            let mut forces = Mat::zeros(rows, 3);
            for (axis, column) in forces.as_mut().col_iter_mut().enumerate() {
                load.add_unit_nodal_forces(Some(Vector3::ith(axis, 1.0)), column);
            }
            forces
        };
        found.push((
            number,
            match load.action {
                Action::Weight { .. } => LoadForces::Weight,
                Action::Force { .. } => LoadForces::Force(of_units()),
                Action::Moment { .. } => LoadForces::Moment(of_units()),
                Action::Field { .. } => {
                    let mut forces = vec![0.0; rows];
                    load.add_nodal_forces(&mut forces);
                    LoadForces::Field(Mat::from_fn(rows, 1, |row, _| forces[row]))
                }
            },
        ));
        if matches!(load.action, Action::Weight { .. }) {
            continue;
        }
        let turned = load.turned(turning);
        for k in 0..turned.len().max(1) {
            columns.push((load, turned.get(k).copied()));
        }
    }
    let mut forces = Mat::zeros(rows, columns.len());
    for ((load, along), column) in columns.into_iter().zip(forces.as_mut().col_iter_mut()) {
        load.add_unit_nodal_forces(along, column);
    }
    Ok((found, forces))
}

impl LoadForces {
    /// Rates of the forces on the coordinates by those of the shapes (N×nf), and by those of the mass of a body of mass `total`
    /// (6+nf × 6+nf).
    pub fn rates(&self, shape_rates: &Mat<f64>, mass_rates: &Mat<f64>, total: f64) -> LoadRates {
        let of = |forces: &Mat<f64>| forces.transpose() * shape_rates;
        match self {
            Self::Force(forces) => LoadRates::Force(of(forces)),
            Self::Moment(forces) => LoadRates::Moment(of(forces)),
            Self::Field(forces) => LoadRates::Field(of(forces)),
            Self::Weight => LoadRates::Weight(mass_rates.subrows(0, 3).to_owned(), 1.0 / total),
        }
    }
}
