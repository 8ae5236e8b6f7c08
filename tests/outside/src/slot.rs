//! An own joint: a point in a straight slot, which may also turn as it likes.

use dynamics::{Joint, Marker};

/// The second marker stays on the z axis of the first.
pub fn slot(name: &str, markers: [Marker; 2]) -> Joint {
    Joint::locked(name, markers, [true, true, false], [false; 3])
}

#[cfg(test)]
mod tests {
    use dynamics::nalgebra::{Matrix3, Vector3};
    use dynamics::{ConservativeBody, Initial, MotionState, Physics, System, SystemMotion};

    use super::*;
    use crate::body::ball;

    /// Closed form: a ball in the slot keeps its velocity along it, and its spin.
    #[test]
    fn a_ball_in_a_slot_slides_along_it() {
        let ball = ball();
        let body = ConservativeBody::new(&ball, &[], Vec::new(), &Physics::default()).unwrap();
        let axes = Matrix3::identity();
        let markers = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::zeros(), axes)];
        let system = System::new(vec![body], vec![slot("slot", markers)]).unwrap();
        let state = MotionState {
            time: 0.0,
            attitude: Initial::at_rest(0).attitude,
            origin_global: Vector3::zeros(),
            velocity_global: Vector3::new(0.3, -0.4, 2.0),
            omega_body: Vector3::new(1.0, 2.0, 3.0),
            modal_displacement: Vec::new(),
            modal_velocity: Vec::new(),
        };
        let mut motion = SystemMotion::new(system, &[state]).unwrap();
        motion.assemble().unwrap();
        motion.advance(1.5, 1e-8, &mut 1e-2).unwrap();
        let end = motion.state(0).unwrap();
        assert!((end.origin_global - Vector3::z() * 3.0).norm() < 1e-9, "{}", end.origin_global);
        assert!((end.omega_body - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-9);
    }
}
