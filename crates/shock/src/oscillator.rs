//! Exact steps of an oscillator under an acceleration of its base that is straight in time.
//!
//! With the answer g to a unit impulse, `g(τ) = exp(−ζωτ) sin(ω_d τ)/ω_d`, or sinh where ζ is more than 1, a step of length h under
//! a = a₀ + s t is Eq. (R3):
//!
//! ```text
//! z(h)  = c z + g v − a₀ ∫g dτ − s ∫g (h − τ) dτ
//! z'(h) = −ω² g z + g' v − a₀ g − s ∫g dτ
//! ```
//!
//! with c = g' + 2ζω g. The integrals are those of Gauss with five points: no difference of large numbers is taken, so that slow
//! oscillators and short steps keep their digits.

use std::f64::consts::TAU;

/// Phase after which a strongly damped oscillator is still.
const STILL: f64 = 40.0;
/// Points and weights of Gauss on −1 … 1.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// An oscillator of unit mass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oscillator {
    pub omega: f64,
    pub zeta: f64,
}

/// Displacement and velocity relative to the base.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Swing {
    pub z: f64,
    pub v: f64,
}

/// The constants of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    h: f64,
    omega_squared: f64,
    c: f64,
    g: f64,
    g_rate: f64,
    /// ∫g dτ and ∫g (h − τ) dτ.
    once: f64,
    twice: f64,
}

impl Oscillator {
    /// Its fastest rate: ω where it swings, else that of the faster of its two decays.
    pub fn fastest(&self) -> f64 {
        self.omega * (self.zeta + (self.zeta * self.zeta - 1.0).max(0.0).sqrt()).max(1.0)
    }

    /// The time after which it has shown an extreme of each sign: a period, or where it is still.
    pub fn period(&self) -> f64 {
        let damped = (1.0 - self.zeta * self.zeta).max(0.0).sqrt();
        (TAU / damped).min(STILL) / self.omega
    }

    /// The answer to a unit impulse, and its rate.
    fn impulse(&self, tau: f64) -> [f64; 2] {
        let Self { omega, zeta } = *self;
        let apart = omega * (zeta * zeta - 1.0).abs().sqrt();
        if zeta < 1.0 {
            let (sine, cosine) = (apart * tau).sin_cos();
            let decay = (-zeta * omega * tau).exp();
            return [decay * sine / apart, decay * (cosine - zeta * omega * sine / apart)];
        }
        // The slower of two decays, as a quotient: ζ − √(ζ² − 1) would lose its digits.
        let slow = omega * omega / self.fastest();
        let decay = (-slow * tau).exp();
        let between = 2.0 * apart * tau;
        let g = if between > 0.0 { -decay * (-between).exp_m1() / (2.0 * apart) } else { decay * tau };
        [g, decay * (-between).exp() - slow * g]
    }

    /// A step of length h, which is short beside its fastest rate.
    pub fn step(&self, h: f64) -> Step {
        let Self { omega, zeta } = *self;
        let [g, g_rate] = self.impulse(h);
        let impulse = |tau: f64| self.impulse(tau)[0];
        let points = GAUSS.map(|(x, weight)| (0.5 * h * (1.0 + x), 0.5 * h * weight));
        Step {
            h,
            omega_squared: omega * omega,
            c: g_rate + 2.0 * zeta * omega * g,
            g,
            g_rate,
            once: points.iter().map(|(tau, weight)| weight * impulse(*tau)).sum(),
            twice: points.iter().map(|(tau, weight)| weight * impulse(*tau) * (h - tau)).sum(),
        }
    }

    /// Acceleration of the mass, Eq. (R2), and its rate.
    pub fn mass_acceleration(&self, swing: Swing, base: f64) -> [f64; 2] {
        let Self { omega, zeta } = *self;
        let acceleration = -(2.0 * zeta * omega * swing.v + omega * omega * swing.z);
        [acceleration, -(2.0 * zeta * omega * (acceleration - base) + omega * omega * swing.v)]
    }
}

impl Step {
    /// The swing after the step, from `before` and the acceleration of the base at both ends.
    pub fn after(&self, before: Swing, base: [f64; 2]) -> Swing {
        let slope = (base[1] - base[0]) / self.h;
        Swing {
            z: self.c * before.z + self.g * before.v - base[0] * self.once - slope * self.twice,
            v: -self.omega_squared * self.g * before.z + self.g_rate * before.v - base[0] * self.g - slope * self.once,
        }
    }
}
