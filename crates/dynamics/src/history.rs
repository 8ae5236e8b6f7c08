//! How loads go with time.

pub(crate) mod expression;
pub(crate) mod formula_steps;
mod scan;
mod table;

use std::f64::consts::{PI, TAU};

pub use expression::Expression;
use keys::{Key, Keyed};
use serde::Deserialize;
pub use table::Table;

use crate::error::SetupError;

/// The course of a load in time, as a factor of its amplitude.
///
/// Times are those of the run, frequencies cycles per time, phases radians. Kinds with a start are zero before it; those
/// with a duration (but for the ramp, which stays at one) are zero after it. As data it is an enum whose variants have
/// kebab-case names; a table and an expression have, as data, other types `T` and `E` than those that can be evaluated,
/// and [`Self::try_map`] goes from one to the other.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(tag = "kind"))]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum History<T = Table, E = Expression> {
    /// One at all times.
    #[default]
    Constant,
    /// Zero before a time, one from there on.
    Step {
        /// The time; one that is not positive has happened before the run.
        at: f64,
    },
    /// Zero, then straight up to one within the duration, then one.
    Ramp {
        /// Beginning; default 0.
        #[serde(default)]
        start: f64,
        /// Length of the rise.
        duration: f64,
    },
    /// `sin(π (t − start) / duration)` within the duration, zero before and after.
    HalfSine {
        /// Beginning; default 0. A negative one has begun before the run.
        #[serde(default)]
        start: f64,
        /// Length.
        duration: f64,
    },
    /// `sin(2π f (t − start) + phase)` from the start on, within the duration if there is one.
    Sine {
        /// f, cycles per time.
        frequency: f64,
        /// Angle at the start, rad; default 0.
        #[serde(default)]
        phase: f64,
        /// Beginning; default 0.
        #[serde(default)]
        start: f64,
        /// Length; none for ever.
        duration: Option<f64>,
    },
    /// A sine whose frequency goes straight from one value to another within the duration (a linear chirp), with phase
    /// zero at the start: `sin 2π(from τ + (to − from) τ²/2T)`, τ = t − start.
    Sweep {
        /// Frequency at the start, cycles per time.
        from: f64,
        /// Frequency at the end.
        to: f64,
        /// Beginning; default 0.
        #[serde(default)]
        start: f64,
        /// Length T.
        duration: f64,
    },
    /// Straight lines or cubics between given values.
    Table(T),
    /// A formula in t.
    Expression(E),
    /// The product of several histories.
    Product {
        /// The histories that are multiplied.
        factors: Vec<Self>,
    },
}

impl<T, E> History<T, E> {
    /// The same history with other types for its tables and expressions.
    ///
    /// # Errors
    /// The first error of the two functions.
    pub fn try_map<U, F, Error>(
        &self,
        table: &impl Fn(&T) -> Result<U, Error>,
        expression: &impl Fn(&E) -> Result<F, Error>,
    ) -> Result<History<U, F>, Error> {
        Ok(match self {
            Self::Constant => History::Constant,
            &Self::Step { at } => History::Step { at },
            &Self::Ramp { start, duration } => History::Ramp { start, duration },
            &Self::HalfSine { start, duration } => History::HalfSine { start, duration },
            &Self::Sine { frequency, phase, start, duration } => History::Sine { frequency, phase, start, duration },
            &Self::Sweep { from, to, start, duration } => History::Sweep { from, to, start, duration },
            Self::Table(data) => History::Table(table(data)?),
            Self::Expression(data) => History::Expression(expression(data)?),
            Self::Product { factors } => History::Product {
                factors: factors.iter().map(|factor| factor.try_map(table, expression)).collect::<Result<_, _>>()?,
            },
        })
    }
}

