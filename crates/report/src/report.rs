//! Everything that a command found, as data. Text, JSON, CSV, charts and pages are made of it in one way each.

use std::fmt;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::ChartStack;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value as Json};
use whole_file::write_whole;

use crate::Fact;
use crate::curves::{Curves, PageWords};
use crate::error::not_written;
use crate::table::Table;
use crate::value::{Value, at_path};

/// Width of the labels of lines.
const LABELS: usize = 9;

/// The report of a command.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Title of the scene; none of a command without a scene.
    pub title: Option<String>,
    /// Curves over the frequency, of which a figure and a page are made.
    pub curves: Option<Curves>,
    /// Charts that are not of [`Self::curves`], by the name of their files.
    pub charts: Vec<(&'static str, ChartStack)>,
    /// Tables that are CSV files, and not in text and JSON.
    pub csv_tables: Vec<Table>,
    /// Reservations.
    pub warnings: Vec<String>,
    /// Files that were written.
    pub files: Vec<PathBuf>,
    entries: Vec<Entry>,
}

/// A part of a report, in the order of its text.
#[derive(Debug, Clone)]
enum Entry {
    /// A value, by its path in JSON. Text does not have it.
    Value(String, Value),
    /// A line of text with its label. JSON does not have it.
    Line(String, String),
    /// Lines of text as they stand.
    Words(String),
    /// A table, in both.
    Table(Table),
    /// Reports with the names of their bodies, or without, by their path in JSON.
    List(&'static str, Vec<(Option<String>, Report)>),
}

/// A file that a command writes of its report, by its name without its ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum File {
    /// A table, as CSV.
    Table(&'static str),
    /// A chart, as SVG, PDF and PNG. Where there is nothing to draw, it is not written.
    Chart(&'static str),
    /// The page of the curves, as HTML.
    Page(&'static str),
}

impl File {
    /// The paths of some files in a folder.
    pub fn paths(files: &[Self], folder: &Path) -> Vec<PathBuf> {
        let paths = |file: &Self| match file {
            Self::Table(name) => vec![text_file(folder, name, "csv")],
            Self::Page(name) => vec![text_file(folder, name, "html")],
            Self::Chart(name) => figures::files(&folder.join(name)).to_vec(),
        };
        files.iter().flat_map(paths).collect()
    }
}

fn text_file(folder: &Path, name: &str, ending: &str) -> PathBuf {
    folder.join(format!("{name}.{ending}"))
}

impl Report {
    /// An empty report of a scene.
    pub fn new(title: &str) -> Self {
        Self { title: Some(title.to_owned()), ..Self::default() }
    }

    /// The reports of the bodies of a scene, in its order. As JSON it is the report of a single body, and otherwise an object with
    /// the list `bodies`, each with its `name`.
    pub fn of_bodies(mut bodies: Vec<(Option<String>, Self)>) -> Self {
        match (bodies.len(), bodies.pop()) {
            (1, Some((_, report))) => report,
            (_, last) => {
                bodies.extend(last);
                let mut report = Self::default();
                report.list("bodies", bodies);
                report
            }
        }
    }

    /// Adds a value to the JSON, by its path: `mesh.nodes` is a key of the object `mesh`.
    pub fn put(&mut self, path: impl Into<String>, value: impl Into<Value>) {
        self.entries.push(Entry::Value(path.into(), value.into()));
    }

    /// Adds a line to the text. A line without a label goes on with the line before it.
    pub fn line(&mut self, label: &str, text: impl Into<String>) {
        self.entries.push(Entry::Line(label.to_owned(), text.into()));
    }

    /// Adds a text to both: a line with a label, and a value by its path.
    pub fn say(&mut self, label: &str, path: &str, text: impl Into<String>) {
        let text = text.into();
        self.put(path, &*text);
        self.line(label, text);
    }

    /// Adds lines to the text as they stand.
    pub fn words(&mut self, text: impl Into<String>) {
        self.entries.push(Entry::Words(text.into()));
    }

    /// Adds a table to text and JSON.
    pub fn table(&mut self, table: Table) {
        self.entries.push(Entry::Table(table));
    }

    /// Adds reports, with the names of bodies where they are of bodies; in JSON they are a list.
    pub fn list(&mut self, path: &'static str, reports: Vec<(Option<String>, Self)>) {
        self.entries.push(Entry::List(path, reports));
    }

    /// The value at a path, such as `peaks[0].magnitude`, of the JSON.
    pub fn value(&self, path: &str) -> Option<Json> {
        at_path(&self.json(), path).ok().cloned()
    }

    /// The number at a path.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.value(path)?.as_f64()
    }

    /// The tree of all values: what `--json` prints.
    pub fn json(&self) -> Json {
        let mut object = Map::new();
        self.title.iter().for_each(|title| put(&mut object, "title", title.as_str().into()));
        for entry in &self.entries {
            match entry {
                Entry::Value(path, value) => put(&mut object, path, value.json()),
                Entry::Table(table) => {
                    if let Some(path) = table.path {
                        put(&mut object, path, table.json());
                    }
                }
                Entry::List(path, reports) => {
                    let json = |(name, report): &(Option<String>, Self)| {
                        let mut object = Map::new();
                        name.iter().for_each(|name| put(&mut object, "name", name.as_str().into()));
                        let Json::Object(of_report) = report.json() else { return Json::Null };
                        object.extend(of_report);
                        Json::Object(object)
                    };
                    put(&mut object, path, reports.iter().map(json).collect());
                }
                Entry::Line(..) | Entry::Words(_) => {}
            }
        }
        if !self.files.is_empty() {
            let files: Vec<Json> = self.files.iter().map(|file| file.display().to_string().into()).collect();
            put(&mut object, "files", files.into());
        }
        // A list of rows may have warnings by their numbers.
        if !object.contains_key("warnings") {
            put(&mut object, "warnings", self.warnings.clone().into());
        }
        Json::Object(object)
    }

    /// The lines of the text, as a page shows them.
    fn facts(&self) -> Vec<Fact> {
        let fact = |entry: &Entry| match entry {
            Entry::Line(label, text) if !label.is_empty() => {
                let (first, rest) = label.split_at(label.chars().next().map_or(0, char::len_utf8));
                Some(Fact::new(&format!("{}{rest}", first.to_uppercase()), text.clone()))
            }
            _ => None,
        };
        self.entries.iter().filter_map(fact).collect()
    }

    /// All tables with a name, first those that text and JSON have.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        let of_text = self.entries.iter().filter_map(|entry| match entry {
            Entry::Table(table) => Some(table),
            _ => None,
        });
        of_text.chain(&self.csv_tables).filter(|table| !table.name.is_empty())
    }

    /// The table with a name; one that is a file alone goes before one of the text.
    pub fn table_named(&self, name: &str) -> Option<&Table> {
        self.csv_tables.iter().chain(self.tables()).find(|table| table.name == name)
    }

    /// The figure with the name of its files; none where there is nothing to draw.
    pub fn figure(&self, name: &str) -> Option<ChartStack> {
        let own = self.charts.iter().find(|(of, _)| *of == name).map(|(_, figure)| figure.clone());
        let of_curves = || self.curves.as_ref().map(|curves| curves.figure(self.title.as_deref().unwrap_or_default()));
        own.or_else(of_curves).filter(|figure| !figure.charts.is_empty())
    }

    /// Writes files to a folder, each whole or not at all, and notes their paths. The folder is made if it does not exist.
    ///
    /// # Errors
    /// Errors of the system; curves and charts with numbers that are not finite.
    pub fn write(&mut self, files: &[File], folder: &Path, program: &str) -> Result<(), Failure> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |error| not_written(&path, &error)
        };
        if !files.is_empty() {
            std::fs::create_dir_all(folder).map_err(failed(folder))?;
        }
        for file in files {
            match (file, &self.curves) {
                (File::Table(name), _) => {
                    let Some(table) = self.table_named(name) else { continue };
                    let path = text_file(folder, name, "csv");
                    write_whole(&path, table.csv()).map_err(failed(&path))?;
                    self.files.push(path);
                }
                (File::Page(name), Some(curves)) => {
                    let title = self.title.as_deref().unwrap_or_default();
                    let words = PageWords { title, program, facts: self.facts(), warnings: &self.warnings };
                    let path = text_file(folder, name, "html");
                    curves.write(words, &path)?;
                    self.files.push(path);
                }
                (File::Chart(name), _) => {
                    let Some(figure) = self.figure(name) else { continue };
                    self.files.extend(figure.save(folder.join(name))?);
                }
                (File::Page(_), None) => {}
            }
        }
        Ok(())
    }
}

