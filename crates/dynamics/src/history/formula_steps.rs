//! Steps that see a formula as it is. A formula does not tell its own frequencies: it is sampled before the run.
//!
//! Schemes of fourth order integrate a load by Simpson's rule, once for each step. Where that is not the integral by
//! Gauss's rule, whose nodes no period divides alike, steps are halved until it is. What is narrower than the gaps
//! between the samples, a quarter of a step, is seen only where discontinuities name its place.
//!
//! Step control does not see either what swings so that all stages of a step fall on like phases. It has no step to begin
//! with: the run is looked at in [`CELLS`] cells, and those over which the rules agree are joined again.

use crate::error::SetupError;
use crate::history::{Expression, History};

/// Error of Simpson's rule, in parts of the integral of the formula's magnitude: a ninth of a period gives this.
const ACCURACY: f64 = 1e-4;
/// The same, where steps are halved no further: at a jump that no discontinuity names.
const LEFT_OVER: f64 = 1e-3;
/// So often is a step halved at most.
const HALVINGS: u32 = 10;
/// Values that all formulas of a run may be asked for, where one costs 1 ([`History::cost`]), and those for each cell that
/// the run is looked at in: fourteen, and some for halving. Cells that are longer than steps need more halvings.
const BUDGET: f64 = 6.4e7;
const VALUES_OF_CELL: f64 = 32.0;
/// Values of the rules over a cell.
const VALUES_OF_RULES: f64 = 7.0;
/// Cells that it is looked at in under step control.
const CELLS: f64 = 4096.0;
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
    /// Steps of the formulas among `histories`, for a run until `end` in steps of `step`, or under step control.
    ///
    /// # Errors
    /// [`SetupError::FormulaTooFast`].
    pub(crate) fn new(histories: &[History], end: f64, step: Option<f64>) -> Result<Self, SetupError> {
        let mut expressions = Vec::new();
        histories.iter().for_each(|history| collect(history, &mut expressions));
        let count = expressions.len() as f64;
        let formulas = expressions.into_iter().map(|expression| {
            let budget = BUDGET / (History::Expression(expression.clone()).cost() * count);
            match step {
                Some(step) => of_fixed_steps(expression, end, step, budget),
                None => of_step_control(expression, end, budget),
            }
        });
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
        History::Product { factors } => factors.iter().for_each(|factor| collect(factor, out)),
        _ => {}
    }
}

/// Times between which the formula has no discontinuity.
fn stops(expression: &Expression, end: f64) -> Vec<f64> {
    let discontinuities = expression.discontinuities().iter().copied().filter(|t| *t > 0.0 && *t < end);
    [0.0].into_iter().chain(discontinuities).chain([end]).collect()
}

/// Cells of one length between two times.
fn cells(from: f64, to: f64, count: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..count as u64).map(move |k| [from + (to - from) * k as f64 / count, from + (to - from) * (k + 1) as f64 / count])
}

