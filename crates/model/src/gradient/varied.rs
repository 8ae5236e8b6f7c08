//! A body whose materials and masses vary on a mesh that stays.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use faer::{Col, ColRef, Mat, MatRef};
use fem_tet10::{Location, MatrixRates, Mesh};
use modal::{ModalError, ModeRates, Modes, NodalMass, Solver, StaticAccuracy};
use nalgebra::Vector3;
use scene::{Load, Measured, MeshedBody, Scene};

use crate::building::assembly::{Assembled, AssembledMesh};
use crate::building::builder::Builder;
use crate::building::progress::BuildProgress;
use crate::error::{BuildError, modal, refuse, too_many_modes};
use crate::gradient::parameter::{Parameter, meshed};
use crate::gradient::rates::{BodyRates, ParameterRates, RatesOf, TRANSLATIONS};
use crate::load::mesh_load::{self, Action, MeshLoad, UnitWeight};
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::read::matrices;
use crate::reduction::measured::{Seen, matched};

/// Modes beyond those that are asked for: a group of modes of one frequency is not cut, and the rates of shapes come sooner.
const BEYOND: usize = 4;

/// A body of a scene whose numbers may vary.
pub struct VariedBody {
    assembled: Box<AssembledMesh>,
    body: MeshedBody,
    points: Vec<Location>,
    modes: usize,
}

impl Builder {
    /// The body of a scene, to be changed in its numbers.
    ///
    /// # Errors
    /// [`BuildError`]; a body that is not made of elements, or whose modes are about a bent one.
    pub fn varied(&self, scene: &Scene, progress: impl FnMut(BuildProgress)) -> Result<VariedBody, BuildError> {
        let body = meshed(scene)?.clone();
        let modes = scene.modes.flexible.most();
        let refuse_at = |key: &str, found: &str, expected: &str, help: &str| scene.refuse(key, found, expected, help);
        if modes == 0 {
            return Err(
                refuse_at("modes.flexible", "no modes", "one flexible mode or more", "keep flexible modes").into()
            );
        }
        if scene.modes.about.is_some() {
            let found = "modes about a bent body, whose rates are not known";
            return Err(refuse_at("modes.about", found, "modes about the undeformed body", "leave it out").into());
        }
        let Assembled::Meshed(assembled) = self.assemble(scene, progress)?.0 else {
            return Err(refuse_at("body", "a rigid body", "a body with a mesh", "give the body a mesh").into());
        };
        let locate = |(name, at): (&String, &[f64; 3])| {
            let key = scene::key_path("output.points", name);
            assembled.mesh.locate(*at).map_err(|error| refuse(scene, &key, error))
        };
        let points = scene.output.points.iter().map(locate).collect::<Result<_, _>>()?;
        Ok(VariedBody { assembled, body, points, modes })
    }
}

impl VariedBody {
    /// The body as the scene has it.
    pub fn body(&self) -> &MeshedBody {
        &self.body
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.assembled.scene
    }

    /// Names of the loads that act, in the order of static answers.
    pub fn load_names(&self) -> Vec<String> {
        mesh_load::acting(self.scene()).map(|(i, _)| format!("loads[{i}]")).collect()
    }

