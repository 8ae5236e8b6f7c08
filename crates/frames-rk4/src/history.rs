//! How loads go with time.

use crate::error::SetupError;

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
    /// The factor at a time, by the law that holds at the time `inside`.
    ///
    /// Between two corners a history follows one smooth law. A step lies between corners and its stages at both of its
    /// ends: with `inside` its middle, both see the law of the step, and not what is left or right of a jump there.
    pub fn at(&self, time: f64, inside: f64) -> f64 {
        match *self {
            Self::HalfSine { start, duration } => {
                if (start..=start + duration).contains(&inside) {
                    (std::f64::consts::PI * (time - start) / duration).sin()
                } else {
                    0.0
                }
            }
        }
    }

    /// The rate of the factor at a time, by the law that holds at the time `inside`.
    pub fn rate(&self, time: f64, inside: f64) -> f64 {
        match *self {
            Self::HalfSine { start, duration } => {
                if (start..=start + duration).contains(&inside) {
                    let circular = std::f64::consts::PI / duration;
                    circular * (circular * (time - start)).cos()
                } else {
                    0.0
                }
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

    /// Integral of the factor's magnitude from 0 to `end`.
    pub fn magnitude_integral(&self, _end: f64) -> f64 {
        match *self {
            Self::HalfSine { duration, .. } => 2.0 * duration / std::f64::consts::PI,
        }
    }

    /// Largest magnitude of the factor from 0 to `end`.
    pub fn largest(&self, _end: f64) -> f64 {
        1.0
    }

    /// Times at which the factor or one of its rates jumps. A step must not reach across one.
    pub fn corners(&self) -> Vec<f64> {
        match *self {
            Self::HalfSine { start, duration } => vec![start, start + duration],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_is_that_of_the_factor() {
        let pulse = History::HalfSine { start: 1.0, duration: 0.5 };
        let middles = (0..1000).map(|k| 1.0 + 0.5 * (f64::from(k) + 0.5) / 1000.0);
        let sum = middles.map(|t| pulse.at(t, t)).sum::<f64>() * 0.5 / 1000.0;
        assert!((pulse.magnitude_integral(9.0) / sum - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_half_sine_rises_falls_and_ends() {
        let pulse = History::HalfSine { start: 1.0, duration: 0.5 };
        assert_eq!(pulse.at(0.999, 0.999), 0.0);
        assert_eq!(pulse.at(1.0, 1.0), 0.0);
        assert!((pulse.at(1.25, 1.25) - 1.0).abs() < 1e-15);
        assert!((pulse.at(1.125, 1.125) - 0.5_f64.sqrt()).abs() < 1e-15);
        assert!(pulse.at(1.5, 1.5).abs() < 1e-15);
        assert_eq!(pulse.at(1.51, 1.51), 0.0);
    }
}
