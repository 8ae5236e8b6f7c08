//! The search for the bent body that a scene asks for.

use std::borrow::Cow;
use std::sync::Arc;

use advice::RestOfBody;
use dynamics::{Drive, DrivenMotion, Effect};
use faer::Mat;
use fem_tet10::{FiniteStrain, Materials, Matrices, Mesh, Stresses};
use keys::Key;
use modal::Support;
use nalgebra::{Matrix3, Vector3};
use nonlinear::{Equilibrium, EquilibriumSettings, ExternalForces, FullBody, NonlinearError, equilibrium};
use scene::{About, Choice, SceneError};

use crate::cache::store::Store;
use crate::error::BuildError;
use crate::load::mesh_load::{self, Action, UnitWeight};
use crate::needs::Needed;
use crate::reduction::physics;
use crate::reduction::reference::{Reference, Steady};

/// Largest displacement over the length of the body from which `"auto"` takes modes about the bent body: below it, large modes
/// are as good.
const FAR: f64 = 0.05;
const KEY: &str = "modes.about";
/// How often the axis of a spin follows the bent body, and the change, over the spin, with which it has settled.
const MAX_AXES: usize = 10;
const SETTLED: f64 = 1e-12;
/// Largest distance of a spin from a principal axis, over the spin.
const OFF_AXIS: f64 = 0.1;
/// Difference of two moments of inertia that are alike, over the largest.
const ALIKE: f64 = 1e-6;

/// The body that is asked for.
pub(crate) struct Asked<'a> {
    pub scene: Needed<'a>,
    pub mesh: &'a Arc<Mesh>,
    pub materials: &'a Materials,
    pub support: &'a Support,
    pub drive: Option<&'a Drive>,
    pub store: Option<&'a Store>,
}

impl Asked<'_> {
    /// The bent body about which a scene takes its modes, if any; `matrices` are those of the undeformed one.
    pub fn reference<'m>(
        &self,
        about: About,
        matrices: impl Fn() -> Result<&'m Matrices, BuildError>,
    ) -> Result<Option<Reference>, BuildError> {
        let Self { scene, mesh, support, drive, store, .. } = self;
        if let Err(refusal) = fits(scene, support) {
            return if about == About::Auto { Ok(None) } else { Err(refusal.into()) };
        }
        let Some(steady) = steady(scene, support, *drive, about)? else { return Ok(None) };
        if about == About::Auto && can_turn(support) && self.tumbles(matrices()?, &steady.omega_body) {
            return Ok(None);
        }
        let find = || find(self, matrices()?, steady);
        let kept = store.and_then(|store| Some((store, self.key(store, &steady)?.finish())));
        let found = match kept {
            None => find()?,
            Some((store, key)) => match store.recall(&key, 6 * mesh.positions().len() + 3)? {
                Some(found) => found,
                None => {
                    let found = find()?;
                    store.keep(&key, &found);
                    found
                }
            },
        };
        let reference = Reference::new(steady.loads, mesh.positions(), &found);
        let is_far = reference.largest() >= FAR * mesh.diagonal();
        Ok((about != About::Auto || is_far).then_some(reference))
    }

    /// The rest of the full body in the spin and under the loads that a scene has for sure, where its model has none. Not asked of a body
    /// of which a reference would be refused.
    pub fn rest_of_body<'m>(
        &self,
        matrices: impl Fn() -> Result<&'m Matrices, BuildError>,
    ) -> Result<RestOfBody, BuildError> {
        let Self { scene, mesh, materials, support, drive, .. } = self;
        let Some(steady) = fits(scene, support).ok().and_then(|()| steady(scene, support, *drive, About::Auto).ok()?)
        else {
            return Ok(RestOfBody::NotAsked);
        };
        let Ok(body) = FullBody::new(Arc::clone(mesh), materials, Cow::Borrowed(matrices()?), support) else {
            return Ok(RestOfBody::NotAsked);
        };
        let Ok(forces) = dead_forces(self, &body, steady) else { return Ok(RestOfBody::NotAsked) };
        let settings = EquilibriumSettings { steps: &[1, 4], ..EquilibriumSettings::default() };
        Ok(match equilibrium(&body, &forces, &steady.omega_body, None, &settings) {
            Ok(Equilibrium { negative_pivots: 0, displacement, .. }) => {
                let size = |u: &[f64]| Vector3::from_column_slice(u).norm();
                RestOfBody::Stable { displacement: displacement.chunks_exact(3).map(size).fold(0.0, f64::max) }
            }
            Ok(found) => RestOfBody::Unstable { directions: found.negative_pivots },
            Err(NonlinearError::NoEquilibrium { .. } | NonlinearError::NotFinite { .. } | NonlinearError::Singular) => {
                RestOfBody::NotFound
            }
            Err(_) => RestOfBody::NotAsked,
        })
    }

    /// The key with all that the rest follows from, loads by the names that they have in a scene; none where these cannot be told.
    fn key(&self, store: &Store, steady: &Steady) -> Option<Key> {
        let Self { scene, support, drive, .. } = self;
        let key = store.key().of("reference", 3).with("support", *support).with("spin", &steady.omega_body);
        if !steady.loads {
            return Some(key);
        }
        let gravity = match scene.effects.choices[Effect::Gravity] {
            Choice::On => Some(true),
            Choice::Off => Some(false),
            Choice::Auto => None,
        };
        // A file of a table may have a name that is no text.
        let loads = serde_json::to_string(&scene.loads).ok()?;
        let key = key.with("loads", &*loads).with("gravity", &gravity).with("attitude", &scene.initial.attitude);
        Some(key.with("turns", &physics::turns(scene, support.motion, *drive)))
    }

    /// Mass, and the stiffness of a bent body that modes are of: K_T. Of a body that can turn it is K_T without the part by the stress
    /// of the rest, G(S₀): a turn of the body turns the forces that this stress is in equilibrium with, so that K_T resists it.
    pub fn tangent(&self, reference: &Reference, matrices: &Matrices) -> Result<Matrices, BuildError> {
        let (strain, u) = self.strain(reference)?;
        let stresses = if can_turn(self.support) { unstressed(&strain) } else { strain.stresses(&u) };
        Ok(matrices.with_stiffness(strain.stiffness(&u, &stresses, matrices)))
    }

    /// G(S₀), the part of K_T by the stress of the rest, where [`Self::tangent`] is without it.
    pub fn stress_tangent(&self, reference: &Reference, matrices: &Matrices) -> Result<Option<Matrices>, BuildError> {
        if !can_turn(self.support) {
            return Ok(None);
        }
        let (strain, u) = self.strain(reference)?;
        let mut values = strain.stiffness(&u, &strain.stresses(&u), matrices);
        let without = strain.stiffness(&u, &unstressed(&strain), matrices);
        values.iter_mut().zip(without).for_each(|(value, without)| *value -= without);
        Ok(Some(matrices.with_stiffness(values)))
    }

    /// True if a spin of the undeformed body is about no principal axis.
    fn tumbles(&self, matrices: &Matrices, omega: &Vector3<f64>) -> bool {
        let Self { mesh, materials, support, .. } = self;
        let Ok(body) = FullBody::new(Arc::clone(mesh), materials, Cow::Borrowed(matrices), support) else {
            return true;
        };
        let axis = principal_axis(&inertia(&body, &vec![0.0; body.dofs()]), omega);
        support.motion.rotations().len() == 3 && (axis * omega.norm() - omega).norm() > OFF_AXIS * omega.norm()
    }

    fn strain(&self, reference: &Reference) -> Result<(FiniteStrain, Vec<f64>), BuildError> {
        let strain = FiniteStrain::new(Arc::clone(self.mesh), self.materials)?;
        Ok((strain, reference.displacement.col(0).iter().copied().collect()))
    }
}

