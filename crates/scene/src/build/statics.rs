//! Static answers of the whole mesh.

use advice::StaticCompliance;
use faer::{Col, ColRef, Mat, MatRef};
use modal::{Modes, centrifugal_fields};
use nalgebra::Vector3;

use super::error::{BuildError, modal};
use super::loads::MeshLoad;
use super::mesh_model::MeshModel;
use super::{physics, turning};

/// Which static answers are asked for.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// To each load.
    pub loads: bool,
    /// To the centrifugal field.
    pub spin: bool,
    /// To the steady loads together.
    pub steady: bool,
}

impl Asked {
    pub fn any(self) -> bool {
        self.loads || self.spin || self.steady
    }
}

/// Static answers (3n each), side by side; none that are not asked for.
pub(super) struct Statics {
    pub of_loads: Option<OfLoads>,
    pub of_spin: Option<OfSpin>,
    /// To the loads of [`steady_loads`] together (3n × 1).
    pub of_steady: Option<Mat<f64>>,
}

/// The answers to the loads in every direction that they may come to have in the body.
pub(super) struct OfLoads {
    pub answers: Mat<f64>,
    /// The work of each load on its answers.
    pub compliances: Vec<StaticCompliance>,
}

/// The answers to the centrifugal field of each pair of spins (3n × 6).
pub(super) struct OfSpin {
    pub answers: Mat<f64>,
    /// What the modes leave out of each (6).
    pub remainders: Vec<f64>,
}

/// The loads whose stress may stiffen the body: those that stay as they are, seen from the body.
pub(super) fn steady_loads<'a>(model: &'a MeshModel<'_>) -> Vec<&'a MeshLoad> {
    let steady = |load: &&MeshLoad| physics::stiffens(model.scene, model.support.motion, model.drive.as_ref(), load);
    model.loads.iter().filter(steady).collect()
}

impl Statics {
    /// All static answers that are asked for, from one block of forces.
    pub fn new(model: &MeshModel<'_>, modes: &Modes, origin: &Vector3<f64>, asked: Asked) -> Result<Self, BuildError> {
        if !asked.any() {
            return Ok(Self { of_loads: None, of_spin: None, of_steady: None });
        }
        let &MeshModel { scene, mesh, solver, .. } = model;
        let turning = turning::turning(scene, model.support.motion, model.drive.as_ref());
        let loads = if asked.loads { &model.loads[..] } else { &[] };
        let turned: Vec<Vec<Vector3<f64>>> = loads.iter().map(|load| load.turned(turning)).collect();
        let columns = Columns::new(loads, &turned, if asked.steady { steady_loads(model) } else { Vec::new() });
        let (of_loads, of_all_loads) = (columns.of_loads, columns.sums.len());
        let fields = asked.spin.then(|| centrifugal_fields(solver.mass(), mesh.positions(), origin));
        let spins = fields.as_ref().map_or(0, Mat::ncols);

        let unknowns = 3 * mesh.positions().len();
        memory::check("the forces of the loads", 8 * unknowns * (of_all_loads + spins))
            .map_err(|source| modal(scene)(source.into()))?;
        let mut forces = Mat::zeros(unknowns, of_all_loads + spins);
        columns.add_to(&mut forces);
        if let Some(fields) = &fields {
            forces.as_mut().subcols_mut(of_all_loads, spins).copy_from(fields);
        }
        let answers = solver.static_response(forces.as_ref()).map_err(modal(scene))?;
        let to = |first: usize, count: usize| answers.subcols(first, count).to_owned();
        Ok(Self {
            of_loads: asked.loads.then(|| OfLoads {
                answers: to(0, of_loads),
                compliances: compliances(loads, &turned, forces.as_ref(), answers.as_ref()),
            }),
            of_spin: asked.spin.then(|| OfSpin {
                answers: to(of_all_loads, spins),
                remainders: remainders(model, modes, answers.subcols(of_all_loads, spins)),
            }),
            of_steady: asked.steady.then(|| to(of_loads, 1)),
        })
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        self.of_loads.is_some() || self.of_spin.is_some() || self.of_steady.is_some()
    }

