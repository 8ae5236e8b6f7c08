//! Static responses of the whole mesh.

use std::ops::Range;

use advice::StaticCompliance;
use faer::{Col, Mat, MatRef};
use fem_tet10::GeometricTerms;
use modal::Modes;
use nalgebra::Vector3;

use super::error::{BuildError, modal};
use super::loads::MeshLoad;
use super::mesh_model::MeshModel;
use super::spin_stress::SpinStress;
use super::structure::StaticForces;
use super::{physics, turning};

/// Which static responses are asked for.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// To each load.
    pub loads: bool,
    /// To the centrifugal field.
    pub spin: bool,
    /// To the inertia of a driven motion.
    pub drive: bool,
}

impl Asked {
    pub fn any(self) -> bool {
        self.loads || self.spin || self.drive
    }
}

/// Static responses (3n each), side by side; none that are not asked for.
pub(super) struct Statics {
    pub of_loads: Option<OfLoads>,
    pub of_spin: Option<OfSpin>,
    /// To the forces M (1⊗e) of a slide along e, or M (I⊗[a×]) X of a turn about a (3n × 1).
    pub of_drive: Option<Mat<f64>>,
}

/// The answers to the loads in every direction that they may come to have in the body.
pub(super) struct OfLoads {
    pub answers: Mat<f64>,
    /// The work of each load on its answers.
    pub compliances: Vec<StaticCompliance>,
    /// For each load, its columns and [`MeshLoad::turned`].
    columns: Vec<(Range<usize>, Vec<Vector3<f64>>)>,
}

/// The answers to the centrifugal field of each pair of spins (3n × 6).
pub(super) struct OfSpin {
    pub answers: Mat<f64>,
    /// Remainder of each beside the modes (6).
    pub remainders: Vec<f64>,
}

impl Statics {
    /// All static responses that are asked for, from one block of forces.
    pub fn new(model: &MeshModel<'_>, modes: &Modes, origin: &Vector3<f64>, asked: Asked) -> Result<Self, BuildError> {
        if !asked.any() {
            return Ok(Self { of_loads: None, of_spin: None, of_drive: None });
        }
        let &MeshModel { scene, mesh, solver, .. } = model;
        let turning = turning::turning(scene, model.support.motion, model.drive.as_ref());
        let loads = if asked.loads { &model.loads[..] } else { &[] };
        let mut columns = Vec::with_capacity(loads.len());
        let mut of_loads = 0;
        for load in loads {
            let turned = load.turned(turning);
            let count = turned.len().max(1);
            columns.push((of_loads..of_loads + count, turned));
            of_loads += count;
        }
        let unknowns = model.freedoms * mesh.positions().len();
        let mut forces = StaticForces {
            of_loads: Mat::zeros(0, of_loads),
            spin: asked.spin,
            drive: model.drive.as_ref().filter(|_| asked.drive).map(|drive| drive.motion),
            origin: *origin,
        };
        let count = forces.count();
        memory::check("the forces of the loads", 8 * unknowns * count).map_err(|source| modal(scene)(source.into()))?;
        forces.of_loads = Mat::zeros(unknowns, of_loads);
        for (load, (range, turned)) in loads.iter().zip(&columns) {
            for column in range.clone() {
                let forces = forces.of_loads.as_mut().col_mut(column);
                load.add_nodal_forces(turned.get(column - range.start).copied(), forces);
            }
        }
        let answers = solver.static_answers(modes, &forces)?;
        let (driven, of_drive) = (usize::from(forces.drive.is_some()), count - usize::from(forces.drive.is_some()));
        let spins = of_drive - of_loads;
        let to = |first: usize, count: usize| answers.subcols(first, count).to_owned();
        Ok(Self {
            of_loads: asked.loads.then(|| OfLoads {
                answers: to(0, of_loads),
                compliances: compliances(loads, &columns, forces.of_loads.as_ref(), answers.as_ref()),
                columns,
            }),
            of_spin: match asked.spin {
                true => Some(OfSpin {
                    remainders: solver.remainders(modes, answers.subcols(of_loads, spins))?,
                    answers: to(of_loads, spins),
                }),
                false => None,
            },
            of_drive: (driven > 0).then(|| to(of_drive, driven)),
        })
    }

