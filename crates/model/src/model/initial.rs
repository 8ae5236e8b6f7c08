//! The state that a scene begins with.

use dynamics::Initial;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::Attitude;
use scene::{Constraint, Scene};

/// The attitude at the beginning. The scene has been checked: its quaternion is a rotation.
pub(crate) fn first_attitude(scene: &Scene) -> Attitude {
    scene.initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok()).unwrap_or(Attitude::identity())
}

pub(crate) fn initial(scene: &Scene, body: &ReducedBody) -> Initial {
    let attitude = first_attitude(scene);
    let padded = |list: &[f64]| (0..body.flexible()).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
    // A body that is held beside joints begins as it does alone: it is turned, and turns, about the place that is held.
    let arm = held_place(scene).map(|held| (held, attitude.to_global(&(body.origin - held))));
    let turning = attitude.to_global(&scene.initial.angular_velocity.into());
    let given = scene.initial.position.map(|position| Vector3::from(position) + attitude.to_global(&body.origin));
    Initial {
        attitude,
        origin: given.or(arm.map(|(held, arm)| held + arm)),
        velocity: Vector3::from(scene.initial.velocity)
            + arm.map_or_else(Vector3::zeros, |(_, arm)| turning.cross(&arm)),
        omega: scene.initial.angular_velocity.into(),
        modal_displacement: padded(&scene.initial.modal_displacement),
        modal_velocity: padded(&scene.initial.modal_velocity),
    }
}

/// The place that a pin or a hinge beside joints holds, mesh axes.
fn held_place(scene: &Scene) -> Option<Vector3<f64>> {
    match scene.constraint.as_ref().filter(|_| scene.tied)? {
        Constraint::Pin { at, .. } => Some((*at).into()),
        Constraint::Hinge { line, .. } => Some(line.at().into()),
        Constraint::Clamp { .. } | Constraint::Slider { .. } | Constraint::Support { .. } => None,
    }
}
