//! An own load: air that brakes a point, −c v.

use dynamics::{Applied, Key, Kinematics, Load, PointShapes};

/// The drag.
#[derive(Debug)]
pub struct Drag(pub PointShapes, pub f64);

impl Load for Drag {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        let velocity_body = motion.body_from_global * motion.velocity_global(&self.0);
        applied.force(&self.0, &(velocity_body * -self.1));
    }

    fn key(&self, key: Key) -> Key {
        key.of("drag", 1).with("point", &self.0).with("coefficient", &self.1)
    }
}

#[cfg(test)]
mod tests {
    use dynamics::nalgebra::Vector3;
    use dynamics::{Initial, Simulation, StepControl};
    use reduced_body::BodyPoint;

    use super::*;
    use crate::body::ball;

    /// Closed form: v = v₀ exp(−c t / m).
    #[test]
    fn the_ball_slows_down() {
        let ball = ball();
        let center = PointShapes::new(&ball, &BodyPoint::rigid(Vector3::zeros()));
        let thrown = Initial { velocity: Vector3::x() * 3.0, ..Initial::at_rest(0) };
        let run = Simulation::builder(&ball, StepControl::Fixed(0.01), 1.0).load(Drag(center, 0.5)).initial(thrown);
        let last = run.build().unwrap().last().unwrap().unwrap();
        assert!((last.velocity_global.x - 3.0 * (-0.25_f64).exp()).abs() < 1e-7, "{}", last.velocity_global);
    }
}
