//! The search for the bent body that a scene asks for.

use std::borrow::Cow;
use std::sync::Arc;

use dynamics::{Drive, DrivenMotion, Effect};
use faer::Mat;
use fem_tet10::{FiniteStrain, Materials, Matrices, Mesh};
use keys::Key;
use modal::Support;
use nalgebra::Vector3;
use nonlinear::{EquilibriumSettings, ExternalForces, FullBody, NonlinearError, equilibrium};
use scene::{About, Choice, Scene, SceneError};

use crate::cache::store::Store;
use crate::error::BuildError;
use crate::load::mesh_load::{self, Action, UnitWeight};
use crate::reduction::physics;
use crate::reference::{Reference, Steady};

/// Largest displacement over the length of the body from which `"auto"` takes modes about the bent body: below it, large modes
/// are as good.
const FAR: f64 = 0.05;
const KEY: &str = "modes.about";

/// The body that is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub scene: &'a Scene,
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
        let Some(steady) = steady(scene, *drive, about)? else { return Ok(None) };
        let find = || find(self, matrices()?, steady);
        let kept = store.and_then(|store| Some((store, self.key(store, &steady)?.finish())));
        let found = match kept {
            None => find()?,
            Some((store, key)) => match store.recall(&key, 6 * mesh.positions().len())? {
                Some(found) => found,
                None => {
                    let found = find()?;
                    store.keep(&key, &found);
                    found
                }
            },
        };
        let reference = Reference::new(steady, mesh.positions(), &found);
        let is_far = reference.largest() >= FAR * mesh.diagonal();
        Ok((about != About::Auto || is_far).then_some(reference))
    }

    /// The key with all that the rest follows from, loads by the names that they have in a scene; none where these cannot be told.
    fn key(&self, store: &Store, steady: &Steady) -> Option<Key> {
        let Self { scene, support, drive, .. } = self;
        let key = store.key().of("reference", 2).with("support", *support).with("spin", &steady.omega_body);
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

    /// Mass, and the stiffness K_T of a bent body.
    pub fn tangent(&self, reference: &Reference, matrices: &Matrices) -> Result<Matrices, BuildError> {
        let strain = FiniteStrain::new(Arc::clone(self.mesh), self.materials)?;
        let u: Vec<f64> = reference.displacement.col(0).iter().copied().collect();
        Ok(matrices.with_stiffness(strain.stiffness(&u, &strain.stresses(&u), matrices)))
    }
}

/// Refuses bodies of which modes about a bent one are not made.
pub(crate) fn fits(scene: &Scene, support: &Support) -> Result<(), SceneError> {
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
pub(crate) fn steady(scene: &Scene, drive: Option<&Drive>, about: About) -> Result<Option<Steady>, SceneError> {
    let of_drive = drive.and_then(|drive| match drive.motion {
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
fn find(asked: &Asked<'_>, matrices: &Matrices, steady: Steady) -> Result<Vec<f64>, BuildError> {
    let &Asked { scene, mesh, materials, support, drive, .. } = asked;
    let fails = |error: NonlinearError| -> BuildError {
        let help = "take less of the spin or the load, or modes about the undeformed body (remove `about`)";
        scene.refuse(KEY, error.to_string(), "an equilibrium of the bent body", help).into()
    };
    let body = FullBody::new(Arc::clone(mesh), materials, Cow::Borrowed(matrices), support).map_err(fails)?;
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
            if physics::is_steady(scene, support.motion, drive, load) {
                load.add_nodal_forces(&mut dead);
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
