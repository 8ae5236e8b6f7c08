//! How the frequency of a mode goes with its amplitude (the backbone curve), where linear strain has it constant.
//!
//! A single mode, with the displacements of second order that relieve it (`u = φ q + ½ Θ q²`, Θ = −K⁻¹ g its static
//! modal derivative, M-orthogonal to the rigid modes and to φ), moves by
//!
//! ```text
//! L = ½ (1 + m q²) q̇² − ½ ω² q² − c₃/6 q³ − c₄/24 q⁴
//! m = ΘᵀMΘ      c₃ = φ·g      c₄ = 3 (∫ ε₂(φ,φ):C:ε₂(φ,φ) dV − ΘᵀKΘ)
//! Ω²/ω² = (1 + 2 (c₄/(16 ω²) − 5 c₃²/(48 ω⁴)) a²) / (1 + ½ m a²)
//! ```
//!
//! Eqs. (G2)–(G4) of `docs/method/stiffening.md`, to second order in the amplitude a: c₄ and m by harmonic balance, c₃ by Lindstedt's series.

/// The frequency of a mode over its amplitude. [`advise`](crate::advise) and [`Review`](crate::Review) tell by it what
/// linear strain leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Backbone {
    /// m, per squared modal coordinate.
    pub inertia: f64,
    /// c₃/ω², per modal coordinate.
    pub cubic: f64,
    /// c₄/ω², per squared modal coordinate.
    pub quartic: f64,
}

/// Deflection over the length of the body from which on a run says what linear strain made of a mode.
pub(crate) const LARGE: f64 = 0.01;

/// Relative change of a frequency that a model of second order cannot be right at: a run is refused there.
pub const DETUNED: f64 = 0.25;

impl Backbone {
    /// The backbone of a mode with the circular frequency ω and the coefficients m, c₃ and c₄.
    pub fn new(omega: f64, inertia: f64, cubic: f64, quartic: f64) -> Self {
        let square = omega * omega;
        Self { inertia, cubic: cubic / square, quartic: quartic / square }
    }

    /// c₄/(16 ω²) − 5 c₃²/(48 ω⁴), per squared modal coordinate.
    pub fn stiffening(&self) -> f64 {
        self.quartic / 16.0 - 5.0 * self.cubic * self.cubic / 48.0
    }

    /// How far the force that holds the mode at an amplitude may be from ω² times it, relative.
    pub fn static_error(&self, amplitude: f64) -> f64 {
        (0.5 * self.cubic * amplitude).abs() + (self.quartic / 6.0 * amplitude * amplitude).abs()
    }

    /// Ω/ω − 1 at an amplitude in the modal coordinate; −1 where no stiffness is left.
    pub fn shift(&self, amplitude: f64) -> f64 {
        let square = amplitude * amplitude;
        ((1.0 + 2.0 * self.stiffening() * square) / (1.0 + 0.5 * self.inertia * square)).max(0.0).sqrt() - 1.0
    }

    /// Coefficient of a² in Ω/ω − 1 for small amplitudes.
    pub fn curvature(&self) -> f64 {
        self.stiffening() - 0.25 * self.inertia
    }

    /// The amplitude, in the modal coordinate, at which the frequency is [`DETUNED`]; infinite where it never is.
    pub fn largest_amplitude(&self) -> f64 {
        // (1 + 2 s x) = r² (1 + m x / 2), for a frequency ratio r on either side of 1.
        let at = |ratio: f64| {
            let square = (ratio * ratio - 1.0) / (2.0 * self.stiffening() - 0.5 * self.inertia * ratio * ratio);
            if square > 0.0 { square.sqrt() } else { f64::INFINITY }
        };
        at(1.0 - DETUNED).min(at(1.0 + DETUNED))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ω/ω − 1 of the oscillator of the module's text by RK4, from one turning point at `q0` to the next but one; and half
    /// the distance of the turning points.
    fn by_steps(omega: f64, m: f64, c3: f64, c4: f64, q0: f64) -> (f64, f64) {
        let acceleration = |q: f64, v: f64| {
            -(m * q * v * v + omega * omega * q + 0.5 * c3 * q * q + c4 / 6.0 * q * q * q) / (1.0 + m * q * q)
        };
        let h = 1e-3 / omega;
        let (mut t, mut q, mut v) = (0.0, q0, 0.0);
        let (mut turns, mut other) = (0, 0.0);
        loop {
            let (k1, l1) = (v, acceleration(q, v));
            let (k2, l2) = (v + 0.5 * h * l1, acceleration(q + 0.5 * h * k1, v + 0.5 * h * l1));
            let (k3, l3) = (v + 0.5 * h * l2, acceleration(q + 0.5 * h * k2, v + 0.5 * h * l2));
            let (k4, l4) = (v + h * l3, acceleration(q + h * k3, v + h * l3));
            let after = v + h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
            if t > 0.0 && v * after < 0.0 {
                turns += 1;
                if turns == 2 {
                    let period = t + h * v / (v - after);
                    return (std::f64::consts::TAU / (omega * period) - 1.0, 0.5 * (q0 - other));
                }
                other = q;
            }
            q += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
            v = after;
            t += h;
        }
    }

    /// Independent reference: the oscillator by RK4.
    #[test]
    fn the_shift_is_that_of_the_oscillator() {
        let omega = 3.0;
        // Inertia, cubic and quartic alone, and together; what is left is of fourth order in the amplitude.
        for (m, c3, c4) in [(2.0, 0.0, 0.0), (0.0, 8.0, 0.0), (0.0, 0.0, 30.0), (1.5, -6.0, 40.0), (3.0, 2.0, -20.0)] {
            let backbone = Backbone::new(omega, m, c3, c4);
            for q0 in [0.02, 0.06] {
                let (exact, amplitude) = by_steps(omega, m, c3, c4, q0);
                let shift = backbone.shift(amplitude);
                let small = backbone.curvature() * amplitude * amplitude;
                // Measured: 0.5 % of it at worst.
                assert!((shift / exact - 1.0).abs() < 0.02, "{m} {c3} {c4} {q0}: {shift:e} {exact:e}");
                assert!((small / exact - 1.0).abs() < 0.02, "{m} {c3} {c4} {q0}: {small:e} {exact:e}");
            }
        }
    }

    /// Conserved: the shift at the largest amplitude is the bound itself.
    #[test]
    fn the_largest_amplitude_is_a_quarter_off() {
        for backbone in
            [Backbone::new(1.0, 0.0, 0.0, 16.0), Backbone::new(1.0, 0.5, 0.0, -16.0), Backbone::new(1.0, 5.0, 0.0, 1.6)]
        {
            let amplitude = backbone.largest_amplitude();
            assert!((backbone.shift(amplitude).abs() - DETUNED).abs() < 1e-12, "{amplitude}");
            assert!(backbone.shift(0.9 * amplitude).abs() < DETUNED);
        }
        assert_eq!(Backbone::new(1.0, 0.0, 0.0, 0.0).largest_amplitude(), f64::INFINITY);
    }
}
