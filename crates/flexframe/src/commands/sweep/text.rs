//! The table of a sweep as text: all of it as CSV, and a part for people.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;

use report::quoted;
use toml::Value;
use whole_file::WholeFile;

use super::plan::{Asked, Plan};
use super::table::{RowState, Table};
use crate::report::quantity;
use crate::rows::columns::column_of;

/// More rows than this are thinned: the file has them all.
const ROWS: usize = 20;
/// More parameters and numbers than this do not fit a line.
const COLUMNS: usize = 8;

/// Writes all rows: the number of the row from 0, what has become of it, its parameters and results, and why it failed.
pub(super) fn write_csv(path: &Path, plan: &Plan, table: &Table) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    let widths = widths_of(plan, table);
    let mut heads = vec!["row".to_owned(), "status".to_owned()];
    heads.extend(heads_of(plan, &widths));
    heads.push("failure".to_owned());
    let quoted: Vec<String> = heads.iter().map(|head| quoted(head)).collect();
    writeln!(file, "{}", quoted.join(","))?;
    for (i, row) in table.rows.iter().enumerate() {
        let (status, failure) = match row {
            RowState::Open => ("open", ""),
            RowState::Done(_) => ("done", ""),
            RowState::Failed(words) => ("failed", words.as_str()),
        };
        write!(file, "{i},{status}")?;
        for (_, values) in &plan.parameters {
            let text = match &values[i] {
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            write!(file, ",{}", quoted_line(&text))?;
        }
        for number in numbers(row, &widths) {
            match number.filter(|number| !number.is_nan()) {
                // The shortest text that is read back as the same number.
                Some(number) => write!(file, ",{number:?}")?,
                None => write!(file, ",")?,
            }
        }
        writeln!(file, ",{}", quoted_line(failure))?;
    }
    file.finish()
}

/// Some rows for people.
#[derive(Debug, Clone)]
pub(super) struct Shown {
    heads: Vec<String>,
    /// The number of each row, and its fields.
    rows: Vec<(usize, Vec<String>)>,
    /// Rows and columns that there are.
    of: [usize; 2],
}

impl Shown {
    /// Rows that were run, at equal distances, with the last one.
    pub fn new(plan: &Plan, table: &Table) -> Self {
        let widths = widths_of(plan, table);
        let mut heads = heads_of(plan, &widths);
        let run: Vec<usize> = (0..table.rows.len()).filter(|row| table.rows[*row] != RowState::Open).collect();
        let of = [run.len(), heads.len()];
        heads.truncate(COLUMNS);
        let stride = run.len().saturating_sub(1).div_ceil(ROWS - 1).max(1);
        let is_shown = |i: &usize| i.is_multiple_of(stride) || i + 1 == run.len();
        let fields = |row: usize| {
            let parameters = plan.parameters.iter().map(|(_, values)| match &values[row] {
                Value::Float(number) => quantity(*number),
                other => other.to_string(),
            });
            let result = |number: Option<f64>| match (&table.rows[row], number) {
                (RowState::Failed(_), _) => "failed".to_owned(),
                (_, Some(number)) if !number.is_nan() => quantity(number),
                _ => "-".to_owned(),
            };
            let results = numbers(&table.rows[row], &widths).map(result);
            (row, parameters.chain(results).take(COLUMNS).collect())
        };
        Self { heads, rows: (0..run.len()).filter(is_shown).map(|i| fields(run[i])).collect(), of }
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            let fields = self.rows.iter().map(|(_, fields)| fields[column].chars().count());
            fields.chain([self.heads[column].chars().count()]).max().unwrap_or_default()
        };
        let widths: Vec<usize> = (0..self.heads.len()).map(width).collect();
        let line = |f: &mut fmt::Formatter<'_>, row: &dyn fmt::Display, fields: &[String]| {
            write!(f, "  {row:>7}")?;
            fields.iter().zip(&widths).try_for_each(|(field, width)| write!(f, "  {field:>width$}"))?;
            writeln!(f)
        };
        line(f, &"row", &self.heads)?;
        self.rows.iter().try_for_each(|(row, fields)| line(f, row, fields))?;
        let [rows, columns] = self.of;
        if self.rows.len() < rows || self.heads.len() < columns {
            writeln!(f, "  {} of {rows} rows, {} of {columns} columns", self.rows.len(), self.heads.len())?;
        }
        Ok(())
    }
}

/// How many numbers each result has; 0 where no row is done.
fn widths_of(plan: &Plan, table: &Table) -> Vec<usize> {
    (0..plan.results.len()).map(|result| table.width(result).unwrap_or_default()).collect()
}

/// The heads of parameters and results.
fn heads_of(plan: &Plan, widths: &[usize]) -> Vec<String> {
    let of_result = |((name, asked), width): ((&String, &Asked), &usize)| -> Vec<String> {
        match (asked, *width) {
            (Asked::Final(_) | Asked::Peak(_), 1) => vec![name.clone()],
            (asked, width) => {
                let column = asked.column().and_then(column_of);
                let names = column.map_or(&[][..], |column| column.components().names());
                let of_component =
                    |k: usize| names.get(k).map_or_else(|| (k + 1).to_string(), |name| (*name).to_owned());
                (0..width).map(|k| format!("{name} {}", of_component(k))).collect()
            }
        }
    };
    let parameters = plan.parameters.iter().map(|(key, _)| key.clone());
    parameters.chain(plan.results.iter().zip(widths).flat_map(of_result)).collect()
}

/// The numbers of all results of a row; none where there is none.
fn numbers<'a>(row: &'a RowState, widths: &'a [usize]) -> impl Iterator<Item = Option<f64>> + 'a {
    widths.iter().enumerate().flat_map(move |(i, width)| {
        let of_row = match row {
            RowState::Done(done) => done.results.get(i),
            RowState::Open | RowState::Failed(_) => None,
        };
        (0..*width).map(move |k| of_row.and_then(|numbers| numbers.get(k)).copied())
    })
}

/// A field of one line.
fn quoted_line(text: &str) -> String {
    quoted(&text.lines().collect::<Vec<_>>().join(" "))
}
