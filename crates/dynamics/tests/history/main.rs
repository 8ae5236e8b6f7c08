//! Histories of loads: each kind against its formula, at discontinuities, and its spectrum against closed forms.

mod expressions;
mod kinds;
mod refusals;
mod scan;
mod tables;

use dynamics::{Expression, History, Table};

fn table(times: &[f64], values: &[f64]) -> History {
    History::Table(Table::new(times.to_vec(), values.to_vec()).unwrap())
}

fn formula(text: &str) -> History {
    History::Expression(Expression::new(text, vec![]).unwrap())
}

/// The factor at a time, by the law of that time.
fn at(history: &History, time: f64) -> f64 {
    history.at(time, time)
}

/// The factor at a time by the laws just before and just after it.
fn sides(history: &History, time: f64) -> [f64; 2] {
    [history.at(time, time - 1e-9), history.at(time, time + 1e-9)]
}
