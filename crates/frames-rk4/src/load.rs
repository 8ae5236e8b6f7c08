//! Forces on points of the body, and how they go with time.

use nalgebra::Vector3;

use crate::error::SetupError;
use crate::motion::PointShapes;

/// The course of a load in time, as a factor of its amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum History {
    /// `sin(π (t − start) / duration)` within the duration, zero before and after.
    HalfSine {
        /// Beginning.
        start: f64,
        /// Length.
        duration: f64,
    },
}

impl History {
    /// The factor at a time.
    pub fn at(&self, time: f64) -> f64 {
        match *self {
            Self::HalfSine { start, duration } => {
                let phase = (time - start) / duration;
                if (0.0..=1.0).contains(&phase) { (std::f64::consts::PI * phase).sin() } else { 0.0 }
            }
        }
    }

    /// Refuses times that are not finite, and a duration that is not positive.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        let Self::HalfSine { start, duration } = *self;
        if !start.is_finite() {
            return Err(SetupError::Value {
                what: "the start of a half-sine",
                found: start,
                expected: "a finite number",
            });
        }
        if !(duration > 0.0 && duration.is_finite()) {
            let what = "the duration of a half-sine";
            return Err(SetupError::Value { what, found: duration, expected: "a positive number" });
        }
        Ok(())
    }

    /// Integral of the factor's magnitude over all time.
    pub(crate) fn integral(&self) -> f64 {
        match *self {
            Self::HalfSine { duration, .. } => 2.0 * duration / std::f64::consts::PI,
        }
    }

    /// Times at which the factor or one of its rates jumps. A step must not reach across one.
    pub fn corners(&self) -> [f64; 2] {
        match *self {
            Self::HalfSine { start, duration } => [start, start + duration],
        }
    }
}

/// A force that keeps its global direction, at a point of the body.
#[derive(Debug, Clone)]
pub struct DeadForce {
    /// Where it acts.
    pub point: PointShapes,
    /// Direction times amplitude, global components.
    pub force_global: Vector3<f64>,
    /// Its course in time.
    pub history: History,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_is_that_of_the_factor() {
        let pulse = History::HalfSine { start: 1.0, duration: 0.5 };
        let middles = (0..1000).map(|k| 1.0 + 0.5 * (f64::from(k) + 0.5) / 1000.0);
        let sum = middles.map(|t| pulse.at(t)).sum::<f64>() * 0.5 / 1000.0;
        assert!((pulse.integral() / sum - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_half_sine_rises_falls_and_ends() {
        let pulse = History::HalfSine { start: 1.0, duration: 0.5 };
        assert_eq!(pulse.at(0.999), 0.0);
        assert_eq!(pulse.at(1.0), 0.0);
        assert!((pulse.at(1.25) - 1.0).abs() < 1e-15);
        assert!((pulse.at(1.125) - 0.5_f64.sqrt()).abs() < 1e-15);
        assert!(pulse.at(1.5).abs() < 1e-15);
        assert_eq!(pulse.at(1.51), 0.0);
    }
}