    /// Frequencies, and what else is asked for, of a body with other numbers, with their rates.
    ///
    /// # Errors
    /// [`BuildError`] of numbers out of their range, and of the modes.
    pub fn rates(&self, body: &MeshedBody, parameters: &[Parameter], of: RatesOf) -> Result<BodyRates, BuildError> {
        let AssembledMesh { mesh, support, scene, .. } = &*self.assembled;
        let matrices = FeMatrices::Assembled(matrices(scene, body, mesh)?);
        let solver = matrices.solver(mesh.positions(), support).map_err(modal(scene))?;
        let solver = match mesh.edge_ends() {
            Some(ends) => solver.with_edge_ends(ends).map_err(modal(scene))?,
            None => solver,
        };
        let solver = match &self.assembled.builder.solver {
            Some(slepc) => solver.with_engine(slepc.engine()),
            None => solver,
        };
        if self.modes > solver.available() {
            let (requested, available) = (self.modes, solver.available());
            return Err(too_many_modes(scene, ModalError::TooManyModes { requested, available }));
        }
        let searched = (self.modes + BEYOND.max(self.modes / 2)).min(solver.available());
        let modes = solver.modes(searched, |_| ()).map_err(modal(scene))?;
        let count = modes.whole(self.modes);
        let repeated = modes.repeated(count);
        let at =
            At { varied: self, body, matrices: &matrices, solver: &solver, modes: &modes, count, repeated: &repeated };
        let statics = match of {
            RatesOf::All if support.motion.count() == 0 => at.statics()?,
            _ => None,
        };
        let rates =
            parameters.iter().map(|parameter| at.with(parameter, of, statics.as_ref())).collect::<Result<_, _>>()?;
        let effective_masses = (of == RatesOf::All).then(|| {
            let factors = at.factors(modes.shapes.subcols(0, count));
            self.kept(&mean_of_groups(factors.iter().map(|of_mode| of_mode.map(|f| f * f)).collect(), &repeated))
        });
        Ok(BodyRates {
            frequencies: modes.natural_frequencies()[..self.modes].to_vec(),
            shapes: self.at_points(modes.shapes.subcols(0, self.modes)),
            peaks: modes.shapes.subcols(0, self.modes).col_iter().map(largest).collect(),
            effective_masses,
            statics: statics.as_ref().map(|statics| self.at_points(statics.answers.as_ref())),
            rates,
            repeated,
        })
    }

    /// The modes that measured ones are, by number from 0: by their shapes at points of the output, or by their order.
    ///
    /// # Errors
    /// The refusal of a table that does not fit.
    pub fn matched(&self, measured: &Measured, found: &BodyRates) -> Result<Vec<usize>, BuildError> {
        let displacement = |point: usize, axis: usize, mode: usize| found.shapes[mode][point][axis];
        let points = self.scene().output.points.keys().map(String::as_str).collect();
        let natural = found.frequencies.len();
        matched(self.scene(), measured, &Seen { natural, points, displacement: &displacement, peaks: &found.peaks })
    }

    /// Displacements (N×k) at the points, by column.
    fn at_points(&self, fields: MatRef<'_, f64>) -> Vec<Vec<Vector3<f64>>> {
        let at = |point: &Location, column: usize| {
            let of = point.nodes.iter().zip(&point.weights);
            let u = |node: u32| Vector3::from_fn(|axis, _| fields[(3 * node as usize + axis, column)]);
            of.map(|(node, weight)| u(*node) * *weight).sum::<Vector3<f64>>()
        };
        (0..fields.ncols()).map(|column| self.points.iter().map(|point| at(point, column)).collect()).collect()
    }

    /// Those of the modes that were asked for.
    fn kept<T: Clone>(&self, of_modes: &[T]) -> Vec<T> {
        of_modes[..self.modes.min(of_modes.len())].to_vec()
    }
}

/// Static answers to the loads.
struct Statics {
    loads: Vec<MeshLoad>,
    answers: Mat<f64>,
}

/// A body with its numbers.
struct At<'a> {
    varied: &'a VariedBody,
    body: &'a MeshedBody,
    matrices: &'a FeMatrices,
    solver: &'a Solver<'a>,
    modes: &'a Modes,
    count: usize,
    repeated: &'a [Range<usize>],
}