impl History {
    /// The factor at a time, by the branch that holds at `branch_time`.
    ///
    /// Between two discontinuities a history follows one smooth law. A step lies between discontinuities and its stages at both of its
    /// ends: with `branch_time` its middle, both see the law of the step, and not what is left or right of a jump there.
    /// Allocates nothing. An expression may give NaN or infinity; [`Self::check_over`] finds that beforehand.
    pub fn at(&self, time: f64, branch_time: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Step { at } => f64::from(branch_time >= *at),
            Self::Ramp { start, duration } => {
                if branch_time < *start {
                    0.0
                } else if branch_time <= start + duration {
                    (time - start) / duration
                } else {
                    1.0
                }
            }
            Self::HalfSine { start, duration } if within(*start, *duration, branch_time) => {
                (PI * (time - start) / duration).sin()
            }
            Self::Sine { frequency, phase, start, duration }
                if within(*start, duration.unwrap_or(f64::INFINITY), branch_time) =>
            {
                (TAU * frequency * (time - start) + phase).sin()
            }
            Self::Sweep { from, to, start, duration } if within(*start, *duration, branch_time) => {
                let tau = time - start;
                (TAU * tau * (from + 0.5 * (to - from) * tau / duration)).sin()
            }
            Self::HalfSine { .. } | Self::Sine { .. } | Self::Sweep { .. } => 0.0,
            Self::Table(table) => table.at(time, branch_time),
            Self::Expression(expression) => expression.at(time, branch_time),
            Self::Product { factors } => factors.iter().map(|factor| factor.at(time, branch_time)).product(),
        }
    }

    /// True if the factor at a time is the same, bit for bit, by the branches that hold at two branch times.
    pub(crate) fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        let [a, b] = branch_times;
        matches!(self, Self::Constant) || a == b || self.at(time, a).to_bits() == self.at(time, b).to_bits()
    }

    /// The factor's rate at a time, by the branch that holds at `branch_time`; per time.
    ///
    /// It is the exact derivative. Allocates nothing.
    pub fn rate(&self, time: f64, branch_time: f64) -> f64 {
        match self {
            Self::Ramp { start, duration } if within(*start, *duration, branch_time) => duration.recip(),
            Self::HalfSine { start, duration } if within(*start, *duration, branch_time) => {
                let circular = PI / duration;
                circular * (circular * (time - start)).cos()
            }
            Self::Sine { frequency, phase, start, duration }
                if within(*start, duration.unwrap_or(f64::INFINITY), branch_time) =>
            {
                let circular = TAU * frequency;
                circular * (circular * (time - start) + phase).cos()
            }
            Self::Sweep { from, to, start, duration } if within(*start, *duration, branch_time) => {
                let tau = time - start;
                let circular = |average: f64| TAU * (from + average * (to - from) * tau / duration);
                circular(1.0) * (tau * circular(0.5)).cos()
            }
            Self::Constant | Self::Step { .. } | Self::Ramp { .. } => 0.0,
            Self::HalfSine { .. } | Self::Sine { .. } | Self::Sweep { .. } => 0.0,
            Self::Table(table) => table.rate(time, branch_time),
            Self::Expression(expression) => expression.rate(time, branch_time),
            Self::Product { factors } => {
                let times = |(value, rate): (f64, f64), factor: &Self| {
                    let (by, by_rate) = (factor.at(time, branch_time), factor.rate(time, branch_time));
                    (value * by, rate * by + value * by_rate)
                };
                factors.iter().fold((1.0, 0.0), times).1
            }
        }
    }

    /// Times at which the factor or one of its rates jumps, rising. A step must not reach across one.
    ///
    /// An expression has those that were named with it.
    pub fn discontinuities(&self) -> Vec<f64> {
        match self {
            Self::Constant => vec![],
            Self::Step { at: start } | Self::Sine { start, duration: None, .. } => vec![*start],
            Self::Ramp { start, duration }
            | Self::HalfSine { start, duration }
            | Self::Sine { start, duration: Some(duration), .. }
            | Self::Sweep { start, duration, .. } => vec![*start, start + duration],
            Self::Table(table) => table.discontinuities().to_vec(),
            Self::Expression(expression) => expression.discontinuities().to_vec(),
            Self::Product { factors } => {
                let mut discontinuities: Vec<f64> = factors.iter().flat_map(Self::discontinuities).collect();
                discontinuities.sort_by(f64::total_cmp);
                discontinuities.dedup();
                discontinuities
            }
        }
    }

    /// True if it has a formula.
    pub(crate) fn has_formula(&self) -> bool {
        match self {
            Self::Expression(_) => true,
            Self::Product { factors } => factors.iter().any(Self::has_formula),
            _ => false,
        }
    }

    /// Longest step that sees the factor as it is in a stretch of time around `branch_time` that has no discontinuity: a sixteenth
    /// of a period of what swings, so that Simpson's rule errs by 1e-5 of it. Straight lines and cubics are seen by any step; for
    /// expressions see [`FormulaSteps`](crate::history::formula_steps::FormulaSteps).
    pub(crate) fn longest_step(&self, branch_time: f64) -> f64 {
        let of_period = |period: f64| period / 16.0;
        match self {
            Self::HalfSine { start, duration } if within(*start, *duration, branch_time) => of_period(2.0 * duration),
            Self::Sine { frequency, start, duration, .. }
                if within(*start, duration.unwrap_or(f64::INFINITY), branch_time) =>
            {
                of_period(frequency.recip())
            }
            Self::Sweep { from, to, start, duration } if within(*start, *duration, branch_time) => {
                of_period(from.max(*to).recip())
            }
            Self::Product { factors } => {
                factors.iter().map(|f| f.longest_step(branch_time)).fold(f64::INFINITY, f64::min)
            }
            _ => f64::INFINITY,
        }
    }

    /// Refuses times and angles that are not finite, durations and frequencies that are not positive (a sweep may begin
    /// or end at zero), and a product of nothing.
    pub fn check(&self) -> Result<(), SetupError> {
        match self {
            Self::Constant | Self::Table(_) | Self::Expression(_) => Ok(()),
            Self::Step { at } => finite("the time of a step", *at),
            Self::Ramp { start, duration } => {
                finite("the start of a ramp", *start)?;
                positive("the duration of a ramp", *duration)
            }
            Self::HalfSine { start, duration } => {
                finite("the start of a half-sine", *start)?;
                positive("the duration of a half-sine", *duration)
            }
            Self::Sine { frequency, phase, start, duration } => {
                positive("the frequency of a sine", *frequency)?;
                finite("the phase of a sine", *phase)?;
                finite("the start of a sine", *start)?;
                duration.map_or(Ok(()), |duration| positive("the duration of a sine", duration))
            }
            Self::Sweep { from, to, start, duration } => {
                for (what, found) in [("the first frequency of a sweep", *from), ("the last frequency of a sweep", *to)]
                {
                    if !(found >= 0.0 && found.is_finite()) {
                        return Err(SetupError::Value { what, found, expected: "zero or more" });
                    }
                }
                finite("the start of a sweep", *start)?;
                positive("the duration of a sweep", *duration)
            }
            Self::Product { factors } if factors.is_empty() => {
                Err(SetupError::Entries { what: "a product of histories", found: 0, expected: "at least one".into() })
            }
            Self::Product { factors } => factors.iter().try_for_each(Self::check),
        }
    }
}

