//! Static responses of the whole mesh.

use std::ops::Range;

use advice::StaticCompliance;
use faer::{Col, Mat, MatRef};
use modal::Modes;
use nalgebra::Vector3;

use crate::error::{BuildError, modal};
use crate::load::mesh_load::MeshLoad;
use crate::load::turning;
use crate::reduction::mesh_model::MeshModel;
use crate::structure::StaticForces;
use crate::structure::kept::StaticResponses;
use crate::structure::remainders::Remainders;

/// Which static responses are asked for.
#[derive(Clone, Copy)]
pub(crate) struct Asked {
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
pub(crate) struct Statics {
    pub of_loads: Option<OfLoads>,
    /// To the centrifugal field of each pair of spins (3n × 6).
    pub of_spin: Option<Mat<f64>>,
    /// To the forces M (1⊗e) of a slide along e, or M (I⊗[a×]) X of a turn about a (3n × 1).
    pub of_drive: Option<Mat<f64>>,
    /// Remainders of the spin and of the drive beside the modes.
    pub remainders: Remainders,
}

/// The responses to the loads in every direction that they may come to have in the body.
pub(crate) struct OfLoads {
    /// To amplitudes of 1 or −1: loads that differ in the size of their amplitudes have the same.
    responses: Mat<f64>,
    /// The work of each load on its responses.
    pub compliances: Vec<StaticCompliance>,
    columns: Vec<Columns>,
}

/// The columns of a load in [`OfLoads`], and [`MeshLoad::turned`].
type Columns = (Range<usize>, Vec<Vector3<f64>>);

impl Statics {
    /// All static responses that are asked for, from one block of forces.
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        origin: &Vector3<f64>,
        asked: Asked,
    ) -> Result<Self, BuildError> {
        if !asked.any() {
            return Ok(Self { of_loads: None, of_spin: None, of_drive: None, remainders: Remainders::default() });
        }
        let &MeshModel { scene, mesh, structure, .. } = model;
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
        let unknowns = model.dofs * mesh.positions().len();
        let drive = model.drive.as_ref().filter(|_| asked.drive).map(|drive| drive.motion);
        let of_drive = of_loads + if asked.spin { 6 } else { 0 };
        let count = of_drive + usize::from(drive.is_some());
        memory::check("the forces of the loads", 8 * unknowns * count).map_err(modal(scene))?;
        let mut unit_forces = Mat::zeros(unknowns, of_loads);
        // A load without an amplitude has no response.
        for (load, (range, turned)) in loads.iter().zip(&columns).filter(|(load, _)| load.size() > 0.0) {
            for column in range.clone() {
                let forces = unit_forces.as_mut().col_mut(column);
                load.add_unit_nodal_forces(turned.get(column - range.start).copied(), forces);
            }
        }
        let forces = StaticForces { of_loads: unit_forces.as_ref(), spin: asked.spin, drive, origin: *origin };
        let StaticResponses { fields: responses, remainders } = structure.static_responses(modes, &forces)?;
        let spins = of_drive - of_loads;
        let to = |first: usize, count: usize| responses.subcols(first, count).to_owned();
        Ok(Self {
            of_loads: asked.loads.then(|| OfLoads {
                compliances: compliances(loads, &columns, unit_forces.as_ref(), responses.as_ref()),
                responses: to(0, of_loads),
                columns,
            }),
            of_spin: asked.spin.then(|| to(of_loads, spins)),
            of_drive: drive.is_some().then(|| to(of_drive, 1)),
            remainders: Remainders { of_spin: remainders[..spins].to_vec(), of_drive: remainders.get(spins).copied() },
        })
    }

    /// True if there are any.
    pub fn any(&self) -> bool {
        self.of_loads.is_some() || self.of_spin.is_some() || self.of_drive.is_some()
    }

    /// K_ij of each pair of spins in the modes; none where the responses to the spin are not known. `known` are those in the
    /// first of the modes.
    pub fn stress_stiffness(
        &self,
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        known: &[Mat<f64>],
    ) -> Result<Option<[Mat<f64>; 6]>, BuildError> {
        let Some(of_spin) = &self.of_spin else { return Ok(None) };
        Ok(model.structure.stress_stiffness(of_spin.as_ref(), modes, known)?.try_into().ok())
    }

    /// The responses without their parts along some modes: what stresses the body whatever these do.
    pub fn without_parts(&self, model: &MeshModel<'_, '_>, modes: &Modes, list: &[usize]) -> Result<Self, BuildError> {
        let freed = |fields: &Mat<f64>| model.structure.without_parts(modes, list, fields.as_ref());
        Ok(Self {
            of_loads: match &self.of_loads {
                Some(of_loads) => Some(OfLoads {
                    responses: freed(&of_loads.responses)?,
                    compliances: of_loads.compliances.clone(),
                    columns: of_loads.columns.clone(),
                }),
                None => None,
            },
            of_spin: self.of_spin.as_ref().map(freed).transpose()?,
            of_drive: self.of_drive.as_ref().map(freed).transpose()?,
            remainders: self.remainders.clone(),
        })
    }

    /// The work of each load on its static responses; none where it is not known.
    pub fn compliances(&self) -> &[StaticCompliance] {
        self.of_loads.as_ref().map_or(&[], |of_loads| &of_loads.compliances)
    }

    /// All responses that static shapes are made of, of whatever size.
    pub fn responses(&self) -> impl Iterator<Item = &Mat<f64>> {
        let of_loads = self.of_loads.iter().map(|of_loads| &of_loads.responses);
        of_loads.chain(&self.of_spin).chain(&self.of_drive)
    }
}

impl OfLoads {
    /// The responses to a load of an amplitude of 1 or −1, in each of its directions.
    pub fn of_unit(&self, load: usize) -> MatRef<'_, f64> {
        let (range, _) = &self.columns[load];
        self.responses.subcols(range.start, range.len())
    }

    /// The forces or moments that a load is combined of as the body turns, see [`MeshLoad::turned`].
    pub fn turned(&self, load: usize) -> &[Vector3<f64>] {
        &self.columns[load].1
    }

    /// The forces or moments that these are the responses to, body axes.
    pub fn vectors(&self, i: usize, load: &MeshLoad) -> Vec<Vector3<f64>> {
        let (_, turned) = &self.columns[i];
        if turned.is_empty() { vec![load.unit().unwrap_or_default()] } else { turned.clone() }
    }
}

/// The work of each load on its responses. The columns of the loads, of amplitudes of 1 or −1, come first in `forces` and
/// `responses`.
fn compliances(
    loads: &[MeshLoad],
    columns: &[Columns],
    forces: MatRef<'_, f64>,
    responses: MatRef<'_, f64>,
) -> Vec<StaticCompliance> {
    let of = |(load, (range, turned)): (&MeshLoad, &Columns)| {
        let (of, to) = (forces.subcols(range.start, range.len()), responses.subcols(range.start, range.len()));
        let parts = Col::from_iter(load.parts(turned));
        let size = load.size();
        let work = |i: usize| of.col(i).transpose() * to.col(i);
        let along = |(i, unit): (usize, &Vector3<f64>)| (unit * size, size * size * work(i));
        StaticCompliance {
            at_start: size * size * ((of * &parts).transpose() * (to * &parts)),
            turned: turned.iter().enumerate().map(along).collect(),
        }
    };
    loads.iter().zip(columns).map(of).collect()
}
