//! A body whose materials and masses vary on a mesh that stays.

use std::sync::Arc;

use fem_tet10::{BodyNumber, Location, Mesh, stretch};
use modal::ModalError;
use scene::{Body, Measured, MeshedBody};

use crate::building::assembly::{Assembled, AssembledMesh};
use crate::building::builder::Builder;
use crate::building::progress::BuildProgress;
use crate::error::{BuildError, modal, refuse, too_many_modes};
use crate::gradient::at::{Acted, At, mean_of_groups};
use crate::gradient::parameter::{Parameter, meshed};
use crate::gradient::rates::{BodyRates, RatesOf};
use crate::load::mesh_load;
use crate::mesh::fe_matrices::FeMatrices;
use crate::mesh::read::matrices;
use crate::reduction::measured::{Seen, matched};
use crate::reduction::modal_model::peak;

/// Modes beyond those that are asked for: a group of modes of one frequency is not cut, and the rates of shapes come sooner.
pub(super) const BEYOND: usize = 4;

/// A body of a scene whose numbers may vary.
pub struct VariedBody {
    assembled: Arc<AssembledMesh>,
    /// The mesh, which may be stretched.
    mesh: Arc<Mesh>,
    body: MeshedBody,
    points: Vec<Location>,
    modes: usize,
}

impl Builder {
    /// The body of a scene, to be changed in its numbers.
    ///
    /// # Errors
    /// [`BuildError`]; a body that is not made of elements, or whose modes are about a bent one.
    pub fn varied(&self, given: &Body, progress: impl FnMut(BuildProgress)) -> Result<VariedBody, BuildError> {
        let body = meshed(given)?.clone();
        let needed = self.needed(given);
        let modes = needed.modes.flexible.most();
        let refuse_at = |key: &str, found: &str, expected: &str, help: &str| given.refuse(key, found, expected, help);
        if modes == 0 {
            return Err(
                refuse_at("modes.flexible", "no modes", "one flexible mode or more", "keep flexible modes").into()
            );
        }
        if needed.modes.about.is_some() {
            let found = "modes about a bent body, whose rates are not known";
            return Err(refuse_at("modes.about", found, "modes about the undeformed body", "leave it out").into());
        }
        let Assembled::Meshed(assembled) = self.assemble(given, progress)?.0 else {
            return Err(refuse_at("body", "a rigid body", "a body with a mesh", "give the body a mesh").into());
        };
        let locate = |(name, at): (&String, &[f64; 3])| {
            let key = scene::key_path("output.points", name);
            assembled.mesh.locate(*at).map_err(|error| refuse(given, &key, error))
        };
        let points = given.output.points.iter().map(locate).collect::<Result<_, _>>()?;
        let assembled_mesh = Arc::clone(&assembled.mesh);
        let (assembled, mesh) = (Arc::from(assembled), assembled_mesh);
        Ok(VariedBody { assembled, mesh, body, points, modes })
    }
}

impl VariedBody {
    /// The body as the scene has it.
    pub fn body(&self) -> &MeshedBody {
        &self.body
    }

    pub(super) fn points(&self) -> &[Location] {
        &self.points
    }

    pub(super) fn assembled(&self) -> &AssembledMesh {
        &self.assembled
    }

