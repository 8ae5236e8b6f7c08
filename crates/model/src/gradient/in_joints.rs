//! Rates of a body in joints, whose modes and static shapes turn with its numbers: Eqs. (D17) and (D18) of `docs/method/gradients.md`.
//!
//! ```text
//! X = [R B],  X' = [0 B'],  B = Φ a + S c + R (…),  K S = F − M R Rᵀ F
//! U = Φ' a + S' c,  B' = U − R (RᵀM U + RᵀM' B)
//! K S' = F' − K'S − M'R RᵀF
//! (XᵀMX)' = XᵀM'X + X'ᵀMX + XᵀMX',   (XᵀKX)' alike,   (FᵀX)' = FᵀX'
//! ```

use std::collections::BTreeMap;

use faer::{Mat, MatRef, Scale};
use fem_tet10::{Location, MatrixRates, Mesh};
use modal::{ModalError, Modes, Solver, StaticAccuracy, centrifugal_accelerations, side_by_side};
use nalgebra::Vector3;
use scene::{Body, Tie};

use crate::building::assembly::AssembledMesh;
use crate::error::{BuildError, modal};
use crate::gradient::load_rates::{LoadRates, Numbered, load_forces};
use crate::gradient::parameter::Parameter;
use crate::gradient::varied::{BEYOND, VariedBody};
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::read::matrices;
use crate::model::{Meshed, Model};
use crate::tie::mesh_marker::{self, unit_forces};

/// A static response that is so far from the span of a basis, as a part of itself, is none of those that the basis was made of.
const BESIDE: f64 = 1e-6;
/// Singular values of static responses below this part of the largest are rounding: the basis leaves as much out.
const DEPENDENT: f64 = 1e-9;

/// A body in the coordinates of its model: its motion along its axes, its turns, its modes and its static shapes.
#[derive(Debug, Clone)]
pub struct BodyInJoints {
    /// Mass (6+nf × 6+nf).
    pub mass: Mat<f64>,
    /// The forces of its markers (k × 6+nf) that bear the forces on its coordinates, by these.
    pub bearing: Mat<f64>,
    /// The rates, by parameter.
    pub rates: Vec<RatesInJoints>,
}

/// Rates of a body in joints with one parameter, in coordinates that do not depend on it.
#[derive(Debug, Clone)]
pub struct RatesInJoints {
    /// Rate of the mass (6+nf × 6+nf).
    pub mass: Mat<f64>,
    /// Rate of the stiffness (nf×nf).
    pub stiffness: Mat<f64>,
    /// Rates of the displacements of the markers (k × nf).
    pub markers: Mat<f64>,
    /// Rates of the displacements of each point of the output (3×nf).
    pub points: Vec<Mat<f64>>,
    /// Rates of the forces of loads on the coordinates, by their numbers in the scene.
    pub loads: BTreeMap<usize, LoadRates>,
}

impl VariedBody {
    /// The rates of a body that is tied to others with some of its numbers: not with stretches, which move its markers.
    ///
    /// # Errors
    /// [`BuildError`]; a number that moves nodes; a marker whose nodes move as one rigid body; a basis that cuts modes of one frequency.
    pub fn in_joints(&self, model: &Model, parameters: &[Parameter]) -> Result<BodyInJoints, BuildError> {
        let body = self.scene();
        let AssembledMesh { mesh, .. } = self.assembled();
        let Some(meshed) = &model.meshed else { return Err(rigid(body)) };
        if let Some(parameter) = parameters.iter().find(|parameter| !parameter.is_key()) {
            let help = "leave it out, or take its rates of the body alone";
            let found = format!("{}, which moves the markers of a body in joints", parameter.name);
            return Err(body.refuse("body", found, "numbers of materials and point masses", help).into());
        }
        // The modes of such a body are combinations that keep its patches rigid: none is an eigenvector, so that (D7) is not its rate.
        if let Some(marker) = body.markers.iter().find(|marker| marker.tie == Tie::Rigid) {
            let key = marker.key_of_tie();
            let help = "give it `tie = \"nodes\"` or `tie = \"mean\"`, or name parameters of other bodies";
            let expected = "a tie that leaves the modes of the body as they are";
            return Err(body.refuse(&key, "\"rigid\", which mixes the modes of the body", expected, help).into());
        }
        let matrices = FeMatrices::Assembled(matrices(body, self.body(), mesh)?);
        let solver = self.assembled().solver(&matrices, mesh.positions()).map_err(modal(body))?;
        let basis = Basis::new(self, (&solver, &matrices), model, meshed)?;
        let rates = parameters.iter().map(|parameter| basis.with(self, parameter)).collect::<Result<_, _>>()?;
        let mass = basis.fields.transpose() * &basis.momenta;
        let bearing = bearing(&(basis.fields.transpose() * &basis.on_markers), &mass).map_err(modal(body))?;
        Ok(BodyInJoints { mass, bearing, rates })
    }
}

