//! Tables of a report: as text, as JSON and as CSV.

use serde_json::{Map, Value as Json};

use crate::value::Value;

/// Rows in the text at the most.
const ROWS: usize = 30;

/// A table: columns of equal length.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Its name, by which it becomes a file.
    pub name: &'static str,
    /// Path of its list of rows in JSON; none where JSON has the columns in another form, or not.
    pub path: Option<&'static str>,
    /// The line above it in the text; may be empty.
    pub title: String,
    /// The line in its place where it has no rows; may be empty.
    pub empty: &'static str,
    /// Rows in the text at the most; 0 leaves the choice.
    pub most: usize,
    /// True where the rows of the text are spread over all; otherwise they are the first.
    pub spread: bool,
    columns: Vec<Column>,
}

#[derive(Debug, Clone)]
struct Column {
    /// Name in JSON and CSV; empty in neither.
    key: String,
    /// Heading in the text; none where the text does not have it.
    heading: Option<String>,
    form: Form,
    values: Vec<Value>,
}

/// The form of the numbers of a column in text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Seven digits, with a power of ten where it is very large or small; whole numbers and words as they are.
    #[default]
    Plain,
    /// With a number of decimals.
    Fixed(usize),
    /// With a number of decimals and a power of ten.
    Power(usize),
}

impl Table {
    /// A table without columns, whose rows are a list at a path of JSON.
    pub fn new(name: &'static str, path: impl Into<Option<&'static str>>) -> Self {
        Self { name, path: path.into(), ..Self::default() }
    }

    /// With a line above it.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// With all its rows in the text.
    #[must_use]
    pub fn all(self) -> Self {
        self.most(usize::MAX)
    }

    /// With at most this number of rows in the text.
    #[must_use]
    pub fn most(self, most: usize) -> Self {
        Self { most, ..self }
    }

    /// With rows in the text that are spread over all, the first and the last among them.
    #[must_use]
    pub fn spread(self) -> Self {
        Self { spread: true, ..self }
    }

    /// With a line in its place where it has no rows.
    #[must_use]
    pub fn without_rows(self, empty: &'static str) -> Self {
        Self { empty, ..self }
    }

    /// With a column of JSON and CSV.
    #[must_use]
    pub fn column<V: Into<Value>>(self, key: impl Into<String>, values: impl IntoIterator<Item = V>) -> Self {
        self.with(key.into(), None, Form::Plain, values)
    }

    /// With a column of all three.
    #[must_use]
    pub fn shown<V: Into<Value>>(
        self,
        key: impl Into<String>,
        heading: impl Into<String>,
        form: Form,
        values: impl IntoIterator<Item = V>,
    ) -> Self {
        self.with(key.into(), Some(heading.into()), form, values)
    }

    /// With a column of the text alone.
    #[must_use]
    pub fn text_only<V: Into<Value>>(
        self,
        heading: impl Into<String>,
        form: Form,
        values: impl IntoIterator<Item = V>,
    ) -> Self {
        self.with(String::new(), Some(heading.into()), form, values)
    }

    fn with<V: Into<Value>>(
        mut self,
        key: String,
        heading: Option<String>,
        form: Form,
        values: impl IntoIterator<Item = V>,
    ) -> Self {
        self.columns.push(Column { key, heading, form, values: values.into_iter().map(Into::into).collect() });
        self
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    fn named(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|column| !column.key.is_empty())
    }

