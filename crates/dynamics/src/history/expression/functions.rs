//! Functions and operators of formulas, each with its derivative.
//!
//! At a kink the derivative is the mean of both sides; at a jump it is zero, as on both sides. The pieces between kinks and
//! jumps are numbered, so that these can be found.

use std::f64::consts::{LN_2, LN_10};

/// A function of one number.
pub(super) struct Unary {
    pub value: fn(f64) -> f64,
    pub derivative: fn(f64) -> f64,
    /// Number of the smooth piece at an argument; `None` of a function that is smooth.
    pub piece: Option<fn(f64) -> i64>,
}

/// A function of two numbers, and its partial derivatives.
pub(super) struct Binary {
    pub value: fn(f64, f64) -> f64,
    pub derivatives: fn(f64, f64) -> [f64; 2],
    /// Number of the smooth piece at the arguments; `None` of a function that is smooth.
    pub piece: Option<fn(f64, f64) -> i64>,
}

/// Function of a name with parentheses.
pub(super) enum Function {
    Unary(Unary),
    Binary(Binary),
    /// Function of one number or more: of the first two, of that and the third, and so on.
    Repeated(Binary),
}

pub(super) static NEGATIVE: Unary = Unary { value: |x| -x, derivative: |_| -1.0, piece: None };
pub(super) static SUM: Binary = Binary { value: |x, y| x + y, derivatives: |_, _| [1.0, 1.0], piece: None };
pub(super) static DIFFERENCE: Binary = Binary { value: |x, y| x - y, derivatives: |_, _| [1.0, -1.0], piece: None };
pub(super) static PRODUCT: Binary = Binary { value: |x, y| x * y, derivatives: |x, y| [y, x], piece: None };
pub(super) static QUOTIENT: Binary =
    Binary { value: |x, y| x / y, derivatives: |x, y| [1.0 / y, -x / y / y], piece: None };
pub(super) static REMAINDER: Binary = Binary {
    value: |x, y| x % y,
    derivatives: |x, y| [1.0, -(x / y).trunc()],
    piece: Some(|x, y| (x / y).trunc() as i64),
};
pub(super) static POWER: Binary = Binary {
    value: f64::powf,
    derivatives: |x, y| {
        let by_base = if y == 0.0 { 0.0 } else { y * x.powf(y - 1.0) };
        let by_exponent = if x == 0.0 && y > 0.0 { 0.0 } else { x.powf(y) * x.ln() };
        [by_base, by_exponent]
    },
    piece: None,
};

/// Names of the functions, for messages.
pub(crate) fn function_names() -> String {
    FUNCTIONS.each_ref().map(|(name, _)| *name).join(", ")
}

/// All functions by name.
pub(super) static FUNCTIONS: [(&str, Function); 26] = [
    ("sin", unary(f64::sin, f64::cos)),
    ("cos", unary(f64::cos, |x| -x.sin())),
    ("tan", unary(f64::tan, |x| x.cos().powi(-2))),
    ("asin", unary(f64::asin, |x| 1.0 / ((1.0 - x) * (1.0 + x)).sqrt())),
    ("acos", unary(f64::acos, |x| -1.0 / ((1.0 - x) * (1.0 + x)).sqrt())),
    ("atan", unary(f64::atan, |x| 1.0 / (1.0 + x * x))),
    (
        "atan2",
        Function::Binary(Binary {
            value: f64::atan2,
            derivatives: turning,
            piece: Some(|y, x| i64::from(x < 0.0 && y < 0.0)),
        }),
    ),
    ("sinh", unary(f64::sinh, f64::cosh)),
    ("cosh", unary(f64::cosh, f64::sinh)),
    ("tanh", unary(f64::tanh, |x| x.cosh().powi(-2))),
    ("exp", unary(f64::exp, f64::exp)),
    ("ln", unary(f64::ln, f64::recip)),
    ("log2", unary(f64::log2, |x| 1.0 / (x * LN_2))),
    ("log10", unary(f64::log10, |x| 1.0 / (x * LN_10))),
    ("sqrt", unary(f64::sqrt, |x| 0.5 / x.sqrt())),
    ("cbrt", unary(f64::cbrt, |x| 1.0 / (3.0 * x.cbrt() * x.cbrt()))),
    ("abs", pieces(f64::abs, |x| if x == 0.0 { 0.0 } else { x.signum() }, below_zero)),
    ("sign", pieces(|x| if x == 0.0 { 1.0 } else { x.signum() }, |_| 0.0, below_zero)),
    ("min", repeated(least, |x, y| first_if(x < y, x == y), |x, y| i64::from(x < y))),
    ("max", repeated(greatest, |x, y| first_if(x > y, x == y), |x, y| i64::from(x > y))),
    ("hypot", Function::Binary(Binary { value: f64::hypot, derivatives: toward, piece: None })),
    ("floor", pieces(f64::floor, |_| 0.0, |x| x.floor() as i64)),
    ("ceil", pieces(f64::ceil, |_| 0.0, |x| x.ceil() as i64)),
    ("round", pieces(f64::round, |_| 0.0, |x| x.round() as i64)),
    ("trunc", pieces(f64::trunc, |_| 0.0, |x| x.trunc() as i64)),
    ("fract", pieces(f64::fract, |_| 1.0, |x| x.trunc() as i64)),
];

const fn unary(value: fn(f64) -> f64, derivative: fn(f64) -> f64) -> Function {
    Function::Unary(Unary { value, derivative, piece: None })
}

const fn pieces(value: fn(f64) -> f64, derivative: fn(f64) -> f64, piece: fn(f64) -> i64) -> Function {
    Function::Unary(Unary { value, derivative, piece: Some(piece) })
}

const fn repeated(
    value: fn(f64, f64) -> f64,
    derivatives: fn(f64, f64) -> [f64; 2],
    piece: fn(f64, f64) -> i64,
) -> Function {
    Function::Repeated(Binary { value, derivatives, piece: Some(piece) })
}

fn below_zero(x: f64) -> i64 {
    i64::from(x < 0.0)
}

/// The smaller of two numbers; of what is no number, none.
fn least(x: f64, y: f64) -> f64 {
    if x.is_nan() || y.is_nan() { f64::NAN } else { x.min(y) }
}

/// The larger of two numbers; of what is no number, none.
fn greatest(x: f64, y: f64) -> f64 {
    if x.is_nan() || y.is_nan() { f64::NAN } else { x.max(y) }
}

/// The unit vector along (x, y); zero at the origin, where √(x² + y²) has its kink.
fn toward(x: f64, y: f64) -> [f64; 2] {
    let length = x.hypot(y);
    if length == 0.0 { [0.0; 2] } else { [x / length, y / length] }
}

/// Derivatives of the angle of (x, y), by y and by x.
fn turning(y: f64, x: f64) -> [f64; 2] {
    let length = x.hypot(y);
    [x / length / length, -y / length / length]
}

/// Which of two numbers a minimum or maximum follows.
fn first_if(first: bool, alike: bool) -> [f64; 2] {
    match (first, alike) {
        (true, _) => [1.0, 0.0],
        (_, true) => [0.5, 0.5],
        _ => [0.0, 1.0],
    }
}