/// Pseudo-inverse of `of_markers` (6+nf × k): the marker forces that give known forces on the coordinates. Coordinates are taken with unit mass,
/// markers with unit influence.
fn bearing(of_markers: &Mat<f64>, mass: &Mat<f64>) -> Result<Mat<f64>, ModalError> {
    let unit = |i: usize| 1.0 / mass[(i, i)].sqrt();
    let of_unit = Mat::from_fn(of_markers.nrows(), of_markers.ncols(), |i, k| unit(i) * of_markers[(i, k)]);
    let influence: Vec<f64> = of_unit.col_iter().map(|column| column.norm_l2()).collect();
    let alike = Mat::from_fn(of_unit.nrows(), of_unit.ncols(), |i, k| of_unit[(i, k)] / influence[k]);
    let inverse = inverse(&alike)?;
    Ok(Mat::from_fn(inverse.nrows(), inverse.ncols(), |k, i| inverse[(k, i)] * unit(i) / influence[k]))
}

/// The inverse, without what is rounding.
fn inverse(of: &Mat<f64>) -> Result<Mat<f64>, ModalError> {
    let size = of.nrows().min(of.ncols());
    let svd = of.thin_svd().map_err(|_| ModalError::DenseEigen { size })?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let least = DEPENDENT * values.first().copied().unwrap_or_default();
    let known: Vec<usize> = (0..size).filter(|k| values[*k] > least).collect();
    let entry = |i: usize, j: usize| known.iter().map(|k| svd.V()[(i, *k)] * svd.U()[(j, *k)] / values[*k]).sum();
    Ok(Mat::from_fn(of.ncols(), of.nrows(), entry))
}

fn rigid(body: &Body) -> BuildError {
    body.refuse("body", "a rigid body", "a body with a mesh", "leave its numbers out").into()
}

/// The basis of a body in joints, and what it was made of.
struct Basis<'a> {
    solver: &'a Solver<'a>,
    scene: &'a Body,
    mesh: &'a Mesh,
    /// All modes that are known: those of the model, and a few more.
    known: Modes,
    /// How many of them the model has.
    natural: usize,
    /// R, Φ and the static shapes (N × 6+nf), and M and K times them.
    fields: Mat<f64>,
    momenta: Mat<f64>,
    forces: Mat<f64>,
    /// Forces of the markers (N×k).
    on_markers: Mat<f64>,
    /// Forces of loads whose displacements the rates of the shapes change: their numbers, and forces of unit vectors or the whole.
    loads: Vec<Numbered>,
    /// Weights of the points (N×3 each).
    points: Vec<Mat<f64>>,
    /// Static responses that the static shapes are made of, in their scale; `balanced`: their accelerations RᵀF; `of_spin`: of those to a spin,
    /// the accelerations x of the forces M x.
    responses: Mat<f64>,
    balanced: Mat<f64>,
    of_spin: Mat<f64>,
    /// c, and a for the natural modes.
    of_responses: Mat<f64>,
    of_modes: Mat<f64>,
}

