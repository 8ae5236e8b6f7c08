//! Exact steps of an oscillator under an acceleration of its base that is straight in time.
//!
//! With the answer g to a unit impulse, `g(τ) = exp(−ζωτ) sin(ω_d τ)/ω_d`, a step of length h under a = a₀ + s t is
//! Eq. (R3):
//!
//! ```text
//! z(h)  = c z + g v − a₀ ∫g dτ − s ∫g (h − τ) dτ
//! z'(h) = −ω² g z + g' v − a₀ g − s ∫g dτ
//! ```
//!
//! with c = g' + 2ζω g. The integrals are those of Gauss with five points: no difference of large numbers is taken, so that slow
//! oscillators and short steps keep their digits.

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
    /// ω_d.
    pub fn damped(&self) -> f64 {
        self.omega * (1.0 - self.zeta * self.zeta).sqrt()
    }

    /// A step of length h, which is short beside a period.
    pub fn step(&self, h: f64) -> Step {
        let Self { omega, zeta } = *self;
        let damped = self.damped();
        let impulse = |tau: f64| (-zeta * omega * tau).exp() * (damped * tau).sin() / damped;
        let g = impulse(h);
        let g_rate = (-zeta * omega * h).exp() * (damped * h).cos() - zeta * omega * g;
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
