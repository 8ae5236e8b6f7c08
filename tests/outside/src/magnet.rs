//! An own force between bodies: two poles that attract each other with k/d².

use dynamics::{ForceElement, Marker, MarkerMotion, MarkerWrench};

/// The poles, and k.
#[derive(Debug)]
pub struct Magnet(pub [Marker; 2], pub f64);

impl ForceElement for Magnet {
    fn markers(&self) -> &[Marker] {
        &self.0
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let line = motions[1].position_global - motions[0].position_global;
        let force = line * (self.1 / line.norm().powi(3));
        (wrenches[0].force_global, wrenches[1].force_global) = (force, -force);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use dynamics::nalgebra::{Matrix3, Vector3};
    use dynamics::{ConservativeBody, Initial, MotionState, Physics, System, SystemMotion};

    use super::*;
    use crate::body::ball;

    /// Closed form: two balls at a distance d circle each other with ω² = 2k/(m d³).
    #[test]
    fn two_balls_circle_each_other() {
        let (ball, k, omega) = (ball(), 1.0, 1.0);
        let body = ConservativeBody::new(&ball, &[], Vec::new(), &Physics::default()).unwrap();
        let pole = |body| Marker::on_rigid(body, Vector3::zeros(), Matrix3::identity());
        let system = System::new(vec![body.clone(), body], Vec::new()).unwrap();
        let system = system.with_elements(vec![Arc::new(Magnet([pole(0), pole(1)], k))]).unwrap();
        let at = |side: f64| MotionState {
            time: 0.0,
            attitude: Initial::at_rest(0).attitude,
            origin_global: Vector3::x() * 0.5 * side,
            velocity_global: Vector3::y() * 0.5 * side * omega,
            omega_body: Vector3::zeros(),
            modal_displacement: Vec::new(),
            modal_velocity: Vec::new(),
        };
        let mut motion = SystemMotion::new(system, &[at(-1.0), at(1.0)]).unwrap();
        motion.advance(std::f64::consts::PI, 1e-8, &mut 1e-3).unwrap();
        let place = motion.state(1).unwrap().origin_global;
        assert!((place + Vector3::x() * 0.5).norm() < 1e-6, "{place}");
    }
}
