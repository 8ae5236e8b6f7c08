//! A formula that has been read: its value and its rate.

use super::functions::{Binary, Unary};

/// A function of t.
pub(super) enum Law {
    Number(f64),
    Time,
    Unary(&'static Unary, Box<Law>),
    Binary(&'static Binary, Box<[Law; 2]>),
}

impl Law {
    /// A function of a law; a number where the law is one.
    pub fn unary(function: &'static Unary, of: Self) -> Self {
        match of {
            Self::Number(x) => Self::Number((function.value)(x)),
            of => Self::Unary(function, Box::new(of)),
        }
    }

    /// A function of two laws; a number where both are. Nothing else is simplified: 0/t must be no number at t = 0.
    pub fn binary(function: &'static Binary, x: Self, y: Self) -> Self {
        match (x, y) {
            (Self::Number(x), Self::Number(y)) => Self::Number((function.value)(x, y)),
            (x, y) => Self::Binary(function, Box::new([x, y])),
        }
    }

    /// The value at a time. Allocates nothing.
    pub fn value(&self, time: f64) -> f64 {
        match self {
            Self::Number(x) => *x,
            Self::Time => time,
            Self::Unary(function, of) => (function.value)(of.value(time)),
            Self::Binary(function, of) => (function.value)(of[0].value(time), of[1].value(time)),
        }
    }

    /// The value at a time and d/dt of it, by the chain rule. Allocates nothing.
    ///
    /// A constant argument gives a constant, even where the outer derivative is infinite: of `sqrt(max(0, t - 1))` the rate
    /// is 0 before t = 1.
    pub fn value_and_rate(&self, time: f64) -> (f64, f64) {
        let times = |derivative: f64, rate: f64| if rate == 0.0 { 0.0 } else { derivative * rate };
        match self {
            Self::Number(x) => (*x, 0.0),
            Self::Time => (time, 1.0),
            Self::Unary(function, of) => {
                let (x, rate) = of.value_and_rate(time);
                ((function.value)(x), times((function.derivative)(x), rate))
            }
            Self::Binary(function, of) => {
                let ((x, x_rate), (y, y_rate)) = (of[0].value_and_rate(time), of[1].value_and_rate(time));
                let [by_x, by_y] = (function.derivatives)(x, y);
                ((function.value)(x, y), times(by_x, x_rate) + times(by_y, y_rate))
            }
        }
    }

    /// True if the law has kinks or jumps.
    pub fn has_pieces(&self) -> bool {
        match self {
            Self::Number(_) | Self::Time => false,
            Self::Unary(function, of) => function.piece.is_some() || of.has_pieces(),
            Self::Binary(function, of) => function.piece.is_some() || of.iter().any(Self::has_pieces),
        }
    }

    /// The value at a time; `see` is shown the number of the smooth piece of each function that has several, in an order
    /// that is always the same.
    pub fn value_and_pieces(&self, time: f64, see: &mut impl FnMut(i64)) -> f64 {
        match self {
            Self::Number(x) => *x,
            Self::Time => time,
            Self::Unary(function, of) => {
                let x = of.value_and_pieces(time, see);
                if let Some(piece) = function.piece {
                    see(piece(x));
                }
                (function.value)(x)
            }
            Self::Binary(function, of) => {
                let (x, y) = (of[0].value_and_pieces(time, see), of[1].value_and_pieces(time, see));
                if let Some(piece) = function.piece {
                    see(piece(x, y));
                }
                (function.value)(x, y)
            }
        }
    }
}