impl<'a> Basis<'a> {
    fn new(
        varied: &'a VariedBody,
        (solver, matrices): (&'a Solver<'a>, &FeMatrices),
        model: &Model,
        meshed: &Meshed,
    ) -> Result<Self, BuildError> {
        let body = varied.scene();
        let (mesh, shapes) = (&*varied.assembled().mesh, &meshed.modes.shapes);
        let natural = meshed.modes.natural();
        let searched = (natural + BEYOND.max(natural / 2)).min(solver.available());
        let mut known = solver.modes(searched, |_| ()).map_err(modal(body))?;
        if known.whole(natural) != natural {
            let found = format!("{natural} modes of a body in joints, which part modes of one frequency");
            let expected = format!("{} of them", known.whole(natural));
            return Err(body
                .refuse(
                    "modes.flexible",
                    found,
                    expected,
                    "keep all of a group of like modes, or name other parameters",
                )
                .into());
        }
        known.shapes.as_mut().subcols_mut(0, natural).copy_from(shapes.subcols(0, natural));
        known.eigenvalues[..natural].copy_from_slice(&meshed.modes.eigenvalues[..natural]);

        let origin = model.body.origin;
        let rows = 3 * mesh.positions().len();
        let place = |row: usize| Vector3::from(mesh.positions()[row / 3]) - origin;
        let rigid = |row: usize, k: usize| match k {
            0..3 => f64::from(u8::from(row % 3 == k)),
            _ => Vector3::ith(k - 3, 1.0).cross(&place(row))[row % 3],
        };
        let fields = Mat::from_fn(rows, 6 + shapes.ncols(), |row, k| match k {
            0..6 => rigid(row, k),
            _ => shapes[(row, k - 6)],
        });
        let momenta = solver.mass().product(fields.as_ref());
        let forces = matrices.stiffness() * &fields;

        let markers = mesh_marker::on_mesh(body, mesh, 3)?;
        let on_markers = unit_forces(&markers, rows);
        let of_spin = centrifugal_accelerations(mesh.positions(), &origin);
        let (loads, of_loads) = load_forces(varied, matrices)?;
        let point = |location: &Location| {
            let mut weights = Mat::zeros(rows, 3);
            for (node, weight) in location.nodes.iter().zip(&location.weights) {
                (0..3).for_each(|axis| weights[(3 * *node as usize + axis, axis)] += weight);
            }
            weights
        };
        let spin = solver.mass().product(of_spin.as_ref());
        let all = [on_markers.as_ref(), spin.as_ref(), of_loads.as_ref()];
        let all = side_by_side(&all);
        let first_spin = on_markers.ncols();
        let respond = solver.static_response_from(&known, all.as_ref(), StaticAccuracy::Full).map_err(modal(body))?;

        let rigid = solver.rigid().shapes.as_ref();
        let statics = shapes.subcols(natural, shapes.ncols() - natural);
        let m_responses = solver.mass().product(respond.as_ref());
        let along = |of: MatRef<'_, f64>| of.transpose() * &m_responses;
        let (in_statics, in_modes) = (along(statics), along(shapes.subcols(0, natural)));
        let rest = &respond - rigid * along(rigid) - shapes.subcols(0, natural) * &in_modes - statics * &in_statics;
        let m_rest = solver.mass().product(rest.as_ref());
        let norm = |a: &Mat<f64>, b: &Mat<f64>, k: usize| (a.col(k).transpose() * b.col(k)).max(0.0).sqrt();
        // The basis was made of responses that are in it.
        let is_in = |k: &usize| {
            let whole = norm(&respond, &m_responses, *k);
            whole > 0.0 && norm(&rest, &m_rest, *k) <= BESIDE * whole
        };
        let chosen: Vec<usize> = (0..all.ncols()).filter(is_in).collect();
        let scales: Vec<f64> = chosen.iter().map(|k| 1.0 / norm(&respond, &m_responses, *k)).collect();
        let scaled = |of: &Mat<f64>| Mat::from_fn(of.nrows(), chosen.len(), |i, j| of[(i, chosen[j])] * scales[j]);
        let of_responses = inverse(&scaled(&in_statics)).map_err(modal(body))?;
        let missed = &scaled(&in_statics) * &of_responses - Mat::<f64>::identity(statics.ncols(), statics.ncols());
        if missed.norm_max() > BESIDE {
            let found = "static shapes that markers, loads and a spin do not make";
            return Err(body.refuse("modes", found, "a body in joints", "leave its numbers out").into());
        }
        let spins = |row: usize, k: usize| match k.checked_sub(first_spin) {
            Some(pair) if pair < of_spin.ncols() => of_spin[(row, pair)],
            _ => 0.0,
        };
        Ok(Self {
            solver,
            scene: body,
            mesh,
            natural,
            of_modes: scaled(&in_modes) * &of_responses * Scale(-1.0),
            responses: scaled(&respond),
            balanced: scaled(&(rigid.transpose() * &all)),
            of_spin: scaled(&Mat::from_fn(rows, all.ncols(), spins)),
            of_responses,
            known,
            loads,
            points: varied.points().iter().map(point).collect(),
            fields,
            momenta,
            forces,
            on_markers,
        })
    }

