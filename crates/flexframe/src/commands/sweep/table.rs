//! The table of a sweep: its parameters, its results, and what became of each row.

use std::collections::BTreeMap;
use std::path::Path;

use diagnostic::Failure;
use keys::Digest;
use sealed::{Declared, Format, Kind, SealedError, SealedFile, Writer};
use serde::de::DeserializeOwned;
use toml::Value;

use super::plan::{Asked, Plan};

/// State of a row, by the numbers in the file.
const OPEN: u32 = 0;
const DONE: u32 = 1;
const FAILED: u32 = 2;

/// The dataset of what rows follow from.
const ROW_IDENTITY: &str = "row_identity";

/// State of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RowState {
    /// It has not been run.
    Open,
    /// It came to its end.
    Done(Done),
    /// Reason of their absence.
    Failed(String),
}

/// A row that came to its end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Done {
    /// The numbers of each result, in the order of the plan.
    pub results: Vec<Vec<f64>>,
    /// Warnings of its run.
    pub warnings: Vec<String>,
}

/// The rows of a sweep.
pub(super) struct Table {
    pub rows: Vec<RowState>,
    /// How many rows of the file were computed from files that have changed since; they are open again.
    pub stale: usize,
    /// The hash of the CSV file that was written with it; empty without one.
    pub csv: String,
}

impl Table {
    /// The table in a file, or an empty one where there is none. Rows that failed are open again.
    pub fn open(path: &Path, plan: &Plan, overwrite: bool) -> Result<Self, Failure> {
        let found = if overwrite { None } else { Self::read(path, plan)? };
        let mut table =
            found.unwrap_or_else(|| Self { rows: vec![RowState::Open; plan.rows.len()], stale: 0, csv: String::new() });
        for row in table.rows.iter_mut().filter(|row| matches!(row, RowState::Failed(_))) {
            *row = RowState::Open;
        }
        Ok(table)
    }

    /// The table in a file, if there is one.
    pub fn read(path: &Path, plan: &Plan) -> Result<Option<Self>, Failure> {
        if !path.exists() {
            return Ok(None);
        }
        let other = |what: &str| {
            let help = "move it away, choose another file with -o, or replace it with --overwrite";
            diagnostic::Kind::Io
                .of(path)
                .help(help)
                .says(format!("the file there is not the table of this sweep ({what})"))
        };
        let file = SealedFile::open(path, Format::BODY).map_err(|error| match error {
            SealedError::System { .. } => error.into(),
            SealedError::Damaged { what, .. } => other(&format!("it is damaged: {what}")),
            _ => other("it is no table of a sweep"),
        })?;
        if file.text("identity").is_none() {
            return Err(other("it is no table of a sweep"));
        }
        if file.text("identity") != Some(&identity(plan)) {
            return Err(other("it is of another sweep or scene, or of another version of flexframe"));
        }
        let status = file.read::<u32>("status").map_err(|_| other("it is damaged"))?.values;
        let identities = file.read::<u64>(ROW_IDENTITY).map_err(|_| other("it is damaged"))?.values;
        let words: BTreeMap<usize, String> = by_row(&file, "failures");
        let mut warnings: BTreeMap<usize, Vec<String>> = by_row(&file, "warnings");
        let mut rows = vec![RowState::Open; plan.rows.len()];
        let mut columns = Vec::new();
        for name in plan.results.keys() {
            let dataset = format!("results/{name}");
            // As long as no row is done, there is none.
            columns.push(match file.has(&dataset) {
                true => Some(file.read::<f64>(&dataset).map_err(|_| other("it is damaged"))?),
                false => None,
            });
        }
        let mut stale = 0;
        for (i, row) in rows.iter_mut().enumerate() {
            if status.get(i).is_some_and(|status| *status != OPEN) && identities.get(i) != Some(&plan.identities[i]) {
                stale += 1;
            } else if status.get(i) == Some(&DONE) {
                let of_row = |column: &Option<sealed::Array<f64>>| {
                    let column = column.as_ref()?;
                    let width = column.shape.get(1).copied()?;
                    column.values.get(i * width..(i + 1) * width).map(<[f64]>::to_vec)
                };
                if let Some(results) = columns.iter().map(of_row).collect() {
                    *row = RowState::Done(Done { results, warnings: warnings.remove(&i).unwrap_or_default() });
                }
            } else if let Some(words) = words.get(&i) {
                *row = RowState::Failed(words.clone());
            }
        }
        let csv = file.text("csv").map_or_else(String::new, str::to_owned);
        Ok(Some(Self { rows, stale, csv }))
    }

    /// How many numbers a result has, by its number in the plan; none where no row is done.
    pub fn width(&self, result: usize) -> Option<usize> {
        let of_row = |row: &RowState| match row {
            RowState::Done(done) => Some(done.results[result].len()),
            RowState::Open | RowState::Failed(_) => None,
        };
        self.rows.iter().filter_map(of_row).max()
    }

