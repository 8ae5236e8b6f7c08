//! Steps that see a formula as it is. A formula does not tell its own frequencies: it is sampled before the run.
//!
//! Between two discontinuities all steps are as long as the longest of 1, 1/2, 1/4, … of the distance with which Simpson's rule,
//! by which schemes of fourth order integrate a load, has the integral of the formula to [`ACCURACY`]. How far it has, Gauss's
//! rule tells, whose nodes no period divides alike.

use crate::error::SetupError;
use crate::history::{Expression, History};

/// Sum of the errors of Simpson's rule, in parts of the integral of the formula's magnitude: a ninth of a period gives this.
const ACCURACY: f64 = 1e-4;
/// The same of the shortest steps: at a jump that no discontinuity names they are short enough for no other reason.
const ACCURACY_OF_SHORTEST: f64 = 1e-3;
/// Part of the integral over the whole run that counts where that of a stretch is less: the tail of a peak needs no steps.
const OF_RUN: f64 = 1e-6;
/// Part of the error of the first moment that counts beside that of the integral: a whole period in a step has no integral.
const OF_MOMENT: f64 = 0.01;
/// Parts of the run that are looked at first, and the least of them between two discontinuities. What is narrower than a quarter of
/// one may be missed.
const FIRST: u32 = 4096;
const LEAST: u32 = 16;
/// A part is halved so often at the most: the run then has four million steps.
const MAX_HALVINGS: u32 = 10;

/// Nodes and weights of Gauss's rule of ninth degree from −1 to 1, the middle first.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The longest steps that the formulas of a run are seen with.
#[derive(Debug, Clone, Default)]
pub(crate) struct FormulaSteps {
    /// For each formula, rising.
    formulas: Vec<Vec<Stretch>>,
}

/// The time between two discontinuities of a formula.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    end: f64,
    longest_step: f64,
}

impl FormulaSteps {
    /// Steps of the formulas among `histories`, for a run until `end`.
    ///
    /// # Errors
    /// [`SetupError::FormulaTooFast`].
    pub(crate) fn new(histories: &[History], end: f64) -> Result<Self, SetupError> {
        let mut formulas = Vec::new();
        histories.iter().for_each(|history| collect(history, &mut formulas));
        Ok(Self { formulas: formulas.into_iter().map(|formula| stretches(formula, end)).collect::<Result<_, _>>()? })
    }

    /// Longest step at a time that is no discontinuity.
    pub(crate) fn longest_step(&self, time: f64) -> f64 {
        let of_formula = |stretches: &Vec<Stretch>| {
            let next = stretches.partition_point(|stretch| stretch.end <= time);
            stretches.get(next).map_or(f64::INFINITY, |stretch| stretch.longest_step)
        };
        self.formulas.iter().map(of_formula).fold(f64::INFINITY, f64::min)
    }
}

fn collect<'a>(history: &'a History, out: &mut Vec<&'a Expression>) {
    match history {
        History::Expression(expression) => out.push(expression),
        History::Product { factors } => factors.iter().for_each(|factor| collect(factor, out)),
        _ => {}
    }
}

fn stretches(formula: &Expression, end: f64) -> Result<Vec<Stretch>, SetupError> {
    let mut start = 0.0;
    let discontinuities = formula.discontinuities().iter().copied().filter(|t| *t > 0.0 && *t < end);
    let sampled = |end_of_stretch: f64| {
        let from = std::mem::replace(&mut start, end_of_stretch);
        let share = f64::from(FIRST) * ((end_of_stretch - from) / end);
        let first = (share.ceil() as u32).next_power_of_two().max(LEAST);
        let stretch = Sampled { formula, start: from, end: end_of_stretch };
        (stretch.magnitude(first), stretch, first)
    };
    let sampled: Vec<_> = discontinuities.chain([end]).map(sampled).collect();
    let of_run: f64 = sampled.iter().map(|(magnitude, ..)| magnitude).sum();
    let stretch = |(magnitude, stretch, first): (f64, Sampled<'_>, u32)| {
        let count = stretch.count_of_steps(first, magnitude.max(OF_RUN * of_run))?;
        Ok(Stretch { end: stretch.end, longest_step: (stretch.end - stretch.start) / f64::from(count) })
    };
    sampled.into_iter().map(stretch).collect()
}

/// A formula between two of its discontinuities.
struct Sampled<'a> {
    formula: &'a Expression,
    start: f64,
    end: f64,
}