impl At<'_> {
    fn scene(&self) -> &Scene {
        self.varied.scene()
    }

    fn mesh(&self) -> &Mesh {
        &self.varied.assembled.mesh
    }

    /// Rates with a parameter.
    fn with(
        &self,
        parameter: &Parameter,
        of: RatesOf,
        statics: Option<&Statics>,
    ) -> Result<ParameterRates, BuildError> {
        let (mesh, modes) = (self.mesh(), self.modes);
        let MeshedBody { materials, point_masses, .. } = self.body;
        let rates = MatrixRates::new(mesh, materials, point_masses, &parameter.number)?;
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
            frequencies: self.varied.kept(&frequencies),
            shapes: None,
            effective_masses: None,
            statics: None,
        };
        if of == RatesOf::All {
            let of_shapes = self.solver.shape_rates(modes, &of_modes, [k_rates.as_ref(), m_rates.as_ref()]);
            let of_shapes = of_shapes.map_err(modal(self.scene()))?;
            found.shapes = Some(self.varied.at_points(of_shapes.subcols(0, self.varied.modes)));
            let masses = self.effective_mass_rates(&of_modes, &of_shapes, &m_rates);
            found.effective_masses = Some(self.varied.kept(&masses));
            found.statics = statics.map(|statics| self.static_rates(&rates, statics)).transpose()?;
        }
        Ok(found)
    }

    /// The motions of held nodes that a support allows turn with these: their rates are not known where the nodes move.
    fn refuse_turning_support(&self, parameter: &Parameter, rates: &MatrixRates) -> Result<(), BuildError> {
        let motion = &self.varied.assembled.support.motion;
        if rates.velocities().is_none() || motion.count() == 0 || motion.is_free() {
            return Ok(());
        }
        let found = format!("{} of a body that is held and left a motion", parameter.name);
        let help = "hold it by a clamp, leave it free, or leave the parameter out";
        Err(self.scene().refuse("constraints", found, "a body that is clamped or free", help).into())
    }

    /// Participation factors φᵀM r of translations of the base.
    fn factors(&self, shapes: MatRef<'_, f64>) -> Vec<[f64; TRANSLATIONS]> {
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

    /// Static answers to the loads.
    fn statics(&self) -> Result<Option<Statics>, BuildError> {
        let FeMatrices::Assembled(matrices) = self.matrices else { return Ok(None) };
        if self.varied.points.is_empty() {
            return Ok(None);
        }
        let mass = NodalMass::of_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes());
        let masses = mass.map_err(modal(self.scene()))?.row_sums();
        let weights = Mat::from_fn(masses.len(), 1, |node, _| masses[node]);
        let loads = mesh_load::on_mesh(self.scene(), self.mesh(), 3, &Arc::new(UnitWeight::new(weights, 3)))?;
        let mut forces = Mat::zeros(3 * masses.len(), loads.len());
        for (load, mut forces) in loads.iter().zip(forces.col_iter_mut()) {
            let mut of_load = vec![0.0; 3 * masses.len()];
            load.add_nodal_forces(&mut of_load);
            forces.copy_from(Col::from_fn(of_load.len(), |row| of_load[row]));
        }
        let answers = self.respond(forces.as_ref())?;
        Ok(Some(Statics { loads, answers }))
    }

    fn respond(&self, forces: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let answers = self.solver.static_response_from(self.modes, forces, StaticAccuracy::Full);
        Ok(answers.map_err(modal(self.scene()))?)
    }

    /// u' = K⁻¹ (f' − K'u) of each load, where f' is known: forces on nodes stay, and weights follow M.
    fn static_rates(
        &self,
        rates: &MatrixRates,
        statics: &Statics,
    ) -> Result<Vec<Option<Vec<Vector3<f64>>>>, BuildError> {
        let Statics { loads, answers } = statics;
        let [mut forces, _] = rates.products(self.mesh(), answers.as_ref())?;
        forces *= faer::Scale(-1.0);
        let [_, weights] = rates.products(self.mesh(), self.translations().as_ref())?;
        let mut is_known = Vec::new();
        for (k, (load, (_, of_scene))) in loads.iter().zip(mesh_load::acting(self.scene())).enumerate() {
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
                _ => rates.velocities().is_none() || matches!(of_scene, Load::Force(_)),
            });
        }
        let of_loads = self.varied.at_points(self.respond(forces.as_ref())?.as_ref());
        Ok(of_loads.into_iter().zip(is_known).map(|(rates, is_known)| is_known.then_some(rates)).collect())
    }
}

/// The largest displacement of a node.
fn largest(shape: ColRef<'_, f64>) -> f64 {
    let squared = |node: usize| (0..3).map(|axis| shape[3 * node + axis].powi(2)).sum::<f64>();
    (0..shape.nrows() / 3).map(squared).fold(0.0, f64::max).sqrt()
}

/// Three numbers of each column.
fn of_columns(products: &Mat<f64>) -> Vec<[f64; TRANSLATIONS]> {
    (0..products.ncols()).map(|k| std::array::from_fn(|i| products[(i, k)])).collect()
}

/// The same with the mean of each group in the place of its members.
fn mean_of_groups(mut of_modes: Vec<[f64; TRANSLATIONS]>, groups: &[Range<usize>]) -> Vec<[f64; TRANSLATIONS]> {
    for group in groups {
        let mean =
            |i: usize| of_modes[group.clone()].iter().map(|of_mode| of_mode[i]).sum::<f64>() / group.len() as f64;
        let mean: [f64; TRANSLATIONS] = std::array::from_fn(mean);
        of_modes[group.clone()].fill(mean);
    }
    of_modes
}
