//! Histories of a scene as functions of time.

use dynamics::{Expression, SetupError, Table};
use scene::{Formula, History, Interpolation, Scene, TablePoints, key_path};

use crate::error::BuildError;

/// A history; `key` is its place in the scene.
pub(crate) fn history(scene: &Scene, key: &str, history: &History) -> Result<dynamics::History, BuildError> {
    let refused = |error: SetupError| -> BuildError {
        if let SetupError::HistoryNotFinite { time, found } = error {
            let found = format!("a factor of {found} at time {time:.9}");
            let help = "write it so that it has a value at all times, e.g. without a division by zero";
            return scene.refuse(key, found, "finite numbers through the whole run", help).into();
        }
        if let SetupError::Expression { position, problem, help, .. } = error {
            let found = format!("a formula in which {problem} (character {position})");
            return scene.refuse(&key_path(key, "formula"), found, "a formula in the time t", help).into();
        }
        let help = "correct it; docs/reference/scene.md has the rules of each kind of history";
        scene.refuse(key, error.to_string(), "a history that can be evaluated", help).into()
    };
    let made = if let History::Product { factors } = history {
        let factors = factors.iter().enumerate();
        let made = factors.map(|(i, factor)| self::history(scene, &format!("{key}.factors[{i}]"), factor));
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
            Ok(Expression::new(formula, discontinuities.clone())?.with_discontinuities_until(scene.time.end))
        };
        history.try_map(&table, &expression).map_err(refused)?
    };
    made.check_over(scene.time.end).map_err(refused)?;
    Ok(made)
}
