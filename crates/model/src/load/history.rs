//! Histories of a scene as functions of time.

use dynamics::{Expression, SetupError, Table};
use scene::{Body, Formula, History, Interpolation, Place, TablePoints, key_path};

use crate::error::BuildError;

/// A history through the run of a scene; `key` is its place there.
pub(crate) fn history(body: &Body, key: &str, history: &History) -> Result<dynamics::History, BuildError> {
    history_at((body.time.end, &|key| body.place(key)), key, history)
}

/// The same of a run with an end, whose scene shows places.
pub(crate) fn history_at(
    (end, place): (f64, &dyn Fn(&str) -> Place),
    key: &str,
    history: &History,
) -> Result<dynamics::History, BuildError> {
    let refused = |error: SetupError| -> BuildError {
        if let SetupError::HistoryNotFinite { time, found } = error {
            let found = format!("a factor of {found} at time {time:.9}");
            let help = "write it so that it has a value at all times, e.g. without a division by zero";
            return place(key).refuse(found, "finite numbers through the whole run", help).into();
        }
        if let SetupError::Expression { position, problem, help, .. } = error {
            let found = format!("a formula in which {problem} (character {position})");
            return place(&key_path(key, "formula")).refuse(found, "a formula in the time t", help).into();
        }
        let help = "correct it; docs/reference/scene.md has the rules of each kind of history";
        place(key).refuse(error.to_string(), "a history that can be evaluated", help).into()
    };
    let made = if let History::Product { factors } = history {
        let factors = factors.iter().enumerate();
        let made = factors.map(|(i, factor)| history_at((end, place), &format!("{key}.factors[{i}]"), factor));
        dynamics::History::Product { factors: made.collect::<Result<_, _>>()? }
    } else {
        let table = |TablePoints { points, interpolation, .. }: &TablePoints| {
            let (times, values) = points.iter().map(|[t, v]| (*t, *v)).unzip();
            match interpolation {
                Interpolation::Linear => Table::new(times, values),
                Interpolation::MonotoneCubic => Table::monotone_cubic(times, values),
            }
        };
        let expression = |Formula { formula, discontinuities }: &Formula| {
            Ok(Expression::new(formula, discontinuities.clone())?.with_discontinuities_until(end))
        };
        history.try_map(&table, &expression).map_err(refused)?
    };
    made.check_over(end).map_err(refused)?;
    Ok(made)
}
