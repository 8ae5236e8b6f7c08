//! Rotations that the body of a scene can make.

use dynamics::{Drive, DrivenMotion, Effect};
use nalgebra::Vector3;
use reduced_body::RigidMotion;
use scene::Choice;

use crate::needs::Needed;

/// How a body can turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Turning {
    Not,
    /// About one axis, a unit vector.
    About(Vector3<f64>),
    Freely,
}

pub(crate) fn turning(scene: &Needed<'_>, motion: RigidMotion, drive: Option<&Drive>) -> Turning {
    if scene.effects.choices[Effect::Rotation] == Choice::Off {
        return Turning::Not;
    }
    match (motion.rotations(), drive.map(|drive| drive.motion)) {
        (_, Some(DrivenMotion::Turn { axis })) => Turning::About(axis),
        ([], _) => Turning::Not,
        ([axis], _) => Turning::About(*axis),
        _ => Turning::Freely,
    }
}
