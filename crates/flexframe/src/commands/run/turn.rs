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
    /// Sees a moment. One that is not later than the last one counts for nothing: rows of bodies in joints come after the end of
    /// the step that they are in.
    pub fn see(&mut self, time: f64, omega_body: &Vector3<f64>) {
        let speed = omega_body.norm();
        if let Some((before, speed_before)) = self.last {
            if time <= before {
                return;
            }
            self.angle += 0.5 * (speed_before + speed) * (time - before);
        }
        self.last = Some((time, speed));
    }

    /// The angle so far, rad.
    pub fn angle(&self) -> f64 {
        self.angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a spin of 2 rad/s turns by 2 rad in a second.
    #[test]
    fn rows_behind_the_end_of_a_step_are_not_counted_again() {
        let mut turn = Turn::default();
        for time in [0.0, 0.5, 0.1, 0.2, 0.5, 1.0, 0.6, 1.0] {
            turn.see(time, &Vector3::new(0.0, 2.0, 0.0));
        }
        assert!((turn.angle() - 2.0).abs() < 1e-15, "{}", turn.angle());
    }
}
