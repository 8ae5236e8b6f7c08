//! Weights of an estimate of the error of a step that has the order of the scheme, from the stages of the step and of the one before.
//!
//! Eq. (J24) of `docs/method/systems.md`.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::system::collocation::{Collocation, STAGES};

/// Shortest and longest step before, over the step, with which the estimate is made: with a shorter one its weights are large.
const RATIOS: [f64; 2] = [0.6, 30.0];
/// Numbers of the estimate: its weights, and the powers of hλ up to the order of the error with the power of the start.
const COUNT: usize = 2 * STAGES + 1;
/// The estimate of y' = λy begins with (hλ)⁶ over this: so does the error of Radau IIA.
const LEADING: f64 = 7200.0;

/// Weights of the increments that make the estimate, all relative to the start of the step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TwoStepWeights {
    /// Weights of the stages of the step.
    pub now: [f64; STAGES],
    /// Weights of the stages of the step before.
    pub before: [f64; STAGES],
    /// Weight of the start of the step before.
    pub start: f64,
    /// Weight of the rates at the start of the step before, times its length.
    pub rate_before: f64,
    /// Weight of the rates at the start of the step, times its length.
    pub rate_now: f64,
}

/// Coefficients of the powers of hλ.
type Series = [f64; COUNT];

impl Collocation {
    /// Weights for a step before that is `ratio` times as long; `None` where the estimate would be a bad one.
    pub fn two_step_weights(&self, ratio: f64) -> Option<TwoStepWeights> {
        if self.is_explicit || !(RATIOS[0]..=RATIOS[1]).contains(&ratio) {
            return None;
        }
        let s = ratio;
        let (a, c) = (self.matrix, Vector3::from(self.times));
        let power = |k: i32| c.map(|c| c.powi(k));
        let before = |k: i32| c.map(|c| (s * (c - 1.0)).powi(k));
        let e = 4.0 * a * power(3) - power(4);
        let ends = self.at_end.is_none();
        // The last columns: where the last stage is the end, the start of the step before and the rates there, in place of the last
        // stage, which is zero; else the last stage, and the rates at the start of the step.
        let row = |now: Vector3<f64>, then: Vector3<f64>, [start, rate_before, rate_now]: [f64; 3]| {
            let last = if ends { [start, rate_before] } else { [then[2], rate_now] };
            [now[0], now[1], now[2], then[0], then[1], last[0], last[1]]
        };
        let of_power = |k: i32| {
            let rate_now = if k == 1 { 1.0 } else { 0.0 };
            row(power(k), before(k), [(-s).powi(k), f64::from(k) * s * (-s).powi(k - 1), rate_now])
        };
        let (fourth, fifth) = (s.powi(4), s.powi(5));
        let of_fifth = 5.0 * a * power(4);
        let rows = [
            of_power(1),
            of_power(2),
            of_power(3),
            row(power(4) + e, before(4) + fourth * e, [fourth, -4.0 * fourth, 0.0]),
            row(of_fifth, before(5) + fifth * (of_fifth - power(5) - 5.0 * e), [-fifth, 5.0 * fifth, 0.0]),
            row(a * e, fifth * (a * e), [0.0; 3]),
            self.leading(s, ends),
        ];
        // Each row by its size, since the rows of a long step before are large.
        let mut matrix = SMatrix::<f64, COUNT, COUNT>::zeros();
        let mut right = SVector::<f64, COUNT>::zeros();
        for (i, row) in rows.iter().enumerate() {
            let scale = row.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            row.iter().enumerate().for_each(|(k, entry)| matrix[(i, k)] = entry / scale);
            if i == COUNT - 1 {
                right[i] = 1.0 / (LEADING * scale);
            }
        }
        let found = matrix.full_piv_lu().solve(&right)?;
        let now = [found[0], found[1], found[2]];
        let [then, last] = [[found[3], found[4]], [found[5], found[6]]];
        Some(if ends {
            let before = [then[0], then[1], 0.0];
            TwoStepWeights { now, before, start: last[0], rate_before: last[1], rate_now: 0.0 }
        } else {
            let before = [then[0], then[1], last[0]];
            TwoStepWeights { now, before, start: 0.0, rate_before: 0.0, rate_now: last[1] }
        })
    }