    /// The columns of JSON and CSV: names and values.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &[Value])> {
        self.named().map(|column| (&column.key[..], &column.values[..]))
    }

    /// A list of objects, a row each.
    pub fn json(&self) -> Json {
        let row = |i: usize| -> Json {
            let entries = self.named().map(|column| (column.key.clone(), column.values[i].json()));
            Json::Object(entries.collect::<Map<_, _>>())
        };
        (0..self.rows()).map(row).collect()
    }

    /// A line of names, then a line a row. Numbers have all their digits.
    pub fn csv(&self) -> String {
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let mut csv = line(self.named().map(|column| quoted(&column.key)).collect());
        for i in 0..self.rows() {
            csv += &line(self.named().map(|column| quoted(&plain(&column.values[i]))).collect());
        }
        csv
    }

    /// The lines of the text.
    pub(crate) fn text(&self) -> Vec<String> {
        let shown: Vec<&Column> = self.columns.iter().filter(|column| column.heading.is_some()).collect();
        if self.rows() == 0 || shown.is_empty() {
            return if self.empty.is_empty() { Vec::new() } else { vec![format!("  {}", self.empty)] };
        }
        let most = if self.most == 0 { ROWS } else { self.most };
        let stride = if self.spread { (self.rows() - 1).div_ceil(most - 1).max(1) } else { 1 };
        let last = self.rows() - 1;
        let rows = (0..=last).filter(|i| if self.spread { i % stride == 0 || *i == last } else { *i < most });
        let rows: Vec<usize> = rows.collect();
        let of_column = |column: &&Column| {
            let is_words = |value: &Value| matches!(value, Value::Json(Json::String(text)) if !begins_as_number(text));
            let is_words = column.values.iter().any(is_words);
            let heading = column.heading.clone().unwrap_or_default();
            let cells: Vec<String> = rows.iter().map(|row| column.form.text(&column.values[*row])).collect();
            let width = cells.iter().chain([&heading]).map(|cell| cell.chars().count()).max().unwrap_or(0);
            let padded = |cell: &String| if is_words { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
            [heading].iter().chain(&cells).map(padded).collect::<Vec<String>>()
        };
        let columns: Vec<Vec<String>> = shown.iter().map(of_column).collect();
        let mut lines: Vec<String> = Vec::new();
        if !self.title.is_empty() {
            lines.push(format!("  {}", self.title));
        }
        for i in 0..=rows.len() {
            let cells: Vec<&str> = columns.iter().map(|column| column[i].as_str()).collect();
            lines.push(format!("  {}", cells.join("  ").trim_end()));
        }
        // No column has a heading: there is no line of them.
        if shown.iter().all(|column| column.heading.as_deref() == Some("")) {
            lines.remove(usize::from(!self.title.is_empty()));
        }
        if rows.len() < self.rows() {
            let rest = if self.path.is_some() { "; --json has them all" } else { "" };
            lines.push(format!("  {} of {} rows{rest}", rows.len(), self.rows()));
        }
        lines
    }
}

impl Form {
    fn text(self, value: &Value) -> String {
        match (self, value) {
            (Self::Fixed(decimals), Value::Number(value)) => {
                let text = format!("{value:.decimals$}");
                // Rounding has no sign.
                let is_zero = text.bytes().all(|digit| b"-0.".contains(&digit));
                if is_zero { text.replace('-', "") } else { text }
            }
            // Zero has no sign.
            (Self::Power(decimals), Value::Number(value)) => format!("{:.decimals$e}", value + 0.0),
            (Self::Plain, Value::Number(value)) => quantity(*value),
            (_, Value::Json(Json::Null)) => "-".to_owned(),
            _ => plain(value),
        }
    }
}

fn begins_as_number(text: &str) -> bool {
    text.starts_with(|letter: char| letter.is_ascii_digit() || matches!(letter, '-' | '+'))
}

/// A value as a field of CSV.
fn plain(value: &Value) -> String {
    match value {
        Value::Number(value) if value.is_finite() => format!("{value:e}"),
        Value::Number(value) => format!("{value}"),
        Value::Json(Json::Null) => String::new(),
        Value::Json(Json::String(text)) => text.clone(),
        other => other.json().to_string(),
    }
}

/// A field of CSV, in quotes where it has to be.
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// A quantity for people to read: seven digits, with a power of ten where it is very large or small.
pub fn quantity(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e7).contains(&magnitude) {
        return format!("{value:.6e}");
    }
    let decimals = (6 - magnitude.log10().floor() as i32).max(0) as usize;
    let fixed = format!("{value:.decimals$}");
    if fixed.contains('.') { fixed.trim_end_matches('0').trim_end_matches('.').to_owned() } else { fixed }
}
