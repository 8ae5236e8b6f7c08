//! The bent body that modes are about: the rest of the full body in a steady spin and under steady loads.
//!
//! ```text
//! f_int(u₀) = f + M W (X + u₀)        K → K_T(u₀),   X → X + u₀
//! ```
//!
//! Eqs. (B1)–(B4) of `docs/method/reference.md`. It takes the place of the undeformed body in all that follows: modes, static
//! responses, large and following modes, constants of the motion.

use std::borrow::Cow;
use std::sync::Arc;

use dynamics::DrivenMotion;
use faer::{ColMut, Mat};
use fem_tet10::FiniteStrain;
use keys::Hash;
use modal::{Modes, ReducedBody};
use nalgebra::Vector3;
use nonlinear::{EquilibriumSettings, ExternalForces, FullBody, NonlinearError, equilibrium};
use scene::{About, SceneError};

use crate::building::assembly::AssembledMesh;
use crate::error::BuildError;
use crate::load::directed::Directed;
use crate::load::mesh_load::{self, Action, MeshLoad, UnitWeight};
use crate::mesh::fe_matrices::FeMatrices;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::physics;

/// Largest displacement over the length of the body from which `"auto"` takes modes about the bent body: below it, large modes
/// are as good.
const FAR: f64 = 0.05;
const KEY: &str = "modes.about";

/// A spin and loads that stay as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Steady {
    /// Body axes.
    pub omega_body: Vector3<f64>,
    /// True if the steady loads act.
    pub loads: bool,
}

/// The bent body.
#[derive(Debug)]
pub(crate) struct Reference {
    pub steady: Steady,
    /// u₀ (3n×1).
    pub displacement: Mat<f64>,
    /// f_int(u₀) (3n×1).
    pub forces: Mat<f64>,
    /// X + u₀ of each node.
    pub positions: Vec<[f64; 3]>,
    pub hash: Hash,
}

impl Reference {
    /// The one that the scene of a body asks for, if any.
    pub fn new(assembled: &AssembledMesh) -> Result<Option<Self>, BuildError> {
        let scene = &assembled.scene;
        let Some(about) = scene.modes.about else { return Ok(None) };
        if let Err(refusal) = fits(assembled) {
            return if about == About::Auto { Ok(None) } else { Err(refusal.into()) };
        }
        let Some(steady) = steady(assembled, about)? else { return Ok(None) };
        let nodes = assembled.mesh.positions().len();
        let found = match &assembled.store {
            None => found(assembled, steady)?,
            Some(store) => {
                let key = store.key().of("reference", 1).with("support", &assembled.support);
                let key = key.with("spin", &steady.omega_body);
                let loads = if steady.loads {
                    format!("{:?} {:?}", scene.loads, scene.initial.attitude)
                } else {
                    String::new()
                };
                let key = key.with("loads", &*loads).finish();
                match store.recall(&key, 6 * nodes)? {
                    Some(found) => found,
                    None => {
                        let found = found(assembled, steady)?;
                        store.keep(&key, &found);
                        found
                    }
                }
            }
        };
        let (displacement, forces) = found.split_at(3 * nodes);
        let moved = |(x, u): (&[f64; 3], &[f64])| [x[0] + u[0], x[1] + u[1], x[2] + u[2]];
        let reference = Self {
            steady,
            positions: assembled.mesh.positions().iter().zip(displacement.chunks_exact(3)).map(moved).collect(),
            hash: Hash::of(displacement),
            displacement: Mat::from_fn(3 * nodes, 1, |row, _| displacement[row]),
            forces: Mat::from_fn(3 * nodes, 1, |row, _| forces[row]),
        };
        let is_far = reference.largest() >= FAR * assembled.mesh.diagonal();
        Ok((about != About::Auto || is_far).then_some(reference))
    }