/// True if a time is in the closed interval.
fn within(start: f64, duration: f64, time: f64) -> bool {
    (start..=start + duration).contains(&time)
}

/// Refuses a number that is not finite.
pub(crate) fn finite(what: &'static str, found: f64) -> Result<(), SetupError> {
    if found.is_finite() { Ok(()) } else { Err(SetupError::Value { what, found, expected: "a finite number" }) }
}

/// Refuses a number that is not positive and finite.
pub(crate) fn positive(what: &'static str, found: f64) -> Result<(), SetupError> {
    if found > 0.0 && found.is_finite() {
        Ok(())
    } else {
        Err(SetupError::Value { what, found, expected: "a positive number" })
    }
}

impl Keyed for History {
    fn key(&self, key: Key) -> Key {
        match self {
            Self::Constant => key.of("constant", 1),
            Self::Step { at } => key.of("step", 1).with("at", at),
            Self::Ramp { start, duration } => key.of("ramp", 1).with("start", start).with("duration", duration),
            Self::HalfSine { start, duration } => {
                key.of("half-sine", 1).with("start", start).with("duration", duration)
            }
            Self::Sine { frequency, phase, start, duration } => {
                let key = key.of("sine", 1).with("frequency", frequency).with("phase", phase);
                key.with("start", start).with("duration", duration)
            }
            Self::Sweep { from, to, start, duration } => {
                key.of("sweep", 1).with("from", from).with("to", to).with("start", start).with("duration", duration)
            }
            Self::Table(table) => table.key(key),
            Self::Expression(expression) => {
                let key = key.of("expression", 1).with("text", expression.text());
                key.with("discontinuities", expression.discontinuities())
            }
            Self::Product { factors } => {
                let key = key.of("product", 1).with("factors", &factors.len());
                factors.iter().fold(key, |key, factor| factor.key(key))
            }
        }
    }
}