/// Refuses bodies of which modes about a bent one are not made.
pub(crate) fn fits(scene: &Needed<'_>, support: &Support) -> Result<(), SceneError> {
    let refuse = |found: &str, expected: &str, help: &str| Err(scene.refuse(KEY, found, expected, help));
    if support.motion.count() > 0 && !can_turn(support) {
        let help = "clamp it; a body that slides freely has its modes about the undeformed one";
        return refuse("a body that can move along a line", "one that is clamped, or that spins", help);
    }
    if !scene.markers.is_empty() {
        let help = "remove `about`: what joints do to the body is not known before";
        return refuse("a body with markers", "one without joints", help);
    }
    if !scene.method().abilities.geometric_stiffening {
        return refuse(
            "a scheme of the paper's formulation",
            "the conservative form",
            "set `formulation = \"conservative\"`",
        );
    }
    Ok(())
}

/// True if the body turns as its momentum takes it.
fn can_turn(support: &Support) -> bool {
    !support.motion.rotations().is_empty()
}

fn unstressed(strain: &FiniteStrain) -> Stresses {
    strain.linear_stresses(&vec![0.0; 3 * strain.mesh().positions().len()])
}

/// The steady spin and loads that a scene asks for; none where `"auto"` finds neither.
pub(crate) fn steady(
    scene: &Needed<'_>,
    support: &Support,
    drive: Option<&Drive>,
    about: About,
) -> Result<Option<Steady>, SceneError> {
    let of_drive = drive.and_then(|drive| match drive.motion {
        DrivenMotion::Turn { axis } => Some(axis * drive.speed.largest(scene.time.end)),
        DrivenMotion::Slide { .. } => None,
    });
    let turns = can_turn(support);
    let initial = support.motion.rotation_projector() * Vector3::from(scene.initial.angular_velocity);
    let of_drive = of_drive.or_else(|| (turns && initial != Vector3::zeros()).then_some(initial));
    if turns && matches!(about, About::Loads | About::Given { loads: true, .. }) {
        let help = "give `about = \"spin\"`: loads set a body going that can turn";
        return Err(scene.refuse(KEY, "loads of a body that can turn", "its spin alone", help));
    }
    let (spin, loads) = match about {
        About::Spin => match of_drive {
            Some(spin) => (Some(spin), false),
            None => {
                let help = "drive its hinge by `motion`, give a body that turns freely an initial `angular_velocity`, or give `about = { angular_velocity = [x, y, z] }`";
                return Err(scene.refuse(
                    KEY,
                    "a body whose spin is not given",
                    "a driven hinge, or a body that spins",
                    help,
                ));
            }
        },
        About::Loads => (None, true),
        About::Auto => (of_drive, !scene.loads.is_empty() && !turns),
        About::Given { angular_velocity, loads } => (Some(angular_velocity.into()), loads),
    };
    let omega_body = spin.unwrap_or_default();
    Ok((omega_body != Vector3::zeros() || loads).then_some(Steady { omega_body, loads }))
}

