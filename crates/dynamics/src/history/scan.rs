//! A walk along a history: its size, its spectrum, and where it is no number.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::History;
use crate::error::SetupError;

/// Values that a walk may ask for at its panels, where one costs 1 ([`History::cost`]).
const MAX_PANELS: f64 = 1e6;
/// Bytes of a formula whose value costs 1, and the least and the most that one may cost.
const CHEAP: f64 = 16.0;
const LEAST_COST: f64 = 4.0;
const MAX_COST: f64 = 400.0;

/// A short stretch between two discontinuities.
#[derive(Debug, Clone, Copy)]
struct Panel {
    middle: f64,
    half: f64,
    /// The factor at its beginning, middle and end.
    values: [f64; 3],
}

impl History {
    /// ∫₀^end |factor| dt, to about 1e-4 of itself; of one that is too fast to be walked along, the most it can be. NaN
    /// if the factor is.
    pub fn magnitude_integral(&self, end: f64) -> f64 {
        if self.is_too_fast(end) {
            return self.bound(end) * end;
        }
        let simpson = |sum: &mut f64, panel: Panel| {
            let [a, b, c] = panel.values.map(f64::abs);
            *sum += panel.half * (a + 4.0 * b + c) / 3.0;
        };
        self.refined(end, simpson, |coarse, fine| settled((fine - coarse).abs(), 1e-4 * fine))
    }

    /// Largest magnitude of the factor from 0 to the end, to about 1e-3 of itself; of one that is too fast to be walked
    /// along, the most it can be. NaN if the factor is.
    pub fn largest(&self, end: f64) -> f64 {
        if self.is_too_fast(end) {
            return self.bound(end);
        }
        let largest = |most: &mut f64, panel: Panel| {
            for value in panel.values {
                if value.is_nan() || value.abs() > *most {
                    *most = value.abs();
                }
            }
        };
        self.refined(end, largest, |coarse, fine| settled((fine - coarse).abs(), 1e-5 * fine))
    }

    /// |∫₀^end h e^(−2πi f t) dt|, the amplitude of the spectrum at a frequency in cycles per time, to about 1e-6 of
    /// [`Self::magnitude_integral`]. NaN if the factor is.
    ///
    /// By Filon's rule: a parabola through three values of the factor, times the exponential, is integrated in closed
    /// form. So only the factor needs to be resolved, and not the frequency.
    pub fn amplitude_at(&self, frequency: f64, end: f64) -> f64 {
        let omega = TAU * frequency;
        let filon = |sum: &mut Complex<f64>, panel: Panel| {
            let [a, b, c] = panel.values;
            let [m0, m1, m2] = moments(omega * panel.half);
            let real = b * m0 + 0.5 * (a - 2.0 * b + c) * m2;
            let imaginary = -0.5 * (c - a) * m1;
            *sum += Complex::from_polar(panel.half, -omega * panel.middle) * Complex::new(real, imaginary);
        };
        let scale = self.magnitude_integral(end);
        self.refined(end, filon, |coarse, fine| settled((fine - coarse).norm(), 1e-7 * scale)).norm()
    }

    /// Refuses a history that is NaN or infinite somewhere from 0 to the end, as far as a fine sampling finds it.
    pub fn check_over(&self, end: f64) -> Result<(), SetupError> {
        let first = |found: &mut Option<(f64, f64)>, panel: Panel| {
            let times = [panel.middle - panel.half, panel.middle, panel.middle + panel.half];
            *found = found.or_else(|| times.into_iter().zip(panel.values).find(|(_, value)| !value.is_finite()));
        };
        match self.walk(end, 2.0, first) {
            Some((time, found)) => Err(SetupError::HistoryNotFinite { time, found }),
            None => Ok(()),
        }
    }

    /// A quantity found by walks with finer and finer panels, until two agree.
    fn refined<S: Copy + Default>(&self, end: f64, add: impl Fn(&mut S, Panel), agree: impl Fn(S, S) -> bool) -> S {
        let mut coarse = self.walk(end, 1.0, &add);
        let panels =
            |refinement: f64| self.panels(end, end, refinement) + self.discontinuities().len() as f64 * refinement;
        let mut refinement = 2.0;
        loop {
            let fine = self.walk(end, refinement, &add);
            if agree(coarse, fine) || panels(2.0 * refinement) > self.max_panels() {
                return fine;
            }
            (coarse, refinement) = (fine, 2.0 * refinement);
        }
    }

    /// Visits panels that cover 0 to the end and reach across no discontinuity.
    fn walk<S: Default>(&self, end: f64, refinement: f64, add: impl Fn(&mut S, Panel)) -> S {
        let mut result = S::default();
        if !(end > 0.0 && end.is_finite()) {
            return result;
        }
        let discontinuities = self.discontinuities();
        let stops = discontinuities.iter().copied().filter(|t| *t > 0.0 && *t < end).chain([end]);
        let mut start = 0.0;
        for stop in stops {
            let panels = self.panels(stop - start, end, refinement) as usize;
            let (branch_time, half) = (0.5 * (start + stop), 0.5 * (stop - start) / panels as f64);
            let at = |k: usize| self.at(if k == 2 * panels { stop } else { start + half * k as f64 }, branch_time);
            let mut first = at(0);
            for k in 0..panels {
                let values = [first, at(2 * k + 1), at(2 * k + 2)];
                add(&mut result, Panel { middle: start + half * (2 * k + 1) as f64, half, values });
                first = values[2];
            }
            start = stop;
        }
        result
    }

