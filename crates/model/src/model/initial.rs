//! The state that a scene begins with.

use dynamics::Initial;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::Attitude;
use scene::{Body, Constraint};

/// The attitude at the beginning. The scene has been checked: its quaternion is a rotation.
pub(crate) fn first_attitude(body: &Body) -> Attitude {
    body.initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok()).unwrap_or(Attitude::identity())
}

pub(crate) fn initial(body: &Body, reduced: &ReducedBody) -> Initial {
    let attitude = first_attitude(body);
    let padded = |list: &[f64]| (0..reduced.flexible()).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
    // A body that is held beside joints begins as it does alone: it is turned, and turns, about the place that is held.
    let arm = held_place(body).map(|held| (held, attitude.to_global(&(reduced.origin - held))));
    let turning = attitude.to_global(&body.initial.angular_velocity.into());
    let given = body.initial.position.map(|position| Vector3::from(position) + attitude.to_global(&reduced.origin));
    Initial {
        attitude,
        origin: given.or(arm.map(|(held, arm)| held + arm)),
        velocity: Vector3::from(body.initial.velocity)
            + arm.map_or_else(Vector3::zeros, |(_, arm)| turning.cross(&arm)),
        omega: body.initial.angular_velocity.into(),
        modal_displacement: padded(&body.initial.modal_displacement),
        modal_velocity: padded(&body.initial.modal_velocity),
    }
}

/// The place that a pin or a hinge beside joints holds, mesh axes.
fn held_place(body: &Body) -> Option<Vector3<f64>> {
    match body.constraint.as_ref().filter(|_| body.tied)? {
        Constraint::Pin { at, .. } => Some((*at).into()),
        Constraint::Hinge { line, .. } => Some(line.at().into()),
        Constraint::Clamp { .. } | Constraint::Slider { .. } | Constraint::Support { .. } => None,
    }
}
