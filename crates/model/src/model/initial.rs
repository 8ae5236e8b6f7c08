//! The state that a scene begins with.

use dynamics::Initial;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::Attitude;
use scene::Scene;

/// The attitude at the beginning. The scene has been checked: its quaternion is a rotation.
pub(crate) fn first_attitude(scene: &Scene) -> Attitude {
    scene.initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok()).unwrap_or(Attitude::identity())
}

pub(crate) fn initial(scene: &Scene, body: &ReducedBody) -> Initial {
    let attitude = first_attitude(scene);
    let padded = |list: &[f64]| (0..body.flexible()).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
    Initial {
        attitude,
        origin: scene.initial.position.map(|position| Vector3::from(position) + attitude.to_global(&body.origin)),
        velocity: scene.initial.velocity.into(),
        omega: scene.initial.angular_velocity.into(),
        modal_displacement: padded(&scene.initial.modal_displacement),
        modal_velocity: padded(&scene.initial.modal_velocity),
    }
}
