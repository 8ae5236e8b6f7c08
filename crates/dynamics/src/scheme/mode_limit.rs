//! Where classical Runge–Kutta amplifies a mode.

use crate::error::SetupError;

/// Refuses a step at which classical RK4 amplifies a mode: |R(z)| > 1 for an eigenvalue z/step of `q̈ + 2ζω q̇ + ω² q = 0`.
pub(crate) fn check_step_of_modes(
    circular_frequencies: &[f64],
    damping_ratios: &[f64],
    step: f64,
) -> Result<(), SetupError> {
    if !(step > 0.0 && step.is_finite()) {
        return Err(SetupError::Value { what: "the step", found: step, expected: "a positive number" });
    }
    let (mode, limit) = stable_step_of_modes(circular_frequencies, damping_ratios);
    if step <= limit {
        return Ok(());
    }
    let frequency = circular_frequencies[mode] / std::f64::consts::TAU;
    Err(SetupError::StepBeyondLimit { step, limit, mode: mode + 1, frequency })
}

/// The number of the mode that limits the step of classical RK4 most, and the limit; infinite without modes.
pub(crate) fn stable_step_of_modes(circular_frequencies: &[f64], damping_ratios: &[f64]) -> (usize, f64) {
    let modes = circular_frequencies.iter().zip(damping_ratios);
    let limits = modes.map(|(omega, zeta)| stable_step(omega * omega, 2.0 * zeta * omega));
    limits.enumerate().fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
}

/// Largest step for which RK4 does not amplify `q̈ + d q̇ + λ q = 0`; 2.83/ω without damping.
fn stable_step(lambda: f64, damping: f64) -> f64 {
    let omega = lambda.sqrt();
    let stable = |step: f64| amplification(lambda * step * step, damping * step) <= 1.0 + 1e-12;
    // The stability region meets each ray once: bisect between a step well inside and one well outside.
    let (mut inside, mut outside) = (0.0, 4.0 / (omega + damping).max(f64::MIN_POSITIVE) * 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if stable(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// max |R(z)|, R(z) = 1 + z + z²/2 + z³/6 + z⁴/24, over the roots of z² + d z + λ = 0.
fn amplification(lambda: f64, damping: f64) -> f64 {
    let discriminant = 0.25 * damping * damping - lambda;
    let r = |re: f64, im: f64| {
        let (mut sum, mut term) = ((1.0, 0.0), (1.0, 0.0));
        for k in 1..=4 {
            let k = f64::from(k);
            term = ((term.0 * re - term.1 * im) / k, (term.0 * im + term.1 * re) / k);
            sum = (sum.0 + term.0, sum.1 + term.1);
        }
        f64::hypot(sum.0, sum.1)
    };
    if discriminant < 0.0 {
        r(-0.5 * damping, (-discriminant).sqrt())
    } else {
        let root = discriminant.sqrt();
        r(-0.5 * damping - root, 0.0).max(r(-0.5 * damping + root, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: √8/ω, and 2.7853 on the negative axis.
    #[test]
    fn rk4_is_stable_to_two_root_two_over_omega_and_to_2_785_on_the_negative_axis() {
        for omega in [1e-3, 1.0, 3659.0] {
            assert!((stable_step(omega * omega, 0.0) * omega - 8.0_f64.sqrt()).abs() < 1e-6);
        }
        // Strong damping: the fast root is near -d, and the real stability interval of RK4 ends at -2.7853.
        let damping = 1e4;
        assert!((stable_step(1.0, damping) * damping - 2.7853).abs() < 1e-3);
    }
}
