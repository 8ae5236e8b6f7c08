//! An own observer: the largest speed at the ends of the steps.

use dynamics::{Observer, StepEnd, StepError};

/// The largest speed so far.
#[derive(Debug, Default)]
pub struct Peak(pub f64);

impl Observer for Peak {
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self.0 = self.0.max(now.observation()?.bodies[0].velocity_global.norm());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use dynamics::nalgebra::Vector3;
    use dynamics::{History, PointForce, PointShapes, Simulation, StepControl};
    use reduced_body::BodyPoint;

    use super::*;
    use crate::body::ball;

    /// Closed form: under F sin(2πft), from rest, the speed is F/(2πfm) (1 − cos 2πft): at most F/(πfm).
    #[test]
    fn it_sees_what_rows_miss() {
        let ball = ball();
        let center = PointShapes::new(&ball, &BodyPoint::rigid(Vector3::zeros()));
        let history = History::Sine { frequency: 1.0, phase: 0.0, start: 0.0, duration: None };
        let run = Simulation::builder(&ball, StepControl::Fixed(0.01), 1.0);
        let mut run = run.load(PointForce::dead(center, Vector3::x() * 4.0, history)).build().unwrap();
        let peak = Arc::new(Mutex::new(Peak::default()));
        run.watch(peak.clone());
        let last = run.last().unwrap().unwrap();
        assert!(last.velocity_global.norm() < 1e-6);
        let expected = 4.0 / (std::f64::consts::PI * 2.0);
        assert!((peak.lock().unwrap().0 - expected).abs() < 1e-5);
    }
}
