//! Rates of a body with its numbers as they are.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use faer::{Col, Mat, MatRef};
use fem_tet10::{BodyNumber, Location, MatrixRates, Mesh, stretch};
use modal::{ModeRates, Modes, Solver, StaticAccuracy};
use nalgebra::Vector3;
use scene::{Body, LoadKind, MeshedBody};

use crate::building::assembly::AssembledMesh;
use crate::error::{BuildError, modal};
use crate::gradient::parameter::Parameter;
use crate::gradient::rates::{ParameterRates, RatesOf, Residues, TRANSLATIONS};
use crate::load::mesh_load::{self, Action, MeshLoad, UnitWeight};
use crate::mesh::fe_matrices::FeMatrices;

/// Loads on the nodes where their histories are 1.
pub(super) struct Loads {
    list: Vec<MeshLoad>,
    /// Forces (N×loads).
    pub forces: Mat<f64>,
}

/// Loads that were asked for, and the static answers to them of a body that is held (N×loads).
pub(super) struct Acted {
    pub loads: Option<Loads>,
    pub statics: Option<Mat<f64>>,
}

/// A body with its numbers.
pub(super) struct At<'a> {
    pub assembled: &'a AssembledMesh,
    /// The mesh as it is now.
    pub mesh: &'a Mesh,
    /// Points of the output.
    pub points: &'a [Location],
    pub body: &'a MeshedBody,
    pub matrices: &'a FeMatrices,
    pub solver: &'a Solver<'a>,
    pub modes: &'a Modes,
    /// Modes that were asked for, and as many as cut no group of one frequency.
    pub asked: usize,
    pub count: usize,
    pub repeated: &'a [Range<usize>],
}

