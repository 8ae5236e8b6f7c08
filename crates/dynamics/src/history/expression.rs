//! Histories given by a formula in t.

mod discontinuities;
mod functions;
mod law;
mod syntax;

use std::fmt;
use std::sync::Arc;

use crate::error::SetupError;
use functions::function_names;
use law::Law;

/// The longest formula, in bytes: sums and products are evaluated by recursion, one level a term.
const LONGEST: usize = 1000;
/// A discontinuity within this part of the run from a discontinuity that is named is that discontinuity.
const SAME: f64 = 1e-12;

/// A formula in t, one smooth law between the discontinuities named with it.
///
/// Operators are `+ - * / % ^` as in mathematics: `-t^2` is −(t²), and a power of a power needs parentheses. `2 t` and
/// `t (t + 1)` are products. Constants are `pi` and `e`, angles are in radians. Kinks (as of `abs`, `min`, `max`) and jumps
/// (as of `floor`, `sign`) are to be discontinuities, so that steps end there: [`Self::with_discontinuities_until`] finds them.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
#[serde(into = "(String, Vec<f64>)", try_from = "(String, Vec<f64>)")]
pub struct Expression {
    text: Arc<str>,
    discontinuities: Vec<f64>,
    law: Arc<Law>,
}

impl Expression {
    /// Reads a formula, with the times at which it or one of its rates jumps.
    ///
    /// # Errors
    ///
    /// A text that is no formula in t, with the place; one longer than 1000 bytes; a discontinuity that is not finite.
    pub fn new(text: &str, mut discontinuities: Vec<f64>) -> Result<Self, SetupError> {
        if let Some(found) = discontinuities.iter().copied().find(|t| !t.is_finite()) {
            return Err(SetupError::Value {
                what: "a discontinuity of an expression",
                found,
                expected: "a finite number",
            });
        }
        discontinuities.sort_by(f64::total_cmp);
        discontinuities.dedup();
        if text.len() > LONGEST {
            return Err(SetupError::LongExpression { found: text.len(), most: LONGEST });
        }
        let law = syntax::read(text).map_err(|syntax::Refusal { byte, problem, help }| {
            let position = text.char_indices().take_while(|(at, _)| *at < byte).count() + 1;
            SetupError::Expression { text: text.into(), position, problem, help }
        })?;
        Ok(Self { text: text.into(), discontinuities, law: Arc::new(law) })
    }

    /// The same formula, with the kinks and jumps of its functions (`abs`, `min`, `floor`, `sign`, …) between time 0 and
    /// `end` named as discontinuities. They are found by sampling: two within a 16 384th of the time may be missed.
    #[must_use]
    pub fn with_discontinuities_until(mut self, end: f64) -> Self {
        let named = std::mem::take(&mut self.discontinuities);
        let is_named = |time: f64| named.iter().any(|discontinuity| (discontinuity - time).abs() <= SAME * end);
        self.discontinuities = discontinuities::discontinuities(&self.law, end);
        self.discontinuities.retain(|time| !is_named(*time));
        self.discontinuities.extend(&named);
        self.discontinuities.sort_by(f64::total_cmp);
        self
    }

    /// The formula.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The times named with it, rising.
    pub fn discontinuities(&self) -> &[f64] {
        &self.discontinuities
    }

    /// The value at a time; at a discontinuity the one on the side of `branch_time`.
    pub(crate) fn at(&self, time: f64, branch_time: f64) -> f64 {
        #[cfg(test)]
        EVALUATIONS.with(|count| count.set(count.get() + 1));
        self.law.value(self.beside_discontinuities(time, branch_time))
    }

    /// The rate at a time, by the branch that holds at `branch_time`: the exact derivative. At a kink that is not named
    /// as a discontinuity it is the mean of both sides; jumps have none.
    pub(super) fn rate(&self, time: f64, branch_time: f64) -> f64 {
        self.law.value_and_rate(self.beside_discontinuities(time, branch_time)).1
    }

    /// The time moved off the discontinuities to the side of `branch_time`: a formula can be asked on one side of a jump only beside
    /// it.
    fn beside_discontinuities(&self, time: f64, branch_time: f64) -> f64 {
        if self.discontinuities.is_empty() {
            return time;
        }
        let beside = |discontinuity: f64| 4.0 * f64::EPSILON * discontinuity.abs().max(f64::MIN_POSITIVE);
        let next = self.discontinuities.partition_point(|discontinuity| *discontinuity <= branch_time);
        let from = next
            .checked_sub(1)
            .map_or(f64::NEG_INFINITY, |k| self.discontinuities[k] + beside(self.discontinuities[k]));
        let to = self
            .discontinuities
            .get(next)
            .map_or(f64::INFINITY, |discontinuity| discontinuity - beside(*discontinuity));
        time.min(to).max(from)
    }
}

impl From<Expression> for (String, Vec<f64>) {
    fn from(Expression { text, discontinuities, .. }: Expression) -> Self {
        (text.to_string(), discontinuities)
    }
}

impl TryFrom<(String, Vec<f64>)> for Expression {
    type Error = SetupError;

    fn try_from((text, discontinuities): (String, Vec<f64>)) -> Result<Self, SetupError> {
        Self::new(&text, discontinuities)
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Expression").field("text", &self.text).field("discontinuities", &self.discontinuities).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.discontinuities == other.discontinuities
    }
}

#[cfg(test)]
thread_local! {
    static EVALUATIONS: std::cell::Cell<u64> = const { std::cell::Cell::new(0) };
}

/// How often expressions have been evaluated on this thread.
#[cfg(test)]
pub(crate) fn evaluations() -> u64 {
    EVALUATIONS.with(std::cell::Cell::get)
}
