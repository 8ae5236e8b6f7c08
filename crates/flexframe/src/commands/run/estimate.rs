//! Rows, bytes and time of a run, estimated before it begins.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dynamics::{Reached, RowTimes, Run, Simulation};
use memory::Bytes;
use results::{Metadata, bytes_per_row};
use scene::Shared;
use serde::Serialize;

use crate::rows::columns::COLUMNS;

/// A larger file is only written for who has asked for it.
pub(super) const LARGE: u64 = 1_000_000_000;

/// Most seconds that trial steps take, and the part of the motion that they cover.
const TRIAL: f64 = 0.05;
const TRIAL_PART: f64 = 0.05;
/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 16;

/// Estimate of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Rows, but for those at corners of loads.
    pub rows: u64,
    /// Bytes of their numbers, and of the shapes that are drawn.
    pub bytes: u64,
    /// Seconds of computing, about, by how long some first steps take; `None` where it was not tried, or these came to nothing.
    pub seconds: Option<f64>,
}

impl Estimate {
    /// Estimate of the rows of a scene, without a look at its steps; `shapes` are the bytes of what is drawn.
    pub(super) fn of_rows(scene: &Shared, metadata: &Metadata, shapes: u64) -> Self {
        let rows = RowTimes::new(scene.rows, scene.time.control, scene.time.end).count();
        let bytes = rows.saturating_mul(bytes_per_row(&COLUMNS, metadata)).saturating_add(shapes);
        Self { rows, bytes, seconds: None }
    }

    /// With the time of all islands together, by trials that leave the run as it is.
    pub(super) fn with_seconds(self, run: &Run, stop: &AtomicBool) -> Self {
        let trial = TRIAL / run.islands().len().max(1) as f64;
        let islands = run.islands().iter();
        Self { seconds: islands.map(|island| seconds(island.motion.clone(), trial, stop)).sum(), ..self }
    }
}

/// The time of the later half of some steps, which under step control have found their length by then, for the whole motion.
fn seconds(mut motion: Simulation, trial: f64, stop: &AtomicBool) -> Option<f64> {
    let (started, end) = (Instant::now(), motion.end());
    let mut before = (0.0, 0.0);
    loop {
        let reached = motion.advance(STEPS_PER_LOOK).ok()?;
        let (time, taken) = (motion.time(), started.elapsed().as_secs_f64());
        let is_over = taken >= trial || time >= TRIAL_PART * end || stop.load(Ordering::Relaxed);
        if is_over || reached == Reached::End {
            return (time > before.0).then(|| (taken - before.1) / (time - before.0) * end);
        }
        if taken <= 0.5 * trial && time <= 0.5 * TRIAL_PART * end {
            before = (time, taken);
        }
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rows, bytes, seconds } = *self;
        write!(f, "{rows} rows, {}", Bytes(usize::try_from(bytes).unwrap_or(usize::MAX)))?;
        match seconds {
            Some(seconds) if seconds < 1.0 => write!(f, ", less than a second"),
            Some(seconds) if seconds < 120.0 => write!(f, ", about {seconds:.0} s"),
            Some(seconds) if seconds < 7200.0 => write!(f, ", about {:.0} min", seconds / 60.0),
            Some(seconds) => write!(f, ", about {:.0} h", seconds / 3600.0),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_estimated_is_told_in_units_that_people_use() {
        for (bytes, seconds, text) in [
            (1_500_000, Some(0.2), "7 rows, 2 MB, less than a second"),
            (2_000_000_000, Some(75.4), "7 rows, 2.0 GB, about 75 s"),
            (1, Some(600.0), "7 rows, 1 MB, about 10 min"),
            (1, Some(72_000.0), "7 rows, 1 MB, about 20 h"),
            (1, None, "7 rows, 1 MB"),
        ] {
            assert_eq!(Estimate { rows: 7, bytes, seconds }.to_string(), text);
        }
    }
}