    /// Number of panels for a stretch: sixteen a cycle, times a refinement, but not more than its share of the most.
    fn panels(&self, length: f64, end: f64, refinement: f64) -> f64 {
        let share = (self.max_panels() * (length / end)).ceil();
        ((16.0 * length * self.fastest(end)).ceil().max(1.0) * refinement).min(share).max(1.0)
    }

    /// True if a walk would miss its cycles: it might step from one zero to another.
    fn is_too_fast(&self, end: f64) -> bool {
        16.0 * end * self.fastest(end) > self.max_panels()
    }

    /// Nothing that the magnitude of the factor exceeds.
    fn bound(&self, end: f64) -> f64 {
        match self {
            Self::Product { factors } => factors.iter().map(|factor| factor.bound(end)).product(),
            Self::Table(_) | Self::Expression(_) => self.largest(end),
            _ => 1.0,
        }
    }

    /// Panels a walk may have, but for one in each stretch.
    fn max_panels(&self) -> f64 {
        MAX_PANELS / self.cost()
    }

    /// Count of a value against a budget of values: 1 for what has a closed form. A formula's goes with the square of
    /// its length, for the time that a value takes and for the number of values that it is worth waiting for; those of
    /// factors are added.
    pub fn cost(&self) -> f64 {
        match self {
            Self::Expression(expression) => {
                (expression.text().len() as f64 / CHEAP).powi(2).clamp(LEAST_COST, MAX_COST)
            }
            Self::Product { factors } => factors.iter().map(Self::cost).sum(),
            _ => 1.0,
        }
    }

    /// Highest frequency that the factor has by itself between discontinuities. An expression does not tell its own: it is
    /// taken to have less than a thousand cycles in all, a long one less, and the refinement sees to the rest.
    fn fastest(&self, end: f64) -> f64 {
        match self {
            Self::Constant | Self::Step { .. } | Self::Ramp { .. } | Self::Table(_) => 0.0,
            Self::HalfSine { duration, .. } => 0.5 / duration,
            Self::Sine { frequency, .. } => *frequency,
            Self::Sweep { from, to, .. } => from.max(*to),
            Self::Expression(_) => 1e3_f64.min(self.max_panels() / 64.0) / end,
            Self::Product { factors } => factors.iter().map(|factor| factor.fastest(end)).sum(),
        }
    }
}

/// True if a change is within a bound. One that is no number does not go away by refinement.
fn settled(change: f64, bound: f64) -> bool {
    change.is_nan() || change <= bound
}

/// `∫ cos θs ds`, `∫ s sin θs ds` and `∫ s² cos θs ds` from −1 to 1.
fn moments(theta: f64) -> [f64; 3] {
    let square = theta * theta;
    if theta.abs() < 0.05 {
        // The closed forms cancel. What is left out is below 1e-11.
        return [
            2.0 - square / 3.0 * (1.0 - square / 20.0),
            2.0 * theta * (1.0 / 3.0 - square / 30.0 * (1.0 - square / 28.0)),
            2.0 * (1.0 / 3.0 - square / 10.0 * (1.0 - square * 5.0 / 84.0)),
        ];
    }
    let (sin, cos) = theta.sin_cos();
    [2.0 * sin / theta, 2.0 * (sin / theta - cos) / theta, 2.0 * (sin + 2.0 * cos / theta - 2.0 * sin / square) / theta]
}

#[cfg(test)]
mod tests {
    use crate::history::{Expression, History, expression};

    /// A law that no walk resolves: noise, in as many terms as there is room for.
    fn noise(bytes: usize) -> History {
        let mut text = "fract(9e5*sin(7e4*t))".to_owned();
        while text.len() + 28 < bytes {
            text.push_str(" + fract(9e5*sin(7e4*t)) * 1");
        }
        History::Expression(Expression::new(&text, vec![]).unwrap())
    }

    /// Closed form: ∫ e⁻ᵗ dt.
    #[test]
    fn a_long_formula_is_asked_for_few_values() {
        for (bytes, most) in [(30, 1_600_000), (900, 16_000)] {
            for scan in [History::largest as fn(&History, f64) -> f64, History::magnitude_integral] {
                let history = noise(bytes);
                let before = expression::evaluations();
                assert!(scan(&history, 1.0).is_finite());
                let found = expression::evaluations() - before;
                assert!(found < most && found > most / 40, "{bytes}: {found}");
            }
        }
        // What is smooth is found with few, long or short: here to 1e-4.
        let smooth = format!("exp(-t){}", " + 0*t*t*t*t*t".repeat(60));
        let smooth = History::Expression(Expression::new(&smooth, vec![]).unwrap());
        let before = expression::evaluations();
        assert!((smooth.magnitude_integral(1.0) / (1.0 - (-1.0_f64).exp()) - 1.0).abs() < 1e-6);
        assert!(expression::evaluations() - before < 5_000);
    }
}
