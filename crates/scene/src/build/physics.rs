//! Which effects a scene gets.

use frames_rk4::{Drive, DrivenMotion, Effects};
use modal::{ReducedBody, RigidMotion, Support};

use super::loads::MeshLoad;
use crate::effects::Choice;
use crate::scene::{Method, Scene};

/// Whether anything may set the body spinning.
pub(super) fn may_spin(scene: &Scene, support: &Support, drive: Option<&Drive>) -> bool {
    let set_off = drive.is_some() || scene.initial.angular_velocity != [0.0; 3] || !scene.loads.is_empty();
    scene.effects.rotation != Choice::Off && turns(support.motion, drive) && set_off
}

/// Whether a body can turn.
fn turns(motion: RigidMotion, drive: Option<&Drive>) -> bool {
    match (motion, drive.map(|drive| drive.motion)) {
        (_, Some(DrivenMotion::Turn { .. })) => true,
        (RigidMotion::Free | RigidMotion::Pin { .. } | RigidMotion::Hinge { .. }, _) => true,
        (RigidMotion::Slider { .. } | RigidMotion::Clamp { .. }, _) => false,
    }
}

/// Whether the stress of the centrifugal field is computed.
pub(super) fn stiffening(scene: &Scene, body: &ReducedBody, drive: Option<&Drive>, support: &Support) -> bool {
    let of_paper = matches!(scene.time.method, Method::Paper | Method::PaperRkmk4);
    stiffens_in_spin(scene, body)
        && may_spin(scene, support, drive)
        && (scene.effects.geometric_stiffening == Choice::On || !of_paper)
}

/// Whether the stress of the centrifugal field is computed of a body that spins.
pub(super) fn stiffens_in_spin(scene: &Scene, body: &ReducedBody) -> bool {
    body.flexible() > 0
        && scene.effects.deformed_inertia != Choice::Off
        && scene.effects.geometric_stiffening != Choice::Off
}

/// Whether the stress of a load stiffens the body: one that stays as it is, seen from the body.
pub(super) fn stiffens(scene: &Scene, body: &ReducedBody, drive: Option<&Drive>, load: &MeshLoad) -> bool {
    let turns = turns(body.motion, drive) && scene.effects.rotation != Choice::Off;
    let of_paper = matches!(scene.time.method, Method::Paper | Method::PaperRkmk4);
    body.flexible() > 0
        && !of_paper
        && scene.effects.geometric_stiffening != Choice::Off
        && matches!(load.history, frames_rk4::History::Constant)
        && (load.follows || !turns)
}

/// The effects of the equations of motion.
pub(super) fn effects(scene: &Scene, stiffening: bool) -> Effects {
    let on = |choice: Choice| choice != Choice::Off;
    Effects {
        translation: on(scene.effects.translation),
        rotation: on(scene.effects.rotation),
        deformed_inertia: on(scene.effects.deformed_inertia),
        coriolis: on(scene.effects.coriolis),
        geometric_stiffening: stiffening,
    }
}