    /// K_ij of each pair of spins in the modes; none where the answers to the spin are not known.
    pub fn stress_stiffness(&self, model: &MeshModel<'_>, modes: &Modes) -> Result<Option<[Mat<f64>; 6]>, BuildError> {
        let Some(of_spin) = &self.of_spin else { return Ok(None) };
        Ok(model.stress_stiffness(of_spin.answers.as_ref(), modes)?.try_into().ok())
    }

    /// The work of each load on its static answers; none where it is not known.
    pub fn compliances(&self) -> &[StaticCompliance] {
        self.of_loads.as_ref().map_or(&[], |of_loads| &of_loads.compliances)
    }

    /// What the modes leave out of the static answers to the spin (6); none where it is not known.
    pub fn remainders(&self) -> &[f64] {
        self.of_spin.as_ref().map_or(&[], |of_spin| &of_spin.remainders)
    }
}

/// A load, and another force or moment in the place of its own.
type Acting<'a> = (&'a MeshLoad, Option<Vector3<f64>>);

/// The loads that each column of forces is the sum of.
struct Columns<'a> {
    sums: Vec<Vec<Acting<'a>>>,
    /// How many of them are of single loads.
    of_loads: usize,
}

impl<'a> Columns<'a> {
    /// A column for each load and direction that it may turn to, and one for all `steady` loads if there are any.
    fn new(loads: &'a [MeshLoad], turned: &[Vec<Vector3<f64>>], steady: Vec<&'a MeshLoad>) -> Self {
        let mut sums: Vec<Vec<Acting<'a>>> = Vec::new();
        for (load, turned) in loads.iter().zip(turned) {
            match turned[..] {
                [] => sums.push(vec![(load, None)]),
                _ => sums.extend(turned.iter().map(|vector| vec![(load, Some(*vector))])),
            }
        }
        let of_loads = sums.len();
        if !steady.is_empty() {
            sums.push(steady.into_iter().map(|load| (load, None)).collect());
        }
        Self { sums, of_loads }
    }

    fn add_to(&self, forces: &mut Mat<f64>) {
        for (i, loads) in self.sums.iter().enumerate() {
            for (load, vector) in loads {
                load.add_nodal_forces(*vector, forces.as_mut().col_mut(i));
            }
        }
    }
}

/// The work of each load on its answers; the columns of the loads come first in `forces` and `answers`.
fn compliances(
    loads: &[MeshLoad],
    turned: &[Vec<Vector3<f64>>],
    forces: MatRef<'_, f64>,
    answers: MatRef<'_, f64>,
) -> Vec<StaticCompliance> {
    let mut first = 0;
    let of = |(load, turned): (&MeshLoad, &Vec<Vector3<f64>>)| {
        let columns = turned.len().max(1);
        let (of, to) = (forces.subcols(first, columns), answers.subcols(first, columns));
        first += columns;
        let parts = Col::from_iter(load.parts(turned));
        let work = |i: usize| of.col(i).transpose() * to.col(i);
        StaticCompliance {
            at_start: (of * &parts).transpose() * (to * &parts),
            turned: turned.iter().enumerate().map(|(i, vector)| (*vector, work(i))).collect(),
        }
    };
    loads.iter().zip(turned).map(of).collect()
}

/// √(uᵀMu − Σ(Φ_kᵀMu)²) of each answer u.
fn remainders(model: &MeshModel<'_>, modes: &Modes, answers: MatRef<'_, f64>) -> Vec<f64> {
    let momenta = model.solver.mass().product(answers);
    let of = |(u, mu): (ColRef<'_, f64>, ColRef<'_, f64>)| {
        let carried: f64 = modes.shapes.as_ref().col_iter().map(|shape| (shape.transpose() * mu).powi(2)).sum();
        (u.transpose() * mu - carried).max(0.0).sqrt()
    };
    answers.col_iter().zip(momenta.as_ref().col_iter()).map(of).collect()
}
