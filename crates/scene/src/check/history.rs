//! The rules on histories, and the tables that they name.

use std::io::Read;
use std::path::Path;

use super::{Check, LONGEST_TABLES};
use crate::document::join;
use crate::error::SceneError;
use crate::loads::history::{Formula, History, TablePoints};
use crate::text::ordinary_file::open_ordinary;
use crate::text::place::Place;
use crate::text::points::{PointsError, points_of};
use crate::text::shorten::shorten;

/// Content of a table.
const PAIRS: &str = "pairs of time and factor";

/// Help about times that are too close.
const APART: &str = "move the times apart, or make the run shorter; for a jump use `kind = \"step\"`";

impl Check<'_> {
    /// Checks a history and reads the table files that it names.
    pub(super) fn history(&self, key: &str, history: &mut History) -> Result<(), SceneError> {
        match history {
            History::Constant | History::Step { .. } => Ok(()),
            History::Ramp { duration, .. } => {
                self.duration(key, *duration, "give the time from 0 to 1, e.g. `duration = 0.02`")
            }
            History::HalfSine { duration, .. } => {
                self.duration(key, *duration, "give the length of the pulse in time, e.g. `duration = 0.02`")
            }
            History::Sine { frequency, duration, .. } => {
                let help = "give the frequency in cycles per time, e.g. `frequency = 50.0`";
                self.positive(&join(key, "frequency"), *frequency, help)?;
                match *duration {
                    Some(duration) => {
                        self.duration(key, duration, "give the length of the sine in time, or remove `duration`")
                    }
                    None => Ok(()),
                }
            }
            History::Sweep { from, to, duration, .. } => {
                for (name, frequency) in [("from", *from), ("to", *to)] {
                    let help = "give the frequency in cycles per time, e.g. `from = 10.0, to = 100.0`";
                    self.require(frequency >= 0.0, &join(key, name), "a number of 0 or more", help)?;
                }
                self.duration(key, *duration, "give the length of the sweep in time, e.g. `duration = 2.0`")
            }
            History::Table(table) => self.table(key, table),
            History::Expression(Formula { formula, discontinuities }) => {
                self.require(
                    !formula.trim().is_empty(),
                    &join(key, "formula"),
                    "a formula in the time t",
                    "give the factor as a formula, e.g. `formula = \"sin(2*pi*t)\"`",
                )?;
                let key = join(key, "discontinuities");
                self.rising(&key, discontinuities, |i| format!("[{i}]"), "times")?;
                self.apart(&key, discontinuities, |i| format!("[{i}]"))
            }
            History::Product { factors } => {
                let key = join(key, "factors");
                let help = "list the histories to multiply, e.g. `factors = [{ kind = \"sine\", frequency = 50.0 }, \
                            { kind = \"ramp\", duration = 0.1 }]`";
                self.require(!factors.is_empty(), &key, "at least one history", help)?;
                factors.iter_mut().enumerate().try_for_each(|(i, factor)| self.history(&format!("{key}[{i}]"), factor))
            }
        }
    }

    fn duration(&self, key: &str, duration: f64, help: &str) -> Result<(), SceneError> {
        let key = join(key, "duration");
        self.positive(&key, duration, help)?;
        self.not_lost(&key, duration, "duration")
    }

    /// Refuses rising times that the stepper takes for one.
    fn apart(&self, key: &str, times: &[f64], entry: impl Fn(usize) -> String) -> Result<(), SceneError> {
        match times.windows(2).position(|pair| self.is_lost(pair[1] - pair[0])) {
            None => Ok(()),
            Some(i) => Err(self.document.place(&format!("{key}{}", entry(i + 1))).refuse(
                format!("{:?} after {:?}", times[i + 1], times[i]),
                self.times_apart(),
                APART,
            )),
        }
    }

    fn times_apart(&self) -> String {
        format!("times whose distance is not lost in rounding beside the end of the run, {:?}", self.end)
    }

    fn table(&self, key: &str, table: &mut TablePoints) -> Result<(), SceneError> {
        let help = "keep `points` for a table in the scene, or `file` for one in a CSV file";
        self.at_most_one(key, &["points", "file"], help)?;
        if let Some(file) = &mut table.file {
            let key = join(key, "file");
            *file = self.document.folder().join(&file);
            table.points = self.read_table(&key, file)?;
            return Ok(());
        }
        let key = join(key, "points");
        if !self.has(&key) {
            return Err(self.document.place(&key).refuse(
                "neither `points` nor `file`",
                "exactly one of them",
                "give the table, e.g. `points = [[0.0, 0.0], [0.1, 1.0]]`, or a CSV file, e.g. `file = \"pulse.csv\"`",
            ));
        }
        let help = "give times and factors, e.g. `points = [[0.0, 0.0], [0.1, 1.0]]`";
        self.require(table.points.len() >= 2, &key, &format!("at least two {PAIRS}"), help)?;
        let times: Vec<f64> = table.points.iter().map(|[time, _]| *time).collect();
        self.rising(&key, &times, |i| format!("[{i}][0]"), "times")?;
        self.apart(&key, &times, |i| format!("[{i}][0]"))
    }

    fn read_table(&self, key: &str, path: &Path) -> Result<Vec<[f64; 2]>, SceneError> {
        self.parse_table(&self.table_text(key, path)?, path, key)
    }

    /// The text of a CSV file, as long as all tables of the scene together are not too long.
    pub(super) fn table_text(&self, key: &str, path: &Path) -> Result<String, SceneError> {
        let mut text = String::new();
        let left = self.table_bytes.get();
        let read = open_ordinary(path).and_then(|file| file.take(left + 1).read_to_string(&mut text));
        let shown = shorten(&path.to_string_lossy());
        if let Err(cause) = read {
            return Err(self.document.place(key).refuse(
                format!("a table that cannot be read: {shown}: {cause}"),
                "a CSV file, its path relative to the folder of the scene file",
                "correct the path, or make the file; it is text in UTF-8",
            ));
        }
        match left.checked_sub(text.len() as u64) {
            Some(left) => self.table_bytes.set(left),
            None => {
                return Err(self.document.place(key).refuse(
                    format!("more than {LONGEST_TABLES} bytes of tables, with {shown}"),
                    "CSV files of at most that length in all",
                    "name CSV files of two columns, with fewer points",
                ));
            }
        }
        Ok(text)
    }

    /// The points of a CSV text. A refusal names the line of the CSV file and the key of the scene.
    fn parse_table(&self, text: &str, path: &Path, key: &str) -> Result<Vec<[f64; 2]>, SceneError> {
        let place = |line: usize| Place::unseen(path, line, key.to_owned());
        let points = points_of(text)
            .map_err(|PointsError { line, found, expected, help }| place(line).refuse(found, expected, help))?;
        let lost = points.windows(2).find(|pair| self.is_lost(pair[1].1[0] - pair[0].1[0]));
        if let Some([(_, [before, _]), (line, [time, _])]) = lost {
            let found = format!("the time {time:?} after {before:?}");
            return Err(place(*line).refuse(found, self.times_apart(), APART));
        }
        Ok(points.into_iter().map(|(_, point)| point).collect())
    }
}
