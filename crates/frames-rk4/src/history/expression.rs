//! Histories given by a formula in t.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use xprs::{Context, ErrorKind, Parser, xprs_fn};

use crate::error::SetupError;

/// Functions of expressions, for messages.
pub(crate) const FUNCTIONS: &str = "sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, exp, ln, log2, log10, sqrt, cbrt, abs, sign, min, max, hypot, floor, ceil, round, trunc, fract";

/// The longest formula, in bytes. It is read and evaluated by recursion, whose depth is at most this: with a hundred
/// thousand parentheses the stack would overflow, which ends the program.
const LONGEST: usize = 1000;

/// A formula in t, one smooth law between the corners named with it.
///
/// Operators are `+ - * / % ^` as in mathematics: `-t^2` is −(t²), and a power of a power needs parentheses. `2 t` is a
/// product. Constants are `pi` and `e`, angles are in radians. Kinks (as of `abs`, `min`, `max`) and jumps (as of
/// `floor`, `sign`) are best named as corners: fixed steps then end there, instead of enclosing them in shorter steps.
#[derive(Clone)]
pub struct Expression {
    text: &'static str,
    corners: Vec<f64>,
    law: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl Expression {
    /// Reads a formula, with the times at which it or one of its rates jumps.
    ///
    /// The text is kept for the life of the program, once for all expressions that are written alike.
    ///
    /// # Errors
    ///
    /// A text that is no formula in t, with the place; one longer than 1000 bytes; a corner that is not finite.
    pub fn new(text: &str, mut corners: Vec<f64>) -> Result<Self, SetupError> {
        if let Some(found) = corners.iter().copied().find(|t| !t.is_finite()) {
            return Err(SetupError::Value { what: "a corner of an expression", found, expected: "a finite number" });
        }
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        if text.len() > LONGEST {
            return Err(SetupError::LongExpression { found: text.len(), most: LONGEST });
        }
        // The parser keeps slices of what it reads: a refused text must not be kept, so it is read twice.
        law(text)?;
        let text = kept(text);
        Ok(Self { text, corners, law: law(text)? })
    }

    /// The formula.
    pub fn text(&self) -> &str {
        self.text
    }

    /// The times named with it, rising.
    pub fn corners(&self) -> &[f64] {
        &self.corners
    }

    /// The value at a time; at a corner the one on the side of `inside`.
    pub(crate) fn at(&self, time: f64, inside: f64) -> f64 {
        #[cfg(test)]
        EVALUATIONS.with(|count| count.set(count.get() + 1));
        if self.corners.is_empty() {
            return (self.law)(time);
        }
        let (from, to) = self.stretch(inside);
        (self.law)(time.min(to).max(from))
    }

    /// The rate at a time, by the law that holds at the time `inside`.
    ///
    /// It is that of the polynomial of sixth degree through values a hundred-thousandth of `span` apart, none beyond a
    /// corner: right to 1e-9 of the rate if there are less than a thousand cycles in the span.
    pub(super) fn rate(&self, time: f64, inside: f64, span: f64) -> f64 {
        const SIDE: i32 = 3;
        let (from, to) = self.stretch(inside);
        let h = (1e-5 * span).min((to - from) / f64::from(2 * SIDE));
        let reach = f64::from(SIDE) * h;
        let center = time.max(from + reach).min(to - reach);
        let s = (time - center) / h;
        let nodes = || (-SIDE..=SIDE).map(f64::from);
        // d/ds of Lagrange's polynomials.
        let slope = |k: f64| -> f64 {
            let others = || nodes().filter(move |m| *m != k);
            let without = |skipped: f64| others().filter(|m| *m != skipped).map(|m| (s - m) / (k - m)).product::<f64>();
            others().map(|m| without(m) / (k - m)).sum()
        };
        nodes().map(|k| slope(k) * (self.law)(center + k * h)).sum::<f64>() / h
    }

    /// Where the law of a time holds: the formula can be asked on one side of a jump only beside it.
    fn stretch(&self, inside: f64) -> (f64, f64) {
        let beside = |corner: f64| 4.0 * f64::EPSILON * corner.abs().max(f64::MIN_POSITIVE);
        let next = self.corners.partition_point(|corner| *corner <= inside);
        let from = next.checked_sub(1).map_or(f64::NEG_INFINITY, |k| self.corners[k] + beside(self.corners[k]));
        let to = self.corners.get(next).map_or(f64::INFINITY, |corner| corner - beside(*corner));
        (from, to)
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Expression").field("text", &self.text).field("corners", &self.corners).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.corners == other.corners
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

/// The text for the life of the program: what the parser returns borrows from it.
fn kept(text: &str) -> &'static str {
    static TEXTS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = texts.get(text) {
        return found;
    }
    let kept = Box::leak(Box::<str>::from(text));
    texts.insert(kept);
    kept
}

/// The formula as a function of t.
fn law<'a>(text: &'a str) -> Result<Arc<dyn Fn(f64) -> f64 + Send + Sync + 'a>, SetupError> {
    let refused = |byte: usize, problem: String| {
        let position = text.char_indices().take_while(|(at, _)| *at < byte).count() + 1;
        SetupError::Expression { text: text.to_owned(), position, problem }
    };
    if let Some((byte, c)) = text.char_indices().find(|(_, c)| !c.is_ascii()) {
        return Err(refused(byte, format!("`{c}` is not known")));
    }
    if let Some(byte) = power_of_power(text) {
        return Err(refused(
            byte,
            "a power of a power is read in two ways; put parentheses: (a^b)^c or a^(b^c)".into(),
        ));
    }
    let context = Context::default()
        .with_fn(xprs_fn!(static log2(x): x.log2()))
        .with_fn(xprs_fn!(static log10(x): x.log10()))
        .with_fn(xprs_fn!(static sign(x): x.signum()));
    let parsed = Parser::new_with_ctx(context).parse(text).map_err(|error| {
        let problem = match error.kind() {
            ErrorKind::UnexpectedEndOfExpression => "it ends too early".to_owned(),
            kind => kind.to_string(),
        };
        refused(error.span().start, problem)
    })?;
    // Names are slices of the text: their addresses tell where they stand.
    let place = |name: &str| (name.as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    if let Some(name) = parsed.vars.iter().filter(|name| **name != "t").min_by_key(|name| place(name)) {
        return Err(refused(place(name), format!("`{name}` is not known")));
    }
    if parsed.to_string().contains("log(") {
        let byte = text.find("log").unwrap_or(0);
        return Err(refused(byte, "`log` means two things; write ln or log10".into()));
    }
    let bound = parsed.bind("t").map_err(|error| refused(0, error.to_string()))?;
    Ok(Arc::new(bound))
}

/// Where a^b^c stands, if it does: mathematics reads it as a^(b^c), the parser as (a^b)^c.
fn power_of_power(text: &str) -> Option<usize> {
    let mut in_power = vec![false];
    let mut last = ' ';
    for (at, c) in text.char_indices().filter(|(_, c)| !c.is_whitespace()) {
        match (c, in_power.last_mut()) {
            ('(', _) => in_power.push(false),
            (')', _) => drop(in_power.pop()),
            ('^', Some(true)) => return Some(at),
            ('^', Some(power)) => *power = true,
            ('+' | '-', _) if last == '^' => {}
            ('+' | '-' | '*' | '/' | '%' | ',', Some(power)) => *power = false,
            _ => {}
        }
        last = c;
    }
    None
}