    /// Rates with a parameter.
    fn with(&self, varied: &VariedBody, parameter: &Parameter) -> Result<RatesInJoints, BuildError> {
        let body = varied.body();
        let rates = MatrixRates::new(self.mesh, &body.materials, &body.point_masses, &parameter.number)?;
        let rigid = self.solver.rigid().shapes.as_ref();
        let (flexible, known) = (self.fields.ncols() - 6, self.known.natural());
        let parts = [
            self.fields.as_ref(),
            self.known.shapes.subcols(self.natural, known - self.natural),
            self.responses.as_ref(),
            rigid,
            self.of_spin.as_ref(),
        ];
        let [k_rates, m_rates] = rates.products(self.mesh, side_by_side(&parts).as_ref())?;
        let part = |of: &Mat<f64>, i: usize| {
            let first: usize = parts[..i].iter().map(MatRef::ncols).sum();
            of.subcols(first, parts[i].ncols()).to_owned()
        };
        // Φ', of the modes that the model has.
        let of_known = |of: &Mat<f64>| side_by_side(&[of.subcols(6, self.natural), part(of, 1).as_ref()]);
        let (k_known, m_known) = (of_known(&k_rates), of_known(&m_rates));
        let first = [&k_known, &m_known].map(|of| of.subcols(0, self.natural));
        let of_modes = self.known.rates(first).map_err(modal(self.scene))?;
        let turned = self.solver.shape_rates(&self.known, &of_modes, [k_known.as_ref(), m_known.as_ref()]);
        let mode_rates = turned.map_err(modal(self.scene))? * of_modes.turn.transpose();
        // S'.
        let forces = part(&m_rates, 4) - part(&k_rates, 2) - part(&m_rates, 3) * &self.balanced;
        let response_rates = self.solver.static_response_from(&self.known, forces.as_ref(), StaticAccuracy::Full);
        let static_rates =
            response_rates.map_err(modal(self.scene))? * &self.of_responses + &mode_rates * &self.of_modes;
        let shape_rates = side_by_side(&[mode_rates.as_ref(), static_rates.as_ref()]);
        // The shapes stay at right angles to the rigid motions.
        let m_shapes = self.solver.mass().product(shape_rates.as_ref());
        let along = rigid.transpose() * (&m_shapes + m_rates.subcols(6, flexible));
        let shape_rates = shape_rates - rigid * along;
        let shapes = self.fields.subcols(6, flexible);
        let symmetric = |of: Mat<f64>| &of + of.transpose();
        let mut mass = self.fields.transpose() * m_rates.subcols(0, 6 + flexible);
        let turned = self.momenta.transpose() * &shape_rates;
        for (i, k) in (0..flexible).flat_map(|k| (0..6 + flexible).map(move |i| (i, k))) {
            mass[(i, 6 + k)] += turned[(i, k)];
            mass[(6 + k, i)] += turned[(i, k)];
        }
        let stiffness = shapes.transpose() * k_rates.subcols(6, flexible)
            + symmetric(self.forces.subcols(6, flexible).transpose() * &shape_rates);
        let of = |forces: &Mat<f64>| forces.transpose() * &shape_rates;
        let total = self.fields.col(0).transpose() * self.momenta.col(0);
        let load = |(number, forces): &Numbered| (*number, forces.rates(&shape_rates, &mass, total));
        let loads = self.loads.iter().map(load).collect();
        Ok(RatesInJoints {
            mass,
            stiffness,
            markers: of(&self.on_markers),
            points: self.points.iter().map(of).collect(),
            loads,
        })
    }
}
