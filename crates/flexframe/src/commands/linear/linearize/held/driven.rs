//! The drive of a held body as an input.

use dynamics::DrivenMotion;
use linear::Channel;
use model::Model;
use scene::Body;

use crate::rows::units::UnitLabels;

/// A drive at the time of the state.
#[derive(Clone, Copy)]
pub(super) struct Driven {
    pub motion: DrivenMotion,
    pub speed: f64,
}

impl Driven {
    pub const INPUT: &str = "drive.acceleration";

    pub fn new(model: &Model, time: f64) -> Option<Self> {
        let drive = model.physics.drive.as_ref()?;
        Some(Self { motion: drive.motion, speed: drive.speed.amplitude * drive.speed.history.at(time, time) })
    }

    /// True where the body turns.
    pub fn is_spin(&self) -> bool {
        matches!(self.motion, DrivenMotion::Turn { .. }) && self.speed != 0.0
    }

    /// The input, and the coordinate that it accelerates.
    pub fn channels(&self, scene: &Body) -> [Channel; 2] {
        let UnitLabels { length, time, .. } = (&scene.units).into();
        let (unit, name) = match self.motion {
            DrivenMotion::Turn { .. } => ("rad", "drive.angle"),
            DrivenMotion::Slide { .. } => (length, "drive.position"),
        };
        [Channel::new(Self::INPUT, format!("{unit}/{time}²")), Channel::new(name, unit)]
    }
}