/// Puts a value at a path of an object; null there gives way.
fn put(object: &mut Map<String, Json>, path: &str, value: Json) {
    match path.split_once('.') {
        None => {
            object.insert(path.to_owned(), value);
        }
        Some((first, rest)) => {
            let inner = object.entry(first).or_insert(Json::Null);
            if inner.is_null() {
                *inner = Json::Object(Map::new());
            }
            if let Json::Object(inner) = inner {
                put(inner, rest, value);
            }
        }
    }
}

impl Serialize for Report {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.json().serialize(serializer)
    }
}

/// The text: the title, lines, tables, files and warnings.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines: Vec<String> = self.title.iter().cloned().collect();
        let line = |label: &str, text: &str| format!("  {label:<LABELS$}{text}");
        for entry in &self.entries {
            match entry {
                Entry::Line(label, text) => lines.push(line(label, text)),
                Entry::Words(text) => lines.push(text.clone()),
                Entry::Table(table) => lines.extend(table.text()),
                Entry::List(_, reports) => {
                    for (name, report) in reports {
                        if !lines.is_empty() {
                            lines.push(String::new());
                        }
                        lines.extend(name.iter().map(|name| format!("body {name}")));
                        lines.push(report.to_string());
                    }
                }
                Entry::Value(..) => {}
            }
        }
        lines.extend(self.files.iter().map(|file| line("wrote", &file.display().to_string())));
        lines.extend(self.warnings.iter().map(|warning| line("warning", warning)));
        f.write_str(&lines.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Chart, Curve, Form};
    use serde_json::json;

    fn report() -> Report {
        let mut report = Report::new("Bar");
        report.put("mesh", Value::NONE);
        report.put("mesh.nodes", 12_usize);
        report.put("mesh.mass", f64::INFINITY);
        report.say("about", "about", "rest");
        report.table(
            Table::new("peaks", "peaks")
                .titled("highest responses")
                .shown("output", "output", Form::Plain, ["tip, left", "root"])
                .shown("magnitude", "magnitude", Form::Power(2), [Some(1234.5), None])
                .text_only("growth", Form::Fixed(2), [-1e-4, -1.0])
                .column("rigid", [true, false]),
        );
        report.warnings.push("it grows".to_owned());
        report
    }

    #[test]
    fn values_are_a_tree_in_their_order() {
        let json = report().json();
        let expected = json!({
            "title": "Bar", "mesh": { "nodes": 12, "mass": "infinite" }, "about": "rest",
            "peaks": [
                { "output": "tip, left", "magnitude": 1234.5, "rigid": true },
                { "output": "root", "magnitude": null, "rigid": false },
            ],
            "warnings": ["it grows"],
        });
        assert_eq!(json, expected);
        assert_eq!(report().number("peaks[0].magnitude"), Some(1234.5));
        assert_eq!(report().value("peaks[2].magnitude"), None);
        let text = serde_json::to_string(&json).unwrap();
        assert!(text.find("mesh") < text.find("about") && text.find("about") < text.find("peaks"));
    }

    #[test]
    fn text_is_lines_and_aligned_tables() {
        let expected = "Bar\n  about    rest\n  highest responses\n  output     magnitude  growth\n  tip, left     1.23e3    0.00\n  root               -   \
                        -1.00\n  \
                        warning  it grows";
        assert_eq!(report().to_string(), expected);
    }

    #[test]
    fn files_are_made_of_tables_and_curves() {
        let folder = tempfile::tempdir().unwrap();
        let mut report = report();
        let curve =
            Curve { name: "tip".to_owned(), units: vec!["mm".to_owned()], values: vec![vec![0.0, 2.0]], about: vec![] };
        report.curves = Some(Curves {
            subject: "response",
            frequency_unit: "Hz".to_owned(),
            logarithmic: false,
            frequencies: vec![0.0, 1.0],
            resonances: Vec::new(),
            charts: vec![Chart::new("Magnitude", true)],
            headings: Vec::new(),
            curves: vec![curve],
        });
        let files = [File::Table("peaks"), File::Page("bar"), File::Chart("bar")];
        report.write(&files, folder.path(), "flexframe").unwrap();
        assert_eq!(report.files, File::paths(&files, folder.path()));
        assert!(report.files.iter().all(|file| file.is_file()));
        let csv = std::fs::read_to_string(&report.files[0]).unwrap();
        assert_eq!(csv, "output,magnitude,rigid\n\"tip, left\",1.2345e3,true\nroot,,false\n");
    }

    #[test]
    fn several_bodies_are_a_list_and_one_is_itself() {
        let one = Report::of_bodies(vec![(Some("arm".to_owned()), report())]);
        assert_eq!(one.json(), report().json());
        let two = Report::of_bodies(["arm", "leg"].map(|name| (Some(name.to_owned()), report())).to_vec());
        assert_eq!(two.value("bodies[1].name"), Some("leg".into()));
        assert_eq!(two.number("bodies[1].mesh.nodes"), Some(12.0));
        assert!(two.to_string().contains("body leg\nBar\n"));
    }
}
