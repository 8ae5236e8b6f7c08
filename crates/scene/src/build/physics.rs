//! Which effects a scene gets.

use advice::{Advice, Effect};
use frames_rk4::{Drive, Effects, Method};
use modal::RigidMotion;

use super::loads::MeshLoad;
use super::turning::{Turning, turning};
use crate::effects::Choice;
use crate::scene::Scene;

/// Whether anything may set the body spinning.
pub(super) fn may_spin(scene: &Scene, motion: RigidMotion, drive: Option<&Drive>) -> bool {
    let set_off = drive.is_some() || scene.initial.angular_velocity != [0.0; 3] || !scene.loads.is_empty();
    turning(scene, motion, drive) != Turning::Not && set_off
}

/// Whether the stress of loads and drives may stiffen the body.
pub(super) fn may_stress(scene: &Scene) -> bool {
    scene.effects.geometric_stiffening != Choice::Off && !scene.time.method.is_of_paper()
}

/// Whether a load stays as it is, seen from the body.
pub(super) fn is_steady(scene: &Scene, motion: RigidMotion, drive: Option<&Drive>, load: &MeshLoad) -> bool {
    let turns = turning(scene, motion, drive) != Turning::Not;
    matches!(load.history, frames_rk4::History::Constant) && (load.follows || !turns)
}

/// Whether the loads of gravity that the scene lets act do act.
pub(super) fn gravity(scene: &Scene, advice: &Advice) -> bool {
    scene.effects.gravity != Choice::Auto || advice.is_on(Effect::Gravity)
}

/// Whether modes keep the damping that the scene lets them have.
pub(super) fn damping(scene: &Scene, advice: &Advice) -> bool {
    scene.effects.damping != Choice::Auto || scene.time.method.is_of_paper() || advice.is_on(Effect::Damping)
}

/// Whether static shapes are to be added to the `flexible` modes that there are.
pub(super) fn static_correction(scene: &Scene, flexible: usize) -> Choice {
    match scene.modes.static_correction {
        _ if flexible == 0 => Choice::Off,
        // The shapes are stiff, which only this scheme does not mind.
        Choice::Auto if scene.time.method != Method::EXPONENTIAL => Choice::Off,
        choice => choice,
    }
}

/// The effects of the equations of motion: what the scene leaves open is as advised.
pub(super) fn effects(scene: &Scene, advice: &Advice, stiffening: bool) -> Effects {
    let paper = scene.time.method.is_of_paper();
    let resolve = |choice: Choice, effect: Effect| match choice {
        Choice::On => true,
        Choice::Off => false,
        Choice::Auto => paper || advice.is_on(effect),
    };
    let chosen = &scene.effects;
    let deformed_inertia = resolve(chosen.deformed_inertia, Effect::DeformedInertia);
    Effects {
        translation: resolve(chosen.translation, Effect::Translation),
        rotation: resolve(chosen.rotation, Effect::Rotation),
        deformed_inertia,
        coriolis: resolve(chosen.coriolis, Effect::Coriolis),
        geometric_stiffening: stiffening && deformed_inertia,
    }
}
