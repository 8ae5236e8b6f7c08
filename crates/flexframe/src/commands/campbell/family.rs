//! Bodies in a spin.

use diagnostic::Failure;
use dynamics::SpinMode;

/// Vibrations that depend on the speed of a spin.
pub(super) trait Family {
    /// The vibrations at a speed, slowest first.
    fn vibrations(&self, speed: f64) -> Result<Vec<SpinMode>, Failure>;

    /// All speeds at which a frequency is `order` times the speed (for order 0: is zero), lowest first; `None` where a search along
    /// the branches has to find them.
    fn resonances(&self, _order: f64) -> Result<Option<Vec<f64>>, Failure> {
        Ok(None)
    }

    /// True of vibrations without damping that take long to find: limits are then read off the branches.
    fn is_slow(&self) -> bool {
        false
    }
}

impl<F: Fn(f64) -> Result<Vec<SpinMode>, Failure>> Family for F {
    fn vibrations(&self, speed: f64) -> Result<Vec<SpinMode>, Failure> {
        self(speed)
    }
}