impl At<'_> {
    fn scene(&self) -> &Body {
        &self.assembled.scene
    }

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    /// Displacements (N×k) at the points, by column.
    pub fn at_points(&self, fields: MatRef<'_, f64>) -> Vec<Vec<Vector3<f64>>> {
        let at = |point: &Location, column: usize| {
            point.mean(|node| Vector3::from_fn(|axis, _| fields[(3 * node as usize + axis, column)]))
        };
        (0..fields.ncols()).map(|column| self.points.iter().map(|point| at(point, column)).collect()).collect()
    }

    /// Values of the modes that were asked for.
    pub fn kept<T: Clone>(&self, of_modes: &[T]) -> Vec<T> {
        of_modes[..self.asked.min(of_modes.len())].to_vec()
    }

    /// Rates with a parameter.
    pub fn with(&self, parameter: &Parameter, of: RatesOf, acted: &Acted) -> Result<ParameterRates, BuildError> {
        let (mesh, modes) = (self.mesh(), self.modes);
        let MeshedBody { materials, point_masses, .. } = self.body;
        let rates = match &parameter.number {
            // A unit of it moves the nodes of a stretched mesh as it moves those of the mesh of the scene.
            BodyNumber::Stretch(group, axis) => {
                let velocities = stretch(&self.assembled.mesh, group.as_deref(), *axis)?;
                MatrixRates::of_velocities(mesh, materials, velocities)?
            }
            number => MatrixRates::new(mesh, materials, point_masses, number)?,
        };
        self.refuse_turning_support(parameter, &rates)?;
        let natural = match of {
            RatesOf::Frequencies => self.count,
            RatesOf::All => modes.natural(),
        };
        let [k_rates, m_rates] = rates.products(mesh, modes.shapes.subcols(0, natural))?;
        let first = [&k_rates, &m_rates].map(|rates| rates.subcols(0, self.count));
        let of_modes = modes.rates(first).map_err(modal(self.scene()))?;
        let frequency = |(rate, lambda): (&f64, &f64)| rate / (2.0 * TAU * lambda.sqrt());
        let frequencies: Vec<f64> = of_modes.eigenvalues.iter().zip(&modes.eigenvalues).map(frequency).collect();
        let mut found = ParameterRates {
            frequencies: self.kept(&frequencies),
            eigenvalues: self.kept(&of_modes.eigenvalues),
            effective_masses: None,
            statics: None,
            residues: Vec::new(),
        };
        if of == RatesOf::All {
            let of_shapes = self.solver.shape_rates(modes, &of_modes, [k_rates.as_ref(), m_rates.as_ref()]);
            let of_shapes = of_shapes.map_err(modal(self.scene()))?;
            let masses = self.effective_mass_rates(&of_modes, &of_shapes, &m_rates);
            found.effective_masses = Some(self.kept(&masses));
            if let Some(loads) = &acted.loads {
                let (of_forces, is_known) = self.force_rates(&rates, loads)?;
                let statics = acted.statics.as_ref();
                let statics = statics.map(|answers| self.static_rates(&rates, answers, &of_forces)).transpose()?;
                found.statics = statics.map(|statics| known(statics, &is_known));
                found.residues = known(self.residues(&of_modes, &of_shapes, loads, &of_forces), &is_known);
            }
        }
        Ok(found)
    }

    /// The motions of held nodes that a support allows turn with these: their rates are not known where the nodes move.
    fn refuse_turning_support(&self, parameter: &Parameter, rates: &MatrixRates) -> Result<(), BuildError> {
        let motion = &self.assembled.support.motion;
        if rates.velocities().is_none() || motion.count() == 0 || motion.is_free() {
            return Ok(());
        }
        let found = format!("{} of a body that is held and left a motion", parameter.name);
        let help = "hold it by a clamp, leave it free, or leave the parameter out";
        Err(self.scene().refuse("constraints", found, "a body that is clamped or free", help).into())
    }

    /// Participation factors φᵀM r of translations of the base.
    pub fn factors(&self, shapes: MatRef<'_, f64>) -> Vec<[f64; TRANSLATIONS]> {
        let momenta = self.solver.mass().product(self.translations().as_ref());
        of_columns(&(momenta.transpose() * shapes))
    }

    fn translations(&self) -> Mat<f64> {
        Mat::from_fn(3 * self.mesh().positions().len(), TRANSLATIONS, |row, axis| f64::from(u8::from(row % 3 == axis)))
    }

    /// Rates of the effective masses: 2 Γ (φ'ᵀM r + φᵀM'r).
    fn effective_mass_rates(
        &self,
        of_modes: &ModeRates,
        of_shapes: &Mat<f64>,
        m_rates: &Mat<f64>,
    ) -> Vec<[f64; TRANSLATIONS]> {
        let turned = self.modes.shapes.subcols(0, self.count) * &of_modes.turn;
        let factors = self.factors(turned.as_ref());
        let of_shapes = self.factors(of_shapes.as_ref());
        let of_mass =
            of_columns(&(self.translations().transpose() * (m_rates.subcols(0, self.count) * &of_modes.turn)));
        let rate = |k: usize| std::array::from_fn(|i| 2.0 * factors[k][i] * (of_shapes[k][i] + of_mass[k][i]));
        mean_of_groups((0..self.count).map(rate).collect(), self.repeated)
    }

    /// The loads; none where no point of the output shows what they do.
    pub fn loads(&self) -> Result<Option<Loads>, BuildError> {
        let FeMatrices::Assembled(matrices) = self.matrices else { return Ok(None) };
        if self.points.is_empty() {
            return Ok(None);
        }
        let weight = UnitWeight::of_elements(matrices).map_err(modal(self.scene()))?;
        let list = mesh_load::on_mesh(&self.assembled.needed(), self.mesh(), 3, &Arc::new(weight))?;
        let rows = 3 * self.mesh().positions().len();
        let mut forces = Mat::zeros(rows, list.len());
        for (load, mut forces) in list.iter().zip(forces.col_iter_mut()) {
            let mut of_load = vec![0.0; rows];
            load.add_nodal_forces(&mut of_load);
            forces.copy_from(Col::from_fn(of_load.len(), |row| of_load[row]));
        }
        Ok(Some(Loads { list, forces }))
    }

    pub fn respond(&self, forces: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let answers = self.solver.static_response_from(self.modes, forces, StaticAccuracy::Full);
        answers.map_err(modal(self.scene()))
    }

    /// f' (N×loads) of weights, which follow M, and true for each load whose f' is known: forces on nodes stay.
    fn force_rates(&self, rates: &MatrixRates, loads: &Loads) -> Result<(Mat<f64>, Vec<bool>), BuildError> {
        let [_, weights] = rates.products(self.mesh(), self.translations().as_ref())?;
        let mut forces = Mat::zeros(weights.nrows(), loads.list.len());
        let mut is_known = Vec::new();
        for (k, (load, (_, of_scene))) in loads.list.iter().zip(mesh_load::acting(&self.assembled.needed())).enumerate()
        {
            is_known.push(match &load.action {
                Action::Weight { weight, .. } => {
                    let acceleration = load.unit().unwrap_or_default() * (load.size() / weight.mass);
                    for (axis, acceleration) in acceleration.iter().enumerate() {
                        let force = forces.col(k) + weights.col(axis) * faer::Scale(*acceleration);
                        forces.col_mut(k).copy_from(force);
                    }
                    true
                }
                // Areas and levers change with the places of the nodes, the force at a point does not.
                Action::Force { .. } | Action::Moment { .. } | Action::Field { .. } => match of_scene.kind {
                    LoadKind::Force => true,
                    LoadKind::Moment | LoadKind::Pressure | LoadKind::Traction => rates.velocities().is_none(),
                    LoadKind::Gravity | LoadKind::BaseAcceleration => false,
                },
            });
        }
        Ok((forces, is_known))
    }

    /// u' = K⁻¹ (f' − K'u) of each load at the points.
    fn static_rates(
        &self,
        rates: &MatrixRates,
        answers: &Mat<f64>,
        of_forces: &Mat<f64>,
    ) -> Result<Vec<Vec<Vector3<f64>>>, BuildError> {
        let [strained, _] = rates.products(self.mesh(), answers.as_ref())?;
        Ok(self.at_points(self.respond((of_forces - strained).as_ref())?.as_ref()))
    }

    /// φ (φᵀf) of each load at the points, and φ' (φᵀf) + φ (φ'ᵀf + φᵀf').
    fn residues(
        &self,
        of_modes: &ModeRates,
        of_shapes: &Mat<f64>,
        loads: &Loads,
        of_forces: &Mat<f64>,
    ) -> Vec<Residues> {
        let modes = self.asked;
        let turned = self.modes.shapes.subcols(0, self.count) * &of_modes.turn;
        let [at, rates] = [&turned, of_shapes].map(|fields| self.at_points(fields.subcols(0, modes)));
        let modal = turned.transpose() * &loads.forces;
        let of_modal = of_shapes.transpose() * &loads.forces + turned.transpose() * of_forces;
        let of_load = |l: usize| Residues {
            values: (0..modes).map(|k| at[k].iter().map(|u| u * modal[(k, l)]).collect()).collect(),
            rates: (0..modes)
                .map(|k| {
                    let of_points = at[k].iter().zip(&rates[k]);
                    of_points.map(|(u, rate)| rate * modal[(k, l)] + u * of_modal[(k, l)]).collect()
                })
                .collect(),
        };
        (0..loads.list.len()).map(of_load).collect()
    }
}

/// Values of the loads whose forces have known rates.
fn known<T>(of_loads: Vec<T>, is_known: &[bool]) -> Vec<Option<T>> {
    of_loads.into_iter().zip(is_known).map(|(of_load, is_known)| is_known.then_some(of_load)).collect()
}

/// Three numbers of each column.
fn of_columns(products: &Mat<f64>) -> Vec<[f64; TRANSLATIONS]> {
    (0..products.ncols()).map(|k| std::array::from_fn(|i| products[(i, k)])).collect()
}

/// The same with the mean of each group in the place of its members.
pub(super) fn mean_of_groups(
    mut of_modes: Vec<[f64; TRANSLATIONS]>,
    groups: &[Range<usize>],
) -> Vec<[f64; TRANSLATIONS]> {
    for group in groups {
        let mean =
            |i: usize| of_modes[group.clone()].iter().map(|of_mode| of_mode[i]).sum::<f64>() / group.len() as f64;
        let mean: [f64; TRANSLATIONS] = std::array::from_fn(mean);
        of_modes[group.clone()].fill(mean);
    }
    of_modes
}