/// u₀ and f_int(u₀), one after the other, and after them the spin of the rest: of a body that turns about all axes, about the principal axis
/// of the bent body.
fn find(asked: &Asked<'_>, matrices: &Matrices, steady: Steady) -> Result<Vec<f64>, BuildError> {
    let Asked { scene, mesh, materials, support, .. } = asked;
    let fails = |error: NonlinearError| -> BuildError {
        let help = "take less of the spin or the load, or modes about the undeformed body (remove `about`)";
        scene.refuse(KEY, error.to_string(), "an equilibrium of the bent body", help).into()
    };
    let body = FullBody::new(Arc::clone(mesh), materials, Cow::Borrowed(matrices), support).map_err(fails)?;
    let forces = dead_forces(asked, &body, steady)?;
    let settings = EquilibriumSettings::default();
    let turns = support.motion.rotations().len() == 3;
    let mut omega = steady.omega_body;
    let mut found = equilibrium(&body, &forces, &omega, None, &settings).map_err(fails)?;
    for _ in 0..MAX_AXES {
        let Some(axis) = turns.then(|| principal_axis(&inertia(&body, &found.displacement), &omega)) else { break };
        let turned = axis * omega.norm();
        let by = (turned - omega).norm() / omega.norm();
        omega = turned;
        if by < SETTLED {
            break;
        }
        found = equilibrium(&body, &forces, &omega, Some(&found.displacement), &settings).map_err(fails)?;
    }
    if (omega - steady.omega_body).norm() > OFF_AXIS * omega.norm() {
        let (found, expected) =
            ("a spin that is about no principal axis", "one about which the body can go on to spin");
        let help = "turn it: a body that tumbles has no rest in its frame";
        return Err(scene.refuse(KEY, found, expected, help).into());
    }
    if found.negative_pivots > 0 {
        let what = format!("an equilibrium that is not stable, in {} directions", found.negative_pivots);
        let help = "take less of the spin or the load: the body would leave this shape";
        return Err(scene.refuse(KEY, what, "a stable one", help).into());
    }
    let forces = body.strain().internal_forces(&found.displacement);
    Ok([found.displacement, forces, omega.iter().copied().collect()].concat())
}

/// Inertia of the bent body about its origin.
fn inertia(body: &FullBody<'_>, displacement: &[f64]) -> Matrix3<f64> {
    let arms: Vec<Vector3<f64>> = (body.mesh().positions().iter().zip(displacement.chunks_exact(3)))
        .map(|(x, u)| Vector3::from(*x) - body.origin() + Vector3::from_column_slice(u))
        .collect();
    let turns = [Vector3::x(), Vector3::y(), Vector3::z()]
        .map(|axis| arms.iter().flat_map(|arm| <[f64; 3]>::from(axis.cross(arm))).collect::<Vec<f64>>());
    let momenta = turns.each_ref().map(|turn| body.momentum(turn));
    Matrix3::from_fn(|i, j| turns[i].iter().zip(&momenta[j]).map(|(r, p)| r * p).sum())
}

/// The direction nearest to that of a spin among those that are principal: along the axis nearest to it, or in the plane of two alike.
fn principal_axis(inertia: &Matrix3<f64>, omega: &Vector3<f64>) -> Vector3<f64> {
    let eigen = inertia.symmetric_eigen();
    let part = |k: usize| eigen.eigenvectors.column(k).dot(omega);
    let nearest = (0..3).max_by(|i, j| part(*i).abs().total_cmp(&part(*j).abs())).unwrap_or_default();
    let is_alike =
        |k: &usize| (eigen.eigenvalues[*k] - eigen.eigenvalues[nearest]).abs() < ALIKE * eigen.eigenvalues.amax();
    let along: Vector3<f64> = (0..3).filter(is_alike).map(|k| eigen.eigenvectors.column(k) * part(k)).sum();
    along.normalize()
}

/// The steady loads of a scene on the nodes of its full body.
fn dead_forces(asked: &Asked<'_>, body: &FullBody<'_>, steady: Steady) -> Result<ExternalForces, BuildError> {
    let Asked { scene, mesh, support, drive, .. } = asked;
    let mut dead = vec![0.0; body.dofs()];
    if !steady.loads {
        return Ok(ExternalForces::dead(dead));
    }
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
        if physics::is_steady(scene, support.motion, *drive, load) {
            load.add_nodal_forces(&mut dead);
        }
    }
    Ok(ExternalForces::dead(dead))
}
