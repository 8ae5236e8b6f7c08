//! The base motion in a CSV file: two columns, time and acceleration, as all tables over time.

use std::io::Read;
use std::path::Path;

use dynamics::Table;
use foreign_program::open_ordinary;
use scene::{Interpolation, points_of};
use shock::BaseMotion;

use super::error::SrsError;

/// Reads a base motion, which goes from row to row by straight lines or by cubics.
pub(in crate::commands::linear) fn read(path: &Path, interpolation: Interpolation) -> Result<BaseMotion, SrsError> {
    let path_of = || path.to_owned();
    let mut text = String::new();
    let read = open_ordinary(path).and_then(|mut file| file.read_to_string(&mut text));
    read.map_err(|source| SrsError::Unreadable { path: path_of(), source })?;
    let points = points_of(&text).map_err(|source| SrsError::Points { path: path_of(), source })?;
    let (times, accelerations): (Vec<f64>, Vec<f64>) = points.into_iter().map(|(_, [t, a])| (t, a)).unzip();
    let failed = |source| SrsError::Shock { table: path_of(), source };
    match interpolation {
        Interpolation::Linear => BaseMotion::new(times, accelerations).map_err(failed),
        Interpolation::MonotoneCubic => {
            let table = Table::monotone_cubic(times.clone(), accelerations.clone());
            let table = table.map_err(|source| SrsError::Table { path: path_of(), source })?;
            let motion = BaseMotion::new(times, accelerations).map_err(failed)?;
            motion.with_rates(table.rates().to_vec()).map_err(failed)
        }
    }
}
