//! The state that a scene begins with.

use dynamics::Initial;
use rigid_kin::Attitude;

use crate::scene::Scene;

/// The attitude at the beginning. The scene has been checked: its quaternion is a rotation.
pub(super) fn first_attitude(scene: &Scene) -> Attitude {
    scene.initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok()).unwrap_or(Attitude::identity())
}

pub(super) fn initial(scene: &Scene, flexible: usize) -> Initial {
    let padded = |list: &[f64]| (0..flexible).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
    Initial {
        attitude: first_attitude(scene),
        velocity: scene.initial.velocity.into(),
        omega: scene.initial.angular_velocity.into(),
        modal_displacement: padded(&scene.initial.modal_displacement),
        modal_velocity: padded(&scene.initial.modal_velocity),
    }
}