    /// How many rows are done, and how many failed.
    pub fn counts(&self) -> [usize; 2] {
        let count = |is: fn(&RowState) -> bool| self.rows.iter().filter(|row| is(row)).count();
        [count(|row| matches!(row, RowState::Done(_))), count(|row| matches!(row, RowState::Failed(_)))]
    }

    /// The rows that failed, and why.
    pub fn failures(&self) -> BTreeMap<usize, String> {
        let failed = |(i, row): (usize, &RowState)| match row {
            RowState::Failed(words) => Some((i, words.clone())),
            _ => None,
        };
        self.rows.iter().enumerate().filter_map(failed).collect()
    }

    /// The rows that came to their end with warnings, and these.
    pub fn warnings(&self) -> BTreeMap<usize, Vec<String>> {
        let warned = |(i, row): (usize, &RowState)| match row {
            RowState::Done(done) if !done.warnings.is_empty() => Some((i, done.warnings.clone())),
            _ => None,
        };
        self.rows.iter().enumerate().filter_map(warned).collect()
    }

    /// Writes the file anew.
    pub fn write(&self, path: &Path, plan: &Plan, durable: bool) -> Result<(), Failure> {
        let count = self.rows.len();
        let declared = |path: String, kind, shape: &[usize], description: String| Declared {
            path,
            kind,
            shape: shape.to_vec(),
            attributes: vec![("description", description)],
            same_as: None,
        };
        let status: Vec<u32> = self
            .rows
            .iter()
            .map(|row| match row {
                RowState::Open => OPEN,
                RowState::Done(_) => DONE,
                RowState::Failed(_) => FAILED,
            })
            .collect();
        let mut datasets =
            vec![declared("status".into(), Kind::U32, &[count], "0 not run, 1 done, 2 failed (see `failures`)".into())];
        let description = "what each row was computed from: its scene and the files that were read for it";
        datasets.push(declared(ROW_IDENTITY.into(), Kind::U64, &[count], description.into()));
        let mut columns = Vec::new();
        for (key, values) in &plan.parameters {
            let numbers: Option<Vec<f64>> = values.iter().map(number).collect();
            if let Some(numbers) = numbers {
                let path = format!("parameters/{key}");
                datasets.push(declared(path.clone(), Kind::F64, &[count], format!("{key} of the scene")));
                columns.push((path, numbers));
            }
        }
        for (i, (name, asked)) in plan.results.iter().enumerate() {
            let Some(width) = self.width(i) else { continue };
            let path = format!("results/{name}");
            let words = match asked {
                Asked::Final(column) => format!("{column} at the end; NaN where there is none"),
                Asked::Peak(column) => format!("value of largest size of {column} over time; NaN where there is none"),
                Asked::Frequencies => "natural frequencies, cycles per time; NaN where there is none".to_owned(),
                Asked::FrequenciesOf(body) => {
                    format!("natural frequencies of the body {body}, cycles per time; NaN where there is none")
                }
            };
            datasets.push(declared(path.clone(), Kind::F64, &[count, width], words));
            let mut numbers = vec![f64::NAN; count * width];
            for (row, place) in self.rows.iter().zip(numbers.chunks_mut(width.max(1))) {
                if let RowState::Done(done) = row {
                    place.iter_mut().zip(&done.results[i]).for_each(|(place, value)| *place = *value);
                }
            }
            columns.push((path, numbers));
        }
        let parameters: BTreeMap<&str, &[Value]> =
            plan.parameters.iter().map(|(key, values)| (key.as_str(), values.as_slice())).collect();
        let json = |text: Result<String, serde_json::Error>| text.unwrap_or_default();
        let texts = BTreeMap::from([
            ("title".to_owned(), plan.title.clone()),
            ("identity".to_owned(), identity(plan)),
            ("program_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("parameters".to_owned(), json(serde_json::to_string(&parameters))),
            ("failures".to_owned(), json(serde_json::to_string(&self.failures()))),
            ("warnings".to_owned(), json(serde_json::to_string(&self.warnings()))),
            ("csv".to_owned(), self.csv.clone()),
        ]);
        let mut writer = Writer::create(path, texts, &datasets)?;
        writer.write("status", &status)?;
        writer.write(ROW_IDENTITY, &plan.identities)?;
        for (path, numbers) in &columns {
            writer.write(path, numbers)?;
        }
        Ok(writer.finish(durable)?)
    }
}

/// Words of some rows, by their number.
fn by_row<T: DeserializeOwned>(file: &SealedFile, attribute: &str) -> BTreeMap<usize, T> {
    file.text(attribute).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default()
}

/// Identity of the sweep that the table belongs to.
fn identity(plan: &Plan) -> String {
    Digest::new().text(env!("CARGO_PKG_VERSION")).text(&plan.identity).finish().to_string()
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}