    /// Largest displacement of a node.
    fn largest(&self) -> f64 {
        let size = |node: usize| Vector3::from_fn(|axis, _| self.displacement[(3 * node + axis, 0)]).norm();
        (0..self.positions.len()).map(size).fold(0.0, f64::max)
    }

    /// Mass, and the stiffness K_T of the bent body.
    pub fn tangent(&self, assembled: &AssembledMesh) -> Result<FeMatrices, BuildError> {
        let FeMatrices::Assembled(matrices) = assembled.matrices()? else { return Err(assembled.without_elements()) };
        let strain = FiniteStrain::new(Arc::clone(&assembled.mesh), assembled.materials()?)?;
        let u: Vec<f64> = self.displacement.col(0).iter().copied().collect();
        Ok(FeMatrices::Assembled(matrices.with_stiffness(strain.stiffness(&u, &strain.stresses(&u), matrices))))
    }

    /// Ψᵀ f_int(u₀) of some shapes.
    pub fn modal_forces(&self, modes: &Modes) -> Vec<f64> {
        let forces = modes.shapes.transpose() * &self.forces;
        forces.col(0).iter().copied().collect()
    }

    /// The displacement of a point that moves with the weighted mean of nodes.
    pub fn displacement_at(&self, nodes: &[u32], weights: &[f64]) -> Vector3<f64> {
        let of_node = |node: u32| Vector3::from_fn(|axis, _| self.displacement[(3 * node as usize + axis, 0)]);
        nodes.iter().zip(weights).map(|(node, weight)| of_node(*node) * *weight).sum()
    }

    /// True if the reference is under this load.
    pub fn carries(&self, model: &MeshModel<'_, '_>, load: &MeshLoad) -> bool {
        let MeshModel { scene, support, drive, .. } = model;
        self.steady.loads && load.size() > 0.0 && physics::is_steady(scene, support.motion, drive.as_ref(), load)
    }

    /// The stiffness by the stress of the spin and the loads that the reference has already (nf×nf), of those that the motion adds.
    pub fn stress_stiffness(
        &self,
        model: &MeshModel<'_, '_>,
        of_spin: Option<&[Mat<f64>; 6]>,
        of_loads: &[Vec<Directed>],
        nf: usize,
    ) -> Mat<f64> {
        let mut sum = Mat::zeros(nf, nf);
        let mut add = |stiffness: &Mat<f64>, factor: f64| {
            for (i, j) in (0..nf).flat_map(|j| (0..nf).map(move |i| (i, j))) {
                sum[(i, j)] += factor * stiffness[(i, j)];
            }
        };
        let omega = &self.steady.omega_body;
        for (stiffness, (i, j)) in of_spin.into_iter().flatten().zip(ReducedBody::PAIRS) {
            add(stiffness, if i == j { 1.0 } else { 2.0 } * omega[i] * omega[j]);
        }
        for (load, directed) in model.loads.iter().zip(of_loads) {
            if self.carries(model, load) {
                let vectors: Vec<Vector3<f64>> =
                    directed.iter().map(|directed| directed.vector / load.size()).collect();
                let parts = if directed.len() > 1 { load.parts(&vectors) } else { vec![1.0] };
                directed.iter().zip(parts).for_each(|(directed, part)| add(&directed.stiffness, part));
            }
        }
        sum
    }
}

/// Refuses bodies of which modes about a bent one are not made.
fn fits(assembled: &AssembledMesh) -> Result<(), SceneError> {
    let AssembledMesh { scene, support, .. } = assembled;
    let refuse = |found: &str, expected: &str, help: &str| Err(scene.refuse(KEY, found, expected, help));
    if support.motion.count() > 0 {
        let help = "clamp it, or drive its hinge (`motion`); a body that turns or moves freely has its modes about the undeformed one";
        return refuse("a body that can move as a whole", "one that is clamped, or whose spin is given", help);
    }
    if !scene.markers.is_empty() {
        let help = "remove `about`: what joints do to the body is not known before";
        return refuse("a body with markers", "one without joints", help);
    }
    if !scene.time.method.abilities.geometric_stiffening {
        return refuse(
            "a scheme of the paper's formulation",
            "the conservative form",
            "set `formulation = \"conservative\"`",
        );
    }
    Ok(())
}