fn of_fixed_steps(expression: &Expression, end: f64, step: f64, budget: f64) -> Result<Vec<Stretch>, SetupError> {
    let stops = stops(expression, end);
    let max_cells = budget / VALUES_OF_CELL;
    let walk = || {
        stops.windows(2).flat_map(|pair| {
            let length = pair[1] - pair[0];
            let count = (length / step).ceil().min(max_cells * length / end).ceil().max(1.0);
            cells(pair[0], pair[1], count)
        })
    };
    let mut search = Search::new(expression, walk(), end, step, budget);
    let mut found: Vec<Stretch> = Vec::new();
    for [start, stop] in walk() {
        let length = stop - start;
        let needed = search.longest_step([start, stop], step.min(length))?;
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

fn of_step_control(expression: &Expression, end: f64, budget: f64) -> Result<Vec<Stretch>, SetupError> {
    let stops = stops(expression, end);
    let max_cells = CELLS.min(budget / VALUES_OF_CELL).max(1.0);
    let between = |pair: &[f64]| -> Vec<[f64; 2]> {
        let count = (max_cells * (pair[1] - pair[0]) / end).ceil() as u64;
        cells(pair[0], pair[1], count.next_power_of_two() as f64).collect()
    };
    let mut search = Search::new(expression, stops.windows(2).flat_map(between), end, end / max_cells, budget);
    let mut found: Vec<Stretch> = Vec::new();
    for pair in stops.windows(2) {
        let cells = between(pair);
        let length = (pair[1] - pair[0]) / cells.len() as f64;
        let steps = cells.iter().map(|cell| search.longest_step(*cell, length));
        let mut steps = steps.collect::<Result<Vec<f64>, _>>()?;
        search.join(&cells, &mut steps);
        for ([start, stop], step) in cells.into_iter().zip(steps) {
            match found.last_mut() {
                Some(last) if is_same(step, last.step) || step.max(last.step) < 0.9 * length => {
                    last.end = stop;
                    last.step = last.step.min(step);
                }
                _ => found.push(Stretch { start, end: stop, step }),
            }
        }
    }
    Ok(found)
}

/// But for rounding.
fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b
}

/// Integrals over a cell.
struct Rules {
    /// Difference of Simpson's and Gauss's.
    difference: f64,
    /// Integral of the magnitude.
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
    /// Integral of the formula's magnitude over the run.
    magnitude: f64,
    /// Error of Simpson's rule, per time.
    allowed: f64,
    /// Length in which the run is looked at.
    step: f64,
    /// Sum of the differences where steps are as short as they may be.
    left_over: f64,
    /// Values that may still be asked for. Where there are none left, steps are as short as the shortest so far.
    values: f64,
    shortest: f64,
}

impl<'a> Search<'a> {
    fn new(expression: &'a Expression, walk: impl Iterator<Item = [f64; 2]>, end: f64, step: f64, budget: f64) -> Self {
        let (mut magnitude, mut values) = (0.0, budget);
        for cell in walk {
            magnitude += rules(expression, cell).magnitude;
            values -= VALUES_OF_RULES;
        }
        let allowed = ACCURACY * magnitude / end;
        Self { expression, magnitude, allowed, step, left_over: 0.0, values, shortest: f64::INFINITY }
    }

    fn is_seen(&self, [start, end]: [f64; 2], difference: f64) -> bool {
        // A value that is no number is none in the run too, which stops there.
        difference.is_nan() || difference <= self.allowed * (end - start)
    }

    /// Length of the steps that see the formula in a cell, `longest` halved some times at most.
    ///
    /// # Errors
    /// [`SetupError::FormulaTooFast`].
    fn longest_step(&mut self, cell: [f64; 2], longest: f64) -> Result<f64, SetupError> {
        let needed = self.halved(cell, longest / f64::from(1_u32 << HALVINGS));
        if self.left_over <= LEFT_OVER * self.magnitude {
            return Ok(needed);
        }
        Err(SetupError::FormulaTooFast { text: self.expression.text().to_owned(), step: self.step, shortest: needed })
    }

    fn halved(&mut self, [start, end]: [f64; 2], limit: f64) -> f64 {
        let length = end - start;
        if self.values <= 0.0 {
            return length.min(self.shortest.max(limit));
        }
        self.values -= VALUES_OF_RULES;
        let Rules { difference, .. } = rules(self.expression, [start, end]);
        self.shortest = self.shortest.min(length);
        if self.is_seen([start, end], difference) {
            return length;
        }
        if length < 1.5 * limit {
            self.left_over += difference;
            return length;
        }
        let middle = 0.5 * (start + end);
        self.halved([start, middle], limit).min(self.halved([middle, end], limit))
    }

    /// Lengthens the steps of cells, a power of two of them, that are seen together.
    fn join(&self, cells: &[[f64; 2]], steps: &mut [f64]) {
        let length = cells[0][1] - cells[0][0];
        let mut seen: Vec<bool> = steps.iter().map(|step| *step > 0.9 * length).collect();
        let mut size = 1;
        while seen.len() > 1 && seen.contains(&true) {
            size *= 2;
            let pairs = seen.chunks(2).zip(cells.chunks(size)).zip(steps.chunks_mut(size));
            seen = pairs
                .map(|((halves, cells), steps)| {
                    let block = [cells[0][0], cells[size - 1][1]];
                    let is_seen =
                        halves[0] && halves[1] && self.is_seen(block, rules(self.expression, block).difference);
                    if is_seen {
                        steps.fill(block[1] - block[0]);
                    }
                    is_seen
                })
                .collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(
        text: &str,
        discontinuities: &[f64],
        end: f64,
        step: impl Into<Option<f64>>,
    ) -> Result<FormulaSteps, SetupError> {
        let expression = Expression::new(text, discontinuities.to_vec()).unwrap();
        FormulaSteps::new(
            &[History::Product { factors: vec![History::Constant, History::Expression(expression)] }],
            end,
            step.into(),
        )
    }

    /// Closed form: parts of the period of the sine.
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
        // A spike between the samples of a step is seen where discontinuities tell of it.
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

    /// Closed form: parts of the period of the sine.
    #[test]
    fn under_step_control_steps_are_as_long_as_the_formula_allows() {
        let controlled = |text: &str, discontinuities: &[f64]| steps(text, discontinuities, 1.0, None).unwrap();
        for omega in [10.0, 1e4] {
            let period = std::f64::consts::TAU / omega;
            let found = controlled(&format!("sin({omega}*t)"), &[]).longest_step(0.3);
            assert!(found < period / 5.0 && found > period / 40.0, "{omega}: {found}");
        }
        assert_eq!(controlled("1 + t - t^3", &[]).longest_step(0.3), 1.0);
        assert_eq!(controlled("sign(t - 0.3)", &[0.3]).longest_step(0.5), 0.7);
        let bell = controlled("exp(-((t - 0.5)/1e-4)^2)", &[]);
        assert!(bell.longest_step(0.5) < 1e-4 && bell.longest_step(0.2) > 0.1, "{:?}", bell.formulas);
        assert!(bell.stops().count() < 60);
        assert!(steps("sin(1e9*t)", &[], 1.0, None).is_err());
    }

    #[test]
    fn a_formula_that_no_step_follows_is_refused() {
        let error = steps("sin(1e9*t)", &[], 1.0, 1e-2).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("sin(1e9*t)") && message.contains("discontinuities"), "{message}");
    }

    #[test]
    fn the_values_of_a_long_formula_are_counted() {
        // Waves of a hundredth of a step that grow: the halvings end before they are refused.
        let text = format!("sin(6e5*t){}", " + 0*t*t*t*t*t".repeat(60));
        for step in [Some(1e-4), None] {
            let before = crate::history::expression::evaluations();
            let _ = steps(&text, &[], 1.0, step);
            let found = crate::history::expression::evaluations() - before;
            assert!(found < 170_000 && found > 1_000, "{found}");
        }
        // What is smooth is still left alone.
        let text = format!("exp(-t){}", " + 0*t*t*t*t*t".repeat(60));
        assert_eq!(steps(&text, &[], 1.0, 1e-5).unwrap().stops().count(), 0);
    }

    #[test]
    fn a_formula_without_a_value_leaves_the_run_to_find_it() {
        assert!(steps("1/(t - t)", &[], 1.0, 1e-2).is_ok());
    }
}
