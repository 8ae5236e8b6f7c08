//! Histories of a scene as functions of time.

use frames_rk4::{Expression, SetupError, Table};

use super::error::BuildError;
use crate::history;
use crate::scene::Scene;

/// A history; `key` is its place in the scene.
pub(super) fn history(scene: &Scene, key: &str, history: &history::History) -> Result<frames_rk4::History, BuildError> {
    use frames_rk4::History as To;
    use history::History as From;
    let refused = |error: SetupError| -> BuildError {
        if let SetupError::HistoryNotFinite { time, found } = error {
            let found = format!("a factor of {found} at time {time:.9}");
            let cure = "write it so that it has a value at all times, e.g. without a division by zero";
            return scene.refuse(key, found, "finite numbers through the whole run", cure).into();
        }
        scene.refuse(key, error.to_string(), "a history that can be evaluated", "correct it").into()
    };
    let made = match history {
        From::Constant => To::Constant,
        From::Step { at } => To::Step { at: *at },
        From::Ramp { start, duration } => To::Ramp { start: *start, duration: *duration },
        From::HalfSine { start, duration } => To::HalfSine { start: *start, duration: *duration },
        From::Sine { frequency, phase, start, duration } => {
            To::Sine { frequency: *frequency, phase: *phase, start: *start, duration: *duration }
        }
        From::Sweep { from, to, start, duration } => {
            To::Sweep { from: *from, to: *to, start: *start, duration: *duration }
        }
        From::Table(table) => {
            let (times, values) = table.points.iter().map(|[t, v]| (*t, *v)).unzip();
            To::Table(Table::new(times, values).map_err(refused)?)
        }
        From::Expression { formula, corners } => {
            To::Expression(Expression::new(formula, corners.clone()).map_err(refused)?)
        }
        From::Product { factors } => {
            let factors = factors.iter().enumerate();
            To::Product(
                factors
                    .map(|(i, f)| self::history(scene, &format!("{key}.factors[{i}]"), f))
                    .collect::<Result<_, _>>()?,
            )
        }
    };
    made.check_over(scene.time.end).map_err(refused)?;
    Ok(made)
}