    /// Coefficients of (hλ)⁶ in the increments, for y' = λy and y = 1 at the start of the step.
    fn leading(&self, s: f64, ends: bool) -> [f64; COUNT] {
        let stages = |length: f64| -> ([Series; STAGES], Series) {
            let (mut of_stages, mut end) = ([[0.0; COUNT]; STAGES], [0.0; COUNT]);
            let (mut x, weights) = (Vector3::repeat(1.0), Vector3::from(self.weights));
            for k in 1..COUNT {
                end[k] = length.powi(k as i32) * weights.dot(&x);
                x = self.matrix * x;
                (0..STAGES).for_each(|stage| of_stages[stage][k] = length.powi(k as i32) * x[stage]);
            }
            (of_stages, end)
        };
        let (now, _) = stages(1.0);
        let (then, mut growth) = stages(s);
        growth[0] = 1.0;
        let mut start = [0.0; COUNT];
        start[0] = 1.0;
        for k in 1..COUNT {
            start[k] = -(1..=k).map(|j| growth[j] * start[k - j]).sum::<f64>();
        }
        let of_product = |a: &Series| -> f64 { (0..COUNT).map(|k| a[k] * start[COUNT - 1 - k]).sum() };
        let last = COUNT - 1;
        let of_before = then.map(|mut stage| {
            stage[0] += 1.0;
            of_product(&stage)
        });
        let mut rate = [0.0; COUNT];
        rate[1] = s;
        let others = if ends { [start[last], of_product(&rate)] } else { [of_before[2], 0.0] };
        [now[0][last], now[1][last], now[2][last], of_before[0], of_before[1], others[0], others[1]]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    /// Independent reference: the weights of the theory for equal steps, found with another program.
    #[test]
    fn the_weights_of_equal_steps_are_those_of_the_theory() {
        let found = Collocation::radau().two_step_weights(1.0).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "{a} {b}");
        found.now.into_iter().zip([0.485_521_54, 0.158_922_91, -0.044_444_44]).for_each(|(a, b)| near(a, b));
        found.before.into_iter().zip([-1.776_315_16, 1.598_537_38, 0.0]).for_each(|(a, b)| near(a, b));
        near(found.start, 1.1);
        near(found.rate_before, 1.0 / 30.0);
    }

    /// Closed form: y' = λy, whose increments are powers of R(z); the estimate is (hλ)⁶/7200 + O((hλ)⁷), for any ratio of the steps.
    #[test]
    fn the_estimate_of_exponential_growth_is_the_error_of_the_scheme() {
        for scheme in [Collocation::radau(), Collocation::gauss()] {
            for ratio in [0.7, 1.0, 1.6, 4.0] {
                let weights = scheme.two_step_weights(ratio).unwrap();
                let errors = [0.08, 0.04].map(|z: f64| {
                    let stages = |z: f64| {
                        let solved = (Matrix3::identity() - scheme.matrix * z).try_inverse().unwrap();
                        solved * Vector3::repeat(1.0)
                    };
                    let end = |z: f64, y: &Vector3<f64>| 1.0 + z * Vector3::from(scheme.weights).dot(y);
                    let (now, then) = (stages(z), stages(ratio * z));
                    let start = 1.0 / end(ratio * z, &then);
                    let sum: f64 = (0..STAGES)
                        .map(|k| weights.now[k] * (now[k] - 1.0) + weights.before[k] * (start * then[k] - 1.0))
                        .sum();
                    let rates = weights.rate_before * ratio * z * start + weights.rate_now * z;
                    (sum + weights.start * (start - 1.0) + rates) * LEADING / z.powi(6) - 1.0
                });
                assert!(
                    errors[1].abs() < 0.4 && errors[1].abs() < 0.7 * errors[0].abs().max(1e-2),
                    "{ratio}: {errors:?}"
                );
            }
        }
    }

    #[test]
    fn a_short_step_before_is_not_used() {
        assert!(Collocation::radau().two_step_weights(0.5).is_none());
        assert!(Collocation::rkmk4().two_step_weights(1.0).is_none());
    }
}
