//! Steps that see a formula as it is. A formula does not tell its own frequencies: it is sampled before the run.
//!
//! Schemes of fourth order integrate a load by Simpson's rule, once for each step. Where that is not the integral by
//! Gauss's rule, whose nodes no period divides alike, steps are halved until it is. What is narrower than the gaps
//! between the samples, a quarter of a step, is seen only where corners name its place.

use crate::error::SetupError;
use crate::history::{Expression, History};

/// Error of Simpson's rule, in parts of the integral of the formula's magnitude: a ninth of a period gives this.
const ACCURACY: f64 = 1e-4;
/// The same, where steps are halved no further: at a jump that no corner names.
const LEFT_OVER: f64 = 1e-3;
/// So often is a step halved at most.
const HALVINGS: u32 = 10;
/// Cells that the run is looked at in, at most; longer ones than steps need more halvings.
const MOST_CELLS: f64 = 1e6;
/// Places closer than so many cells are one.
const APART: f64 = 4.0;

/// Nodes and weights of Gauss's rule of ninth degree from −1 to 1, the middle first.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Where formulas ask for steps shorter than those of the run.
#[derive(Debug, Clone, Default)]
pub(crate) struct FormulaSteps {
    /// For each formula, rising.
    formulas: Vec<Vec<Stretch>>,
}

#[derive(Debug, Clone, Copy)]
struct Stretch {
    start: f64,
    end: f64,
    /// Longest step.
    step: f64,
}

impl FormulaSteps {
    /// Those of the formulas among `histories`, for a run until `end` in steps of `step`.
    ///
    /// # Errors
    /// [`SetupError::FormulaTooFast`].
    pub(crate) fn new(histories: &[History], end: f64, step: f64) -> Result<Self, SetupError> {
        let mut expressions = Vec::new();
        histories.iter().for_each(|history| collect(history, &mut expressions));
        let formulas = expressions.into_iter().map(|expression| stretches(expression, end, step));
        Ok(Self { formulas: formulas.collect::<Result<_, _>>()? })
    }

    /// Times at which the longest step changes.
    pub(crate) fn stops(&self) -> impl Iterator<Item = f64> {
        self.formulas.iter().flatten().flat_map(|stretch| [stretch.start, stretch.end])
    }

    /// Longest step at a time.
    pub(crate) fn longest_step(&self, time: f64) -> f64 {
        let of_formula = |stretches: &Vec<Stretch>| {
            let next = stretches.partition_point(|stretch| stretch.end <= time);
            stretches.get(next).filter(|stretch| stretch.start <= time).map_or(f64::INFINITY, |stretch| stretch.step)
        };
        self.formulas.iter().map(of_formula).fold(f64::INFINITY, f64::min)
    }
}

fn collect<'a>(history: &'a History, out: &mut Vec<&'a Expression>) {
    match history {
        History::Expression(expression) => out.push(expression),
        History::Product(factors) => factors.iter().for_each(|factor| collect(factor, out)),
        _ => {}
    }
}

fn stretches(expression: &Expression, end: f64, step: f64) -> Result<Vec<Stretch>, SetupError> {
    let corners = expression.corners().iter().copied().filter(|t| *t > 0.0 && *t < end);
    let stops: Vec<f64> = [0.0].into_iter().chain(corners).chain([end]).collect();
    // Cells between two corners, all of one length.
    let cells = |from: f64, to: f64| {
        let count = ((to - from) / step).ceil().min(MOST_CELLS * (to - from) / end).ceil().max(1.0);
        (0..count as u64)
            .map(move |k| [from + (to - from) * k as f64 / count, from + (to - from) * (k + 1) as f64 / count])
    };
    let walk = || stops.windows(2).flat_map(|pair| cells(pair[0], pair[1]));
    let magnitude: f64 = walk().map(|cell| rules(expression, cell).magnitude).sum();
    let mut search = Search { expression, allowed: ACCURACY * magnitude / end, shortest: step, left_over: 0.0 };
    let mut found: Vec<Stretch> = Vec::new();
    for [start, stop] in walk() {
        let length = stop - start;
        let limit = step.min(length) / f64::from(1_u32 << HALVINGS);
        let needed = search.longest_step([start, stop], limit);
        if search.left_over > LEFT_OVER * magnitude {
            let shortest = search.shortest;
            return Err(SetupError::FormulaTooFast { text: expression.text().to_owned(), step, shortest });
        }
        if needed >= step * (1.0 - 1e-9) || needed >= length {
            continue;
        }
        match found.last_mut() {
            Some(last) if start - last.end <= APART * length => {
                last.end = stop;
                last.step = last.step.min(needed);
            }
            _ => found.push(Stretch { start, end: stop, step: needed }),
        }
    }
    Ok(found)
}

