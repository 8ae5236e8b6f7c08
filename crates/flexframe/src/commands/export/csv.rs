//! Columns of a results file as one table of text.

use std::io::Write;
use std::path::Path;

use diagnostic::{Failure, Kind};
use report::quoted;
use results::kind::NATURAL_MODE;
use results::{Components, History, Metadata, Results, SystemRow, histories};
use whole_file::WholeFile;

use super::Exported;
use super::rows::ExportRows;
use crate::files::outputs::{OutputError, Written, outputs_of_results};
use crate::files::write_error::WriteError;
use crate::rows::columns::COLUMNS;

/// A history in the table, and the heads of its values.
struct Part {
    path: String,
    heads: Vec<String>,
}

/// Writes the rows of a results file, finished or not, as a table: a row of heads, such as `position x [mm]`, and then a
/// row for each row. `columns` are paths of the columns, or what some begin with, such as `energy` or `points/P1`, of several
/// bodies `bodies/ring/energy`; all if there are none. The time comes first in any case. To a folder it goes under the name of the results file.
///
/// The table of an unfinished run begins with a line that says so, after a `#`.
///
/// # Errors
/// [`Failure`].
pub fn export_csv(file: &Path, to: &Path, columns: &[String], rows: &ExportRows) -> Result<Exported, Failure> {
    let table = Table::new(file, columns, rows)?;
    let (path, folder) = match to.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("csv") => (to.to_owned(), None),
        _ => {
            Written::FOLDER.check(to).map_err(OutputError::from)?;
            (to.join(Path::new(file.file_name().unwrap_or("results".as_ref())).with_extension("csv")), Some(to))
        }
    };
    let outputs = outputs_of_results(file, rows.overwrite);
    match folder {
        Some(folder) => {
            outputs.claim(&[&path])?;
            std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
        }
        None => outputs.claim_as(&Written::TABLE, &path)?,
    }
    let write = || {
        let mut out = WholeFile::create(&path)?;
        table.write(&mut out)?;
        out.finish()
    };
    write().map_err(WriteError::of(&path))?;
    Ok(Exported { files: vec![path], warning: table.warning })
}

/// The same table as a text, and what should be known of it.
///
/// # Errors
/// [`Failure`].
pub fn csv_text(file: &Path, columns: &[String], rows: &ExportRows) -> Result<(String, Option<String>), Failure> {
    let table = Table::new(file, columns, rows)?;
    let mut text = Vec::new();
    table.write(&mut text).map_err(WriteError::of(file))?;
    Ok((String::from_utf8_lossy(&text).into_owned(), table.warning))
}

/// The columns and rows that were chosen of a results file.
struct Table {
    results: Results,
    parts: Vec<Part>,
    rows: Vec<usize>,
    /// Warning that the run is unfinished.
    warning: Option<String>,
}

impl Table {
    fn new(file: &Path, columns: &[String], rows: &ExportRows) -> Result<Self, Failure> {
        let results = Results::open(file, &COLUMNS)?;
        let parts = chosen(file, &results, columns)?;
        let rows = rows.of(file, &results)?;
        let warning = ExportRows::warning(&results);
        Ok(Self { results, parts, rows, warning })
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        if let Some(warning) = &self.warning {
            writeln!(out, "# {warning}")?;
        }
        let heads = self.parts.iter().flat_map(|part| &part.heads).map(|head| quoted(head));
        writeln!(out, "{}", heads.collect::<Vec<_>>().join(","))?;
        let tables: Vec<_> = self.parts.iter().filter_map(|part| self.results.table(&part.path)).collect();
        for row in &self.rows {
            let values = tables.iter().filter_map(|table| table.row(*row)).flatten();
            for (i, value) in values.enumerate() {
                // The shortest text that is read back as the same number.
                write!(out, "{}{value:?}", if i == 0 { "" } else { "," })?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

fn chosen(file: &Path, results: &Results, columns: &[String]) -> Result<Vec<Part>, Failure> {
    let metadata = &results.metadata;
    let time = Part { path: "time".to_owned(), heads: vec![format!("time [{}]", metadata.units.time)] };
    let all: Vec<Part> = histories(&COLUMNS, metadata).flat_map(|history| parts(history, metadata)).collect();
    let is_of = |part: &Part, asked: &str| {
        let rest = part.path.strip_prefix(asked.trim_end_matches('/'));
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    };
    let is_known = |asked: &String| std::iter::once(&time).chain(&all).any(|part| is_of(part, asked));
    if let Some(found) = columns.iter().find(|asked| !is_known(asked)) {
        let columns: Vec<String> = std::iter::once(time).chain(all).map(|part| part.path).collect();
        let help = format!("name some of these, or beginnings of their paths: {}", columns.join(", "));
        let wrong = Kind::Usage.of(file).found(found).help(help);
        return Err(wrong.says(format!("there is no column \"{found}\"")));
    }
    let is_chosen = |part: &Part| columns.is_empty() || columns.iter().any(|asked| is_of(part, asked));
    Ok(std::iter::once(time).chain(all.into_iter().filter(is_chosen)).collect())
}

/// The parts of a history: itself, or one for each point.
fn parts<R: SystemRow>(history: History<R>, metadata: &Metadata) -> Vec<Part> {
    let column = history.column;
    let unit = column.unit(&metadata.units);
    let names: Vec<String> = match (column.components(), history.body(metadata)) {
        (Components::Number, _) => vec![String::new()],
        (Components::Modes, Some(body)) => (body.model.kinds().enumerate())
            .map(|(k, kind)| if kind == NATURAL_MODE { format!("{}", k + 1) } else { format!("{} {kind}", k + 1) })
            .collect(),
        (components, _) => components.names().iter().map(|name| (*name).to_owned()).collect(),
    };
    let part = |place: Option<&str>| {
        let path = history.short_path_of(metadata, place);
        let head = |name: &String| {
            if name.is_empty() { format!("{path} [{unit}]") } else { format!("{path} {name} [{unit}]") }
        };
        Part { heads: names.iter().map(head).collect(), path }
    };
    match history.is_of_places() {
        true => history.places(metadata).iter().map(|name| part(Some(name))).collect(),
        false => vec![part(None)],
    }
}