    /// True if there are any.
    pub fn any(&self) -> bool {
        self.of_loads.is_some() || self.of_spin.is_some() || self.of_drive.is_some()
    }

    /// K_ij of each pair of spins in the modes; none where the answers to the spin are not known. `known` are those in the
    /// first of the modes, by all terms and by the initial stress.
    pub fn stress_stiffness(
        &self,
        model: &MeshModel<'_>,
        modes: &Modes,
        known: &[Vec<Mat<f64>>; 2],
    ) -> Result<Option<SpinStress>, BuildError> {
        let Some(of_spin) = &self.of_spin else { return Ok(None) };
        let by = |terms, known| model.solver.stress_stiffness(of_spin.answers.as_ref(), modes, terms, known);
        let all = by(GeometricTerms::All, &known[0])?.try_into().ok();
        let initial = by(GeometricTerms::InitialStress, &known[1])?.try_into().ok();
        Ok(all.zip(initial).map(|(all, initial)| SpinStress::new([all, initial], &modes.eigenvalues)))
    }

    /// The answer to all dead loads together that stay as they are, seen from the body (3n × 1).
    pub fn to_steady_loads(&self, model: &MeshModel<'_>) -> Option<Mat<f64>> {
        let of_loads = self.of_loads.as_ref()?;
        let is_steady = |load: &MeshLoad| {
            !load.follows && physics::is_steady(model.scene, model.support.motion, model.drive.as_ref(), load)
        };
        let mut sum: Option<Mat<f64>> = None;
        for (i, _) in model.loads.iter().enumerate().filter(|(_, load)| is_steady(load)) {
            // A dead load on a body that does not turn has one answer.
            let answer = of_loads.answers_to(i).subcols(0, 1);
            sum = Some(sum.map_or_else(|| answer.to_owned(), |sum| sum + answer));
        }
        sum
    }

    /// The work of each load on its static responses; none where it is not known.
    pub fn compliances(&self) -> &[StaticCompliance] {
        self.of_loads.as_ref().map_or(&[], |of_loads| &of_loads.compliances)
    }

    /// Remainder of the static responses to the spin beside the modes (6); none where it is not known.
    pub fn remainders(&self) -> &[f64] {
        self.of_spin.as_ref().map_or(&[], |of_spin| &of_spin.remainders)
    }

    /// All answers that static shapes are made of.
    pub fn answers(&self) -> impl Iterator<Item = &Mat<f64>> {
        let of_loads = self.of_loads.iter().map(|of_loads| &of_loads.answers);
        of_loads.chain(self.of_spin.iter().map(|of_spin| &of_spin.answers)).chain(&self.of_drive)
    }
}

impl OfLoads {
    /// The answers to a load, in each of its directions.
    pub fn answers_to(&self, load: usize) -> MatRef<'_, f64> {
        let (range, _) = &self.columns[load];
        self.answers.subcols(range.start, range.len())
    }

    /// The forces or moments that a load's answers are combined of as the body turns, see [`MeshLoad::turned`].
    pub fn turned(&self, load: usize) -> &[Vector3<f64>] {
        &self.columns[load].1
    }

    /// The forces or moments that these are the answers to, body axes.
    pub fn vectors(&self, i: usize, load: &MeshLoad) -> Vec<Vector3<f64>> {
        let (_, turned) = &self.columns[i];
        if turned.is_empty() { vec![load.vector().unwrap_or_default()] } else { turned.clone() }
    }
}

/// The work of each load on its answers; the columns of the loads come first in `forces` and `answers`.
fn compliances(
    loads: &[MeshLoad],
    columns: &[(Range<usize>, Vec<Vector3<f64>>)],
    forces: MatRef<'_, f64>,
    answers: MatRef<'_, f64>,
) -> Vec<StaticCompliance> {
    let of = |(load, (range, turned)): (&MeshLoad, &(Range<usize>, Vec<Vector3<f64>>))| {
        let (of, to) = (forces.subcols(range.start, range.len()), answers.subcols(range.start, range.len()));
        let parts = Col::from_iter(load.parts(turned));
        let work = |i: usize| of.col(i).transpose() * to.col(i);
        StaticCompliance {
            at_start: (of * &parts).transpose() * (to * &parts),
            turned: turned.iter().enumerate().map(|(i, vector)| (*vector, work(i))).collect(),
        }
    };
    loads.iter().zip(columns).map(of).collect()
}