    /// The same body with the mesh stretched by a factor for each of some parameters, which are stretches: its nodes moved by the sum of what each
    /// does to the mesh of the scene. Points and point masses, with the numbers of `body`, stay on their material.
    ///
    /// # Errors
    /// [`BuildError`] of elements that do not survive it, and of point masses that are spread over a radius.
    pub fn stretched(&self, meshed: &MeshedBody, factors: &[(&Parameter, f64)]) -> Result<Self, BuildError> {
        let (scene, first) = (self.scene(), &self.assembled.mesh);
        let mut parts = first.parts();
        for (parameter, factor) in factors {
            let BodyNumber::Stretch(group, axis) = &parameter.number else { continue };
            let velocities = stretch(first, group.as_deref(), *axis)?;
            for (x, v) in parts.positions.iter_mut().zip(velocities) {
                x.iter_mut().zip(v).for_each(|(x, v)| *x += (factor - 1.0) * v);
            }
        }
        let mut meshed = meshed.clone();
        for (i, mass) in meshed.point_masses.iter_mut().enumerate() {
            let key = format!("body.point_masses[{i}]");
            if mass.spread.is_some() {
                let found = "a mass that nodes within a radius carry, in a mesh that is stretched";
                let help = "leave `spread` out, or the thickness";
                return Err(scene.refuse(&key, found, "masses at points", help).into());
            }
            let Location { nodes, weights } =
                first.locate(mass.at).map_err(|error| refuse(scene, &format!("{key}.at"), error))?;
            let carriers = || nodes.iter().zip(&weights);
            mass.at = std::array::from_fn(|k| carriers().map(|(node, w)| w * parts.positions[*node as usize][k]).sum());
        }
        let mesh = Arc::new(Mesh::new(parts)?);
        let (assembled, points, modes) = (Arc::clone(&self.assembled), self.points.clone(), self.modes);
        Ok(Self { assembled, mesh, body: meshed, points, modes })
    }

    /// The scene.
    pub fn scene(&self) -> &Body {
        &self.assembled.scene
    }

    /// Names of the loads that act, in the order of static answers.
    pub fn load_names(&self) -> Vec<String> {
        mesh_load::acting(&self.assembled.needed()).map(|(i, _)| format!("loads[{i}]")).collect()
    }

    /// Frequencies, and what else is asked for, of a body with other numbers, with their rates.
    ///
    /// # Errors
    /// [`BuildError`] of numbers out of their range, and of the modes.
    pub fn rates(&self, meshed: &MeshedBody, parameters: &[Parameter], of: RatesOf) -> Result<BodyRates, BuildError> {
        let (AssembledMesh { support, scene, .. }, mesh) = (&*self.assembled, &*self.mesh);
        let matrices = FeMatrices::Assembled(matrices(scene, meshed, mesh)?);
        let solver = self.assembled.solver(&matrices, mesh.positions()).map_err(modal(scene))?;
        if self.modes > solver.available() {
            let (requested, available) = (self.modes, solver.available());
            return Err(too_many_modes(scene, ModalError::TooManyModes { requested, available }));
        }
        let searched = (self.modes + BEYOND.max(self.modes / 2)).min(solver.available());
        let modes = solver.modes(searched, |_| ()).map_err(modal(scene))?;
        let count = modes.whole(self.modes);
        let repeated = modes.repeated(count);
        let at = At {
            assembled: &self.assembled,
            mesh,
            points: &self.points,
            body: meshed,
            matrices: &matrices,
            solver: &solver,
            modes: &modes,
            asked: self.modes,
            count,
            repeated: &repeated,
        };
        let loads = if of == RatesOf::All { at.loads()? } else { None };
        let statics = match &loads {
            Some(loads) if support.motion.count() == 0 => Some(at.respond(loads.forces.as_ref())?),
            _ => None,
        };
        let acted = Acted { loads, statics };
        let rates = parameters.iter().map(|parameter| at.with(parameter, of, &acted)).collect::<Result<_, _>>()?;
        let effective_masses = (of == RatesOf::All).then(|| {
            let factors = at.factors(modes.shapes.subcols(0, count));
            at.kept(&mean_of_groups(factors.iter().map(|of_mode| of_mode.map(|f| f * f)).collect(), &repeated))
        });
        Ok(BodyRates {
            frequencies: modes.natural_frequencies()[..self.modes].to_vec(),
            shapes: at.at_points(modes.shapes.subcols(0, self.modes)),
            peaks: modes.shapes.subcols(0, self.modes).col_iter().map(|shape| peak(shape, 3)).collect(),
            effective_masses,
            statics: acted.statics.as_ref().map(|answers| at.at_points(answers.as_ref())),
            modal_forces: acted.loads.as_ref().map_or_else(Vec::new, |loads| {
                let forces = modes.shapes.subcols(0, self.modes).transpose() * &loads.forces;
                forces.col_iter().map(|of_load| of_load.iter().copied().collect()).collect()
            }),
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
}