/// Integrals over a cell.
struct Rules {
    /// Difference of Simpson's and Gauss's.
    difference: f64,
    /// Of the magnitude.
    magnitude: f64,
}

fn rules(expression: &Expression, [start, end]: [f64; 2]) -> Rules {
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let values = GAUSS.map(|(node, weight)| (expression.at(middle + half * node, middle), weight));
    let simpson = (expression.at(start, middle) + 4.0 * values[0].0 + expression.at(end, middle)) / 3.0;
    let gauss: f64 = values.iter().map(|(value, weight)| weight * value).sum();
    let magnitude: f64 = values.iter().map(|(value, weight)| weight * value.abs()).sum();
    Rules { difference: half * (simpson - gauss).abs(), magnitude: half * magnitude }
}

struct Search<'a> {
    expression: &'a Expression,
    /// Error of Simpson's rule, per time.
    allowed: f64,
    /// Shortest step so far.
    shortest: f64,
    /// Sum of the differences where steps are as short as they may be.
    left_over: f64,
}

impl Search<'_> {
    /// Length of the steps that see the formula in a cell, not much below `limit`.
    fn longest_step(&mut self, [start, end]: [f64; 2], limit: f64) -> f64 {
        let length = end - start;
        let Rules { difference, .. } = rules(self.expression, [start, end]);
        // A value that is no number is none in the run too, which stops there.
        if difference.is_nan() || difference <= self.allowed * length {
            return length;
        }
        if length < 1.5 * limit {
            self.left_over += difference;
            self.shortest = self.shortest.min(length);
            return length;
        }
        let middle = 0.5 * (start + end);
        self.longest_step([start, middle], limit).min(self.longest_step([middle, end], limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(text: &str, corners: &[f64], end: f64, step: f64) -> Result<FormulaSteps, SetupError> {
        let expression = Expression::new(text, corners.to_vec()).unwrap();
        FormulaSteps::new(&[History::Product(vec![History::Constant, History::Expression(expression)])], end, step)
    }

    #[test]
    fn a_sine_gets_some_nine_steps_a_period_wherever_the_step_falls() {
        let period = std::f64::consts::TAU / 1e4;
        // A step of three periods and a bit; of exactly four, of which Simpson's rule sees nothing; of many.
        for step in [2e-3, 4.0 * period, 0.05] {
            let found = steps("sin(1e4*t)", &[], 1.0, step).unwrap().longest_step(0.3);
            assert!(found < period / 8.0 && found > period / 40.0, "{step}: {found}");
        }
        // What the steps see anyway is left alone.
        assert_eq!(steps("sin(10*t)", &[], 1.0, 1e-2).unwrap().stops().count(), 0);
        assert_eq!(steps("1 + t - t^3", &[], 1.0, 0.5).unwrap().stops().count(), 0);
    }

    #[test]
    fn short_steps_are_only_where_they_are_needed() {
        let found = steps("1 + exp(-((t - 0.5)/1e-4)^2)", &[], 1.0, 1e-3).unwrap();
        let stops: Vec<f64> = found.stops().collect();
        assert!(
            stops.len() == 2 && stops[0] > 0.49 && stops[0] < 0.5 && stops[1] > 0.5 && stops[1] < 0.51,
            "{stops:?}"
        );
        assert_eq!(found.longest_step(0.3), f64::INFINITY);
        assert!(found.longest_step(0.5) < 1e-4, "{}", found.longest_step(0.5));
        // A spike between the samples of a step is seen where corners tell of it.
        let text = "exp(-((t - 0.4996)/1e-6)^2)";
        assert_eq!(steps(text, &[], 1.0, 1e-3).unwrap().stops().count(), 0);
        let found = steps(text, &[0.499_59, 0.499_61], 1.0, 1e-3).unwrap();
        assert!(found.longest_step(0.4996) < 1e-6);
    }

    #[test]
    fn a_jump_that_is_not_named_is_enclosed_and_one_that_is_costs_nothing() {
        let found = steps("sign(t - 0.123)", &[], 1.0, 1e-2).unwrap();
        assert!(found.longest_step(0.123) < 2e-5 && found.longest_step(0.2) == f64::INFINITY);
        assert_eq!(steps("sign(t - 0.123)", &[0.123], 1.0, 1e-2).unwrap().stops().count(), 0);
    }

    #[test]
    fn a_formula_that_no_step_follows_is_refused() {
        let error = steps("sin(1e9*t)", &[], 1.0, 1e-2).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("sin(1e9*t)") && message.contains("corners"), "{message}");
    }

    #[test]
    fn a_formula_without_a_value_leaves_the_run_to_find_it() {
        assert!(steps("1/(t - t)", &[], 1.0, 1e-2).is_ok());
    }
}