impl Sampled<'_> {
    /// The integral of the formula's magnitude, in `parts` parts.
    fn magnitude(&self, parts: u32) -> f64 {
        (0..parts).map(|part| self.rules(part, parts).magnitude).filter(|part| !part.is_nan()).sum()
    }

    /// The smallest power of two of equal steps that see the formula, where `first` parts are looked at first; errors are parts of
    /// `magnitude`.
    fn count_of_steps(&self, first: u32, magnitude: f64) -> Result<u32, SetupError> {
        let is_seen = |count: u32, accuracy: f64| self.is_seen(count, accuracy * magnitude);
        if is_seen(first, ACCURACY) {
            let halves = std::iter::successors(Some(first), |count| Some(count / 2));
            return Ok(halves.take_while(|count| *count > 0 && is_seen(*count, ACCURACY)).last().unwrap_or(first));
        }
        let shortest = first << MAX_HALVINGS;
        let doubled = (1..=MAX_HALVINGS).map(|halvings| first << halvings);
        match doubled.into_iter().find(|count| is_seen(*count, ACCURACY)) {
            Some(count) => Ok(count),
            None if is_seen(shortest, ACCURACY_OF_SHORTEST) => Ok(shortest),
            None => Err(SetupError::FormulaTooFast {
                text: self.formula.text().to_owned(),
                from: self.start,
                to: self.end,
                shortest: (self.end - self.start) / f64::from(shortest),
            }),
        }
    }

    /// True if the errors of Simpson's rule in equal steps come to no more than `allowed`.
    fn is_seen(&self, count: u32, allowed: f64) -> bool {
        let mut sum = 0.0;
        (0..count).all(|step| {
            let error = self.rules(step, count).error;
            // A value that is no number is none in the run too, which stops there.
            sum += if error.is_nan() { 0.0 } else { error };
            sum <= allowed
        })
    }

    /// Integrals over one of equal steps.
    fn rules(&self, step: u32, count: u32) -> Rules {
        let length = (self.end - self.start) / f64::from(count);
        let start = self.start + length * f64::from(step);
        let (middle, half) = (start + 0.5 * length, 0.5 * length);
        let at = |node: f64| self.formula.at(middle + half * node, middle);
        let values = GAUSS.map(|(node, weight)| (node, at(node), weight));
        let [start, end] = [at(-1.0), at(1.0)];
        let integral = (start + 4.0 * values[0].1 + end) / 3.0
            - values.map(|(_, value, weight)| weight * value).iter().sum::<f64>();
        let moment =
            (end - start) / 3.0 - values.map(|(node, value, weight)| weight * node * value).iter().sum::<f64>();
        let magnitude: f64 = values.map(|(_, value, weight)| weight * value.abs()).iter().sum();
        Rules { error: half * (integral.abs() + OF_MOMENT * moment.abs()), magnitude: half * magnitude }
    }
}

/// Integrals over a step.
struct Rules {
    /// Difference of Simpson's and Gauss's rule, for the integral and for the first moment.
    error: f64,
    /// Integral of the magnitude.
    magnitude: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(text: &str, discontinuities: &[f64]) -> Result<FormulaSteps, SetupError> {
        let formula = History::Expression(Expression::new(text, discontinuities.to_vec()).unwrap());
        FormulaSteps::new(&[History::Product { factors: vec![History::Constant, formula] }], 1.0)
    }

    fn longest(text: &str, discontinuities: &[f64], time: f64) -> f64 {
        steps(text, discontinuities).unwrap().longest_step(time)
    }

    /// Closed form: parts of the period of the sine.
    #[test]
    fn a_sine_gets_nine_to_eighteen_steps_a_period() {
        for omega in [40.0, 1e3, 1e4, 123_456.7, 1e6] {
            let period = std::f64::consts::TAU / omega;
            let found = longest(&format!("sin({omega}*t)"), &[], 0.3);
            assert!(found < period / 8.5 && found > period / 18.5, "{omega}: {}", period / found);
        }
        // Steps of the first count have exactly four periods, of which Simpson's rule sees nothing, nor does Gauss's.
        let found = longest("sin(2*pi*16384*t)", &[], 0.3);
        assert!(1.0 / 16384.0 / found >= 8.0, "{found:e}");
    }

    #[test]
    fn what_is_smooth_is_left_alone() {
        assert!(longest("1 + t - t^3", &[], 0.3) >= 0.5);
        assert!(longest("exp(-t)", &[], 0.3) >= 0.25);
        assert_eq!(longest("0", &[], 0.3), 1.0);
        // So is the next stretch of what is not.
        let found = steps("sign(t - 0.3)*(1 + 0.5*sin(2000*t*(1 + sign(0.3 - t))))", &[0.3]).unwrap();
        assert!(found.longest_step(0.1) < 1e-3 && (found.longest_step(0.5) - 0.7).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn a_peak_is_seen_where_the_first_parts_or_discontinuities_tell_of_it() {
        let bell = |width: f64| format!("exp(-((t - 0.5)/{width})^2)");
        assert!(longest(&bell(1e-4), &[], 0.2) < 1e-4);
        // A spike between the samples.
        assert_eq!(longest("1 + exp(-((t - 0.4999)/1e-7)^2)", &[], 0.4999), 1.0);
        let found = steps("1 + exp(-((t - 0.4999)/1e-7)^2)", &[0.499_899, 0.499_901]).unwrap();
        assert!(found.longest_step(0.4999) < 1e-7 && found.longest_step(0.2) > 0.4, "{found:?}");
    }

    #[test]
    fn a_jump_that_is_not_named_gets_short_steps_and_one_that_is_costs_nothing() {
        let found = longest("sign(t - 0.123)", &[], 0.2);
        assert!(found < 1e-3 && found > 1e-5, "{found:e}");
        assert!((longest("sign(t - 0.123)", &[0.123], 0.2) - 0.877).abs() < 1e-15);
        // A thousand of them get the shortest steps.
        assert!(longest("fract(1000*t + 0.3)", &[], 0.2) < 1e-6);
    }

    #[test]
    fn a_formula_that_no_step_follows_is_refused_and_soon() {
        for text in ["sin(1e9*t)", "fract(9e5*sin(7e4*t))"] {
            let before = crate::history::expression::evaluations();
            let message = steps(text, &[]).unwrap_err().to_string();
            let found = crate::history::expression::evaluations() - before;
            assert!(message.contains(text) && message.contains("discontinuities"), "{message}");
            assert!(found < 1_000_000, "{found}");
        }
    }

    #[test]
    fn a_formula_without_a_value_leaves_the_run_to_find_it() {
        assert!(steps("1/(t - t)", &[]).is_ok());
    }
}
