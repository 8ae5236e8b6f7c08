//! The angle by which a body has turned since the beginning of a run.

use nalgebra::Vector3;

/// Sums the angle along the way of a body's attitude, ∫|ω| dt, by the trapezoidal rule over its steps.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Turn {
    /// Time and |ω| at the last moment that was seen.
    last: Option<(f64, f64)>,
    /// rad.
    angle: f64,
}

impl Turn {
    /// Sees a moment that is later than the last one.
    pub fn see(&mut self, time: f64, omega_body: &Vector3<f64>) {
        let speed = omega_body.norm();
        if let Some((before, speed_before)) = self.last {
            self.angle += 0.5 * (speed_before + speed) * (time - before).max(0.0);
        }
        self.last = Some((time, speed));
    }

    /// The angle so far, rad.
    pub fn angle(&self) -> f64 {
        self.angle
    }
}