/// The steady spin and loads that a scene asks for; none where `"auto"` finds neither.
fn steady(assembled: &AssembledMesh, about: About) -> Result<Option<Steady>, SceneError> {
    let AssembledMesh { scene, drive, .. } = assembled;
    let of_drive = drive.as_ref().and_then(|drive| match drive.motion {
        DrivenMotion::Turn { axis } => Some(axis * drive.speed.largest(scene.time.end)),
        DrivenMotion::Slide { .. } => None,
    });
    let (spin, loads) = match about {
        About::Spin => match of_drive {
            Some(spin) => (Some(spin), false),
            None => {
                let help = "drive its hinge by `motion`, or give `about = { angular_velocity = [x, y, z] }`";
                return Err(scene.refuse(KEY, "a body whose spin is not given", "a driven hinge", help));
            }
        },
        About::Loads => (None, true),
        About::Auto => (of_drive, !scene.loads.is_empty()),
        About::Given { angular_velocity, loads } => (Some(angular_velocity.into()), loads),
    };
    let omega_body = spin.unwrap_or_default();
    Ok((omega_body != Vector3::zeros() || loads).then_some(Steady { omega_body, loads }))
}

/// u₀ and f_int(u₀), one after the other.
fn found(assembled: &AssembledMesh, steady: Steady) -> Result<Vec<f64>, BuildError> {
    let AssembledMesh { scene, mesh, support, .. } = assembled;
    let FeMatrices::Assembled(matrices) = assembled.matrices()? else { return Err(assembled.without_elements()) };
    let fails = |error: NonlinearError| -> BuildError {
        let help = "take less of the spin or the load, or modes about the undeformed body (remove `about`)";
        scene.refuse(KEY, error.to_string(), "an equilibrium of the bent body", help).into()
    };
    let body =
        FullBody::new(Arc::clone(mesh), assembled.materials()?, Cow::Borrowed(matrices), support).map_err(fails)?;
    let mut dead = vec![0.0; body.dofs()];
    if steady.loads {
        let masses: Vec<f64> = body.momentum(&vec![1.0; body.dofs()]).chunks_exact(3).map(|m| m[0]).collect();
        let weights = Mat::from_fn(masses.len(), 1, |node, _| masses[node]);
        let loads = mesh_load::on_mesh(scene, mesh, 3, &Arc::new(UnitWeight::new(weights, 3)))?;
        for load in &loads {
            let is_dead = matches!(load.action, Action::Force { .. } | Action::Weight { .. }) && load.turning.is_none();
            if !is_dead {
                let found = "a moment, a pressure or a force that turns with the material";
                let help = "remove `about`, or replace the load by forces";
                return Err(scene.refuse(KEY, found, "forces and gravity", help).into());
            }
            if physics::is_steady(scene, support.motion, assembled.drive.as_ref(), load) {
                let mut forces = vec![0.0; dead.len()];
                load.add_unit_nodal_forces(None, ColMut::from_slice_mut(&mut forces));
                dead.iter_mut().zip(forces).for_each(|(sum, force)| *sum += load.size() * force);
            }
        }
    }
    let settings = EquilibriumSettings::default();
    let found = equilibrium(&body, &ExternalForces::dead(dead), &steady.omega_body, None, &settings).map_err(fails)?;
    if found.negative_pivots > 0 {
        let what = format!("an equilibrium that is not stable, in {} directions", found.negative_pivots);
        let help = "take less of the spin or the load: the body would leave this shape";
        return Err(scene.refuse(KEY, what, "a stable one", help).into());
    }
    let forces = body.strain().internal_forces(&found.displacement);
    Ok([found.displacement, forces].concat())
}
