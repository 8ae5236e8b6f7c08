//! Damping of modes as their frequencies change.

use std::f64::consts::TAU;

use faer::c64;
use scene::Damping;

/// Relative step within a straight piece of a table of damping ratios.
const WITHIN: f64 = 1e-6;

/// A mode with its damping.
pub(super) struct Damped {
    pub omega: f64,
    /// 2ζω, and its slope with ω.
    pub damping: f64,
    pub slope: f64,
}

impl Damped {
    /// Modes of these frequencies, cycles per time.
    pub fn modes(frequencies: &[f64], damping: &Damping) -> Vec<Self> {
        let mode = |(k, frequency): (usize, &f64)| {
            let omega = TAU * frequency;
            let ratio = |omega: f64| damping.ratio(k, omega);
            let slope = match damping {
                Damping::Uniform(_) | Damping::List(_) => 2.0 * ratio(omega),
                Damping::Rayleigh(rayleigh) => 2.0 * rayleigh.beta * omega,
                // Pieces are straight: their differences are exact.
                Damping::Table(_) => {
                    let [after, before] = [1.0 + WITHIN, 1.0 - WITHIN].map(|part| ratio(part * omega));
                    2.0 * ratio(omega) + (after - before) / WITHIN
                }
            };
            Self { omega, damping: 2.0 * ratio(omega) * omega, slope }
        };
        frequencies.iter().enumerate().map(mode).collect()
    }
    /// λ − ω² + iω·2ζ√λ at a circular frequency ω.
    pub fn stiffness(&self, omega: f64) -> c64 {
        c64::new(self.omega * self.omega - omega * omega, omega * self.damping)
    }

    /// The rate of the stiffness, by the rate of λ.
    pub fn stiffness_rate(&self, omega: f64, rate: f64) -> c64 {
        c64::new(rate, omega * self.slope * rate / (2.0 * self.omega))
    }
}
