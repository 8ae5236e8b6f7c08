//! An own joint: a point that slides on a wire.

use dynamics::nalgebra::Vector3;
use dynamics::{EquationValue, JointEquation, RelativePlace};

/// A parabola in the x-z plane of the first marker, with this radius at its lowest point: 2 radius z = x².
#[derive(Debug)]
pub struct Wire {
    /// The radius.
    pub radius: f64,
}

impl JointEquation for Wire {
    fn value(&self, RelativePlace { position, .. }: &RelativePlace) -> EquationValue {
        EquationValue {
            residual: position.z - position.x * position.x / (2.0 * self.radius),
            by_position: Vector3::new(-position.x / self.radius, 0.0, 1.0),
            by_turn: Vector3::zeros(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use dynamics::nalgebra::Matrix3;
    use dynamics::{ConservativeBody, Initial, Joint, Marker, MotionState, Physics, System, SystemMotion};

    use super::*;
    use crate::body::ball;

    /// Closed form: a ball that is thrown up a wire without gravity keeps its speed: the length of the wire that it has gone.
    #[test]
    fn a_ball_on_a_wire_keeps_its_speed() {
        let (ball, radius, speed, time) = (ball(), 0.7, 2.0, 1.5);
        let body = ConservativeBody::new(&ball, &[], Vec::new(), &Physics::default()).unwrap();
        let axes = Matrix3::identity();
        let markers = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::zeros(), axes)];
        // In the plane of the wire by the usual row, on the wire by the own one.
        let joint = Joint::locked("wire", markers, [false, true, false], [false; 3]);
        let system = System::new(vec![body], vec![joint.with_equation(Arc::new(Wire { radius }))]).unwrap();
        let state = MotionState {
            time: 0.0,
            attitude: Initial::at_rest(0).attitude,
            origin_global: Vector3::zeros(),
            velocity_global: Vector3::x() * speed,
            omega_body: Vector3::new(1.0, 2.0, 3.0),
            modal_displacement: Vec::new(),
            modal_velocity: Vec::new(),
        };
        let mut motion = SystemMotion::new(system, &[state]).unwrap();
        motion.advance(time, 1e-8, &mut 1e-2).unwrap();
        let slope = motion.state(0).unwrap().origin_global.x / radius;
        let length = 0.5 * radius * (slope * slope.hypot(1.0) + slope.asinh());
        assert!((length - speed * time).abs() < 1e-6, "{length}");
    }
}
