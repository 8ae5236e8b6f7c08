//! The value of a quantity in the answer of a command.

use std::path::PathBuf;

use diagnostic::{Failure, Kind};
use report::at_path;
use results::Results;
use serde_json::Value as Json;

use super::case::{Case, Quantity, Row, Take, ValuePlace};
use crate::rows::columns::COLUMNS;

/// A time of a row is a sum of steps: as far as it may be from the one asked for, relative to the last one.
const ROW: f64 = 1e-6;

/// The answer of a command: its report, and the folder of its files.
pub(super) struct Answer {
    pub report: Json,
    pub folder: PathBuf,
}

/// A column and the one that numbers its rows.
#[derive(Default)]
struct Column {
    first: Vec<f64>,
    values: Vec<f64>,
}

/// The refusal of a comparison at one of its keys.
fn wrong(case: &Case, quantity: &Quantity, key: &str, found: &str, expected: String) -> Failure {
    let wrong = Kind::Input.of(case.file()).line(quantity.line).key(format!("compare.{key}"));
    wrong.found(found).expected(expected).into()
}

impl Answer {
    /// The value of a quantity, in the unit of its source.
    pub fn value(&self, case: &Case, quantity: &Quantity) -> Result<f64, Failure> {
        let wrong = |key, found: &str, expected| wrong(case, quantity, key, found, expected);
        let value = match &quantity.place {
            ValuePlace::Report(path) => {
                let found = value_at(&self.report, path).map_err(|known| wrong("value", path, known))?;
                found.as_f64().ok_or_else(|| wrong("value", path, format!("a number; there is {}", short(found))))?
            }
            ValuePlace::Column { column, row, .. } => {
                let of = self.column(case, quantity)?;
                of.row(*row).ok_or_else(|| match row {
                    Row::At(at) => wrong("at", &at.to_string(), of.range()),
                    Row::Take(_) => wrong("column", column, "a column with numbers".to_owned()),
                })?
            }
        };
        Ok(quantity.in_its_unit(value))
    }

    /// The points of a quantity of a column: place of the row, and value in the unit of the source.
    pub fn curve(&self, case: &Case, quantity: &Quantity) -> Vec<(f64, f64)> {
        let Ok(Column { first, values }) = self.column(case, quantity) else { return Vec::new() };
        first.into_iter().zip(values.into_iter().map(|value| quantity.in_its_unit(value))).collect()
    }

    /// Name of the numbers of the rows of a quantity's column.
    pub fn first_heading(&self, quantity: &Quantity) -> String {
        match &quantity.place {
            ValuePlace::Column { table: Some(table), .. } => {
                let text = std::fs::read_to_string(self.folder.join(table)).unwrap_or_default();
                text.split(',').next().unwrap_or_default().to_owned()
            }
            _ => "time".to_owned(),
        }
    }

    /// The column of a quantity; empty for a value of the report.
    fn column(&self, case: &Case, quantity: &Quantity) -> Result<Column, Failure> {
        let ValuePlace::Column { table, column, component, .. } = &quantity.place else { return Ok(Column::default()) };
        let of = match table {
            Some(table) => self.of_table(table, column),
            None => self.of_results(column, *component),
        };
        of.map_err(|known| wrong(case, quantity, "column", column, known))
    }

    /// The relative error by the mesh that the report states of a natural frequency of a body.
    pub fn stated(&self, quantity: &Quantity) -> Option<f64> {
        let ValuePlace::Report(path) = &quantity.place else { return None };
        let mode = path.strip_prefix("body.natural_frequencies")?;
        at_path(&self.report, &format!("strain_energy.mesh_errors{mode}")).ok()?.as_f64()
    }

    fn of_results(&self, column: &str, component: Option<usize>) -> Result<Column, String> {
        let path = self.report.get("results").and_then(Json::as_str).ok_or("a command with a results file, `run`")?;
        let results = Results::open(path, &COLUMNS).map_err(|error| error.to_string())?;
        let first = results.numbers("time").unwrap_or_default().to_vec();
        let table = results
            .table(column)
            .ok_or_else(|| format!("a column of the results (`flexframe export --csv - {path}` has their names)"))?;
        let component = match (component, table.width()) {
            (None, 1) => 0,
            (Some(component), width) if component < width => component,
            (_, width) => return Err(format!("`component`, 0 to {}", width - 1)),
        };
        let values = table.column(component).map(Iterator::collect).unwrap_or_default();
        Ok(Column { first, values })
    }

    fn of_table(&self, table: &str, column: &str) -> Result<Column, String> {
        let path = self.folder.join(table);
        let text =
            std::fs::read_to_string(&path).map_err(|error| format!("a table of the command, {table}: {error}"))?;
        let mut lines = text.lines();
        let heads: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let place = heads.iter().position(|head| *head == column);
        let place = place.ok_or_else(|| format!("one of the columns of {table}: {}", heads.join(", ")))?;
        let number = |line: &str, place: usize| line.split(',').nth(place).and_then(|field| field.parse().ok());
        let rows: Vec<(f64, f64)> = lines.filter_map(|line| Some((number(line, 0)?, number(line, place)?))).collect();
        let (first, values) = rows.into_iter().unzip();
        Ok(Column { first, values })
    }
}

impl Column {
    fn row(&self, row: Row) -> Option<f64> {
        let values = || self.values.iter().copied();
        match row {
            Row::At(at) => {
                let slack = ROW * self.first.last()?.abs();
                let place = self.first.iter().position(|first| (first - at).abs() <= slack)?;
                self.values.get(place).copied()
            }
            Row::Take(Take::Last) => self.values.last().copied(),
            Row::Take(Take::Largest) => values().reduce(f64::max),
            Row::Take(Take::Least) => values().reduce(f64::min),
            Row::Take(Take::Magnitude) => values().map(f64::abs).reduce(f64::max),
        }
    }

    fn range(&self) -> String {
        let of = |value: Option<&f64>| value.copied().unwrap_or_default();
        format!("a row of the {} from {} to {}", self.first.len(), of(self.first.first()), of(self.first.last()))
    }
}

/// The value at a path; else the keys that are known where it ends.
fn value_at<'a>(report: &'a Json, path: &str) -> Result<&'a Json, String> {
    at_path(report, path).map_err(|(part, json)| match json {
        Json::Object(object) => {
            format!("in the place of {part:?} one of {}", object.keys().cloned().collect::<Vec<_>>().join(", "))
        }
        Json::Array(list) => format!("in the place of {part:?} an entry of {}, from [0]", list.len()),
        other => format!("no {part:?} in {}", short(other)),
    })
}

fn short(json: &Json) -> String {
    json.to_string().chars().take(60).collect()
}
