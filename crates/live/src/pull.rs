//! A pull at a point: a spring and a damper to a place that a hand moves.

use std::sync::Arc;

use dynamics::nalgebra::Vector3;
use dynamics::{Applied, Key, Kinematics, Load, PointShapes, Signal};

/// A spring from a point of the body to a place in space, with a damper on the velocity of the point. Copies share the place.
#[derive(Debug, Clone)]
pub(crate) struct Pull {
    pub point: Arc<PointShapes>,
    /// Force per length.
    pub stiffness: f64,
    /// Force per velocity.
    pub damping: f64,
    /// The place, global components.
    target: [Signal; 3],
}

impl Pull {
    /// To a place, global components.
    pub fn new(point: PointShapes, [stiffness, damping]: [f64; 2], target_global: Vector3<f64>) -> Self {
        let target = [0, 1, 2].map(|i| Signal::held(target_global[i]));
        Self { point: Arc::new(point), stiffness, damping, target }
    }

    /// Moves the place.
    pub fn move_to(&self, target_global: Vector3<f64>) {
        self.target.iter().zip(target_global.iter()).for_each(|(signal, place)| signal.hold(*place));
    }

    /// The force at a place and a velocity of the point, global components.
    pub fn force_global(
        &self,
        time: f64,
        position_global: Vector3<f64>,
        velocity_global: Vector3<f64>,
    ) -> Vector3<f64> {
        let target = Vector3::from(self.target.each_ref().map(|signal| signal.at(time)));
        (target - position_global) * self.stiffness - velocity_global * self.damping
    }
}

impl Load for Pull {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        let (position, velocity) = (motion.position_global(&self.point), motion.velocity_global(&self.point));
        let force_global = self.force_global(motion.time, position, velocity);
        applied.force(&self.point, &(motion.body_from_global * force_global));
    }

    fn key(&self, key: Key) -> Key {
        // Who moves the place keeps it.
        key.of("pull", 1).with("point", &*self.point).with("stiffness", &self.stiffness).with("damping", &self.damping)
    }
}
