//! The base motion in a CSV file: two columns, time and acceleration, as all tables over time.

use std::io::Read;
use std::path::Path;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::Table;
use foreign_program::open_ordinary;
use scene::{Interpolation, points_of};
use shock::{BaseMotion, ShockError};

/// Reads a base motion, which goes from row to row by straight lines or by cubics.
pub(in crate::commands::linear) fn read(path: &Path, interpolation: Interpolation) -> Result<BaseMotion, Failure> {
    let mut text = String::new();
    let read = open_ordinary(path).and_then(|mut file| file.read_to_string(&mut text));
    let help = "name a CSV file of times and accelerations of the base";
    read.map_err(|error| Kind::Io.of(path).help(help).says(format!("the table cannot be read: {error}")))?;
    let points = points_of(&text).map_err(|error| Kind::Input.of(path).line(error.line).says(error.to_string()))?;
    let (times, accelerations): (Vec<f64>, Vec<f64>) = points.into_iter().map(|(_, [t, a])| (t, a)).unzip();
    let failed = |source: ShockError| source.in_file(path);
    match interpolation {
        Interpolation::Linear => BaseMotion::new(times, accelerations).map_err(failed),
        Interpolation::MonotoneCubic => {
            let table = Table::monotone_cubic(times.clone(), accelerations.clone());
            let table = table.map_err(|source| source.in_file(path))?;
            let motion = BaseMotion::new(times, accelerations).map_err(failed)?;
            motion.with_rates(table.rates().to_vec()).map_err(failed)
        }
    }
}
