//! A case: a folder with `case.toml`, and the files that its command reads.

use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use report::quantity;
use serde::Deserialize;
use toml::Spanned;

/// The name of the file in the folder of a case.
const FILE: &str = "case.toml";
/// Commands that have a report of numbers, and the file of those that write one; an empty name is a folder of files.
const COMMANDS: [(&str, Option<&str>); 10] = [
    ("run", Some("")),
    ("modes", None),
    ("campbell", Some("")),
    ("linearize", Some("linear.json")),
    ("frf", Some("")),
    ("psd", Some("")),
    ("srs", Some("")),
    ("shock", None),
    ("gradient", None),
    ("fit", None),
];
const CURE: &str = "docs/how-to/verify.md has a case with its keys";

/// A published benchmark.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The name of its folder.
    #[serde(skip)]
    pub name: String,
    #[serde(skip)]
    folder: PathBuf,
    /// Title.
    pub title: String,
    /// Kind of problem.
    pub kind: String,
    /// Where the numbers stand, in full.
    pub source: String,
    /// How the source is understood, and how the scene differs from it.
    #[serde(default)]
    pub note: String,
    /// The command line without the name of the program. Words that name a file of the folder stand for it.
    pub command: String,
    /// True if it takes a few seconds.
    #[serde(default)]
    pub quick: bool,
    /// The comparisons.
    compare: Vec<Spanned<Comparison>>,
}

/// Published values of one quantity, and where the report of the command has it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Comparison {
    quantity: String,
    #[serde(default)]
    unit: String,
    #[serde(default = "Several::none")]
    published: Several<f64>,
    points: Option<PathBuf>,
    relative: Option<f64>,
    absolute: Option<f64>,
    value: Option<Several<String>>,
    column: Option<String>,
    table: Option<String>,
    component: Option<usize>,
    at: Option<Several<f64>>,
    take: Option<Take>,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    offset: f64,
    miss: Option<String>,
    #[serde(skip)]
    line: usize,
}

fn one() -> f64 {
    1.0
}

#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Several<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> Several<T> {
    fn none() -> Self {
        Self::Many(Vec::new())
    }

    fn all(&self) -> &[T] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Many(many) => many,
        }
    }
}

/// A number of a whole column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Take {
    /// The last one.
    Last,
    /// The largest.
    Largest,
    /// The least.
    Least,
    /// The largest magnitude, without its sign.
    Magnitude,
}

/// A published value and its place in the answer.
#[derive(Debug, Clone)]
pub(super) struct Quantity {
    /// Its name, with the place or the number of its value where there are several.
    pub label: String,
    /// Its name alone.
    pub name: String,
    pub unit: String,
    pub published: f64,
    pub tolerance: Tolerance,
    pub place: ValuePlace,
    /// Factor of the value of the report, which brings it into the unit of the source.
    pub factor: f64,
    /// Added after that.
    pub offset: f64,
    /// Reason of a known miss.
    pub miss: Option<String>,
    /// The line of the comparison in the file, from 1.
    pub line: usize,
}

/// The largest difference that passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tolerance {
    /// Relative to the published value.
    Relative(f64),
    /// In its unit.
    Absolute(f64),
}

/// Where a value stands.
#[derive(Debug, Clone)]
pub(super) enum ValuePlace {
    /// A path in the JSON of the report.
    Report(String),
    /// A column of the results file of a run, or of a CSV file of the command, and which of its numbers.
    Column { table: Option<String>, column: String, component: Option<usize>, row: Row },
}

impl ValuePlace {
    /// The value that the first column has in the row, if it is chosen so.
    pub fn row(&self) -> Option<f64> {
        match self {
            Self::Column { row: Row::At(at), .. } => Some(*at),
            _ => None,
        }
    }
}

/// A row of a column.
#[derive(Debug, Clone, Copy)]
pub(super) enum Row {
    /// The one at which the first column, such as the time, has a value.
    At(f64),
    /// Chosen among all.
    Take(Take),
}

/// The names of the cases in a folder, sorted.
pub(super) fn names(folder: &Path) -> Result<Vec<String>, Failure> {
    let help = "name the folder `benchmarks` of flexframe's sources, or one of yours: --cases DIR";
    let entries = std::fs::read_dir(folder)
        .map_err(|error| Kind::Io.of(folder).help(help).says(format!("the folder of cases cannot be read: {error}")))?;
    let folders = entries.filter_map(Result::ok).filter(|entry| entry.path().join(FILE).is_file());
    let mut names: Vec<String> = folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    if names.is_empty() {
        return Err(Kind::Input.of(folder).found("no case").expected(format!("folders with {FILE}")).help(help).into());
    }
    Ok(names)
}

impl Case {
    /// Reads the case of a name in a folder of cases.
    ///
    /// # Errors
    /// A file that cannot be read, or is no case.
    pub fn read(folder: &Path, name: &str) -> Result<Self, Failure> {
        let folder = folder.join(name);
        let path = folder.join(FILE);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| Kind::Io.of(&path).help(CURE).says(format!("the case cannot be read: {error}")))?;
        let mut case: Self = toml::from_str(&text).map_err(|error| {
            let wrong = Kind::Input.of(&path).help(CURE);
            let wrong = error.span().map_or(wrong.clone(), |span| wrong.line(line_of(&text, &span)));
            wrong.says(error.message())
        })?;
        case.name = name.to_owned();
        case.folder = folder;
        let line = |key: &str| text.lines().position(|line| line.starts_with(key)).map_or(1, |line| line + 1);
        if case.output().is_none() {
            let wrong = Kind::Input.of(&path).line(line("command")).key("command").found(&case.command);
            let known: Vec<&str> = COMMANDS.iter().map(|(name, _)| *name).collect();
            return Err(wrong.expected(format!("a command line of {}", known.join(", "))).help(CURE).into());
        }
        for comparison in &mut case.compare {
            let line = line_of(&text, &comparison.span());
            let comparison = comparison.get_mut();
            comparison.line = line;
            comparison.read_points(&case.folder)?;
            comparison.check(&path)?;
        }
        Ok(case)
    }

    /// The file that its command writes, by `--output`; none if it is no command of a case.
    fn output(&self) -> Option<Option<&'static str>> {
        let command = self.command.split_whitespace().next()?;
        COMMANDS.iter().find(|(name, _)| *name == command).map(|(_, file)| *file)
    }

    /// The command line, which writes its files to a folder.
    pub(super) fn words(&self, folder: &Path) -> Vec<OsString> {
        let word = |word: &str| {
            let file = self.folder.join(word);
            if file.is_file() { file.into() } else { word.into() }
        };
        let mut words: Vec<OsString> = self.command.split_whitespace().map(word).collect();
        if let Some(Some(file)) = self.output() {
            words.extend(["--overwrite".into(), "--output".into(), folder.join(file).into()]);
        }
        words
    }

    /// The file of the case.
    pub(super) fn file(&self) -> PathBuf {
        self.folder.join(FILE)
    }

    /// The scene, if the command reads one of the folder.
    pub(super) fn scene(&self) -> Option<PathBuf> {
        let mut words = self.command.split_whitespace();
        words.find(|word| word.ends_with(".toml")).map(|word| self.folder.join(word))
    }

    /// All compared values.
    pub(super) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        self.compare.iter().flat_map(|comparison| comparison.get_ref().quantities())
    }
}

impl Quantity {
    /// A value of the report in the unit of the source.
    pub fn in_its_unit(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

fn line_of(text: &str, span: &Range<usize>) -> usize {
    1 + text.bytes().take(span.start).filter(|byte| *byte == b'\n').count()
}

impl Comparison {
    /// Takes the published values and their places from a table of two columns, such as one that was read from a figure.
    fn read_points(&mut self, folder: &Path) -> Result<(), Failure> {
        let Some(file) = &self.points else { return Ok(()) };
        let wrong = |found: &str, expected: &str| Err(self.wrong(&folder.join(FILE), "points", found, expected));
        if self.at.is_some() || !self.published.all().is_empty() {
            return wrong("`published` or `at`, too", "`points`, a CSV file, in their place");
        }
        let text = match std::fs::read_to_string(folder.join(file)) {
            Ok(text) => text,
            Err(error) => return wrong(&format!("{}: {error}", file.display()), "a CSV file of the folder"),
        };
        let pair = |line: &str| {
            let (at, value) = line.split_once(',')?;
            Some((at.trim().parse::<f64>().ok()?, value.trim().parse::<f64>().ok()?))
        };
        // The first line has names.
        let lines = text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty());
        let (mut at, mut published) = (Vec::new(), Vec::new());
        for (number, line) in lines {
            let Some(pair) = pair(line) else {
                return wrong(
                    &format!("{line:?} in line {} of {}", number + 1, file.display()),
                    "two numbers: at, value",
                );
            };
            at.push(pair.0);
            published.push(pair.1);
        }
        (self.at, self.published) = (Some(Several::Many(at)), Several::Many(published));
        Ok(())
    }

    /// The refusal of one of its keys.
    fn wrong(&self, file: &Path, key: &str, found: &str, expected: &str) -> Failure {
        let wrong = Kind::Input.of(file).line(self.line).key(format!("compare.{key}"));
        wrong.found(found).expected(expected).help(CURE).into()
    }

    /// Refuses keys that do not go together.
    fn check(&self, file: &Path) -> Result<(), Failure> {
        let wrong = |key: &str, found: &str, expected: &str| Err(self.wrong(file, key, found, expected));
        let (count, tolerances) = (self.published.all().len(), [self.relative, self.absolute]);
        let is_tolerance = |tolerance: &f64| *tolerance > 0.0 && tolerance.is_finite();
        if tolerances.iter().flatten().filter(|tolerance| is_tolerance(tolerance)).count() != 1 {
            return wrong("relative", "no tolerance, or two", "`relative` or `absolute`, above 0");
        }
        if self.relative.is_some() && self.published.all().contains(&0.0) {
            return wrong("relative", "a published value of 0", "`absolute`");
        }
        match (&self.value, &self.column) {
            (Some(_), Some(_)) | (None, None) => {
                return wrong("value", "no place, or two", "`value`, a path of the report, or `column`");
            }
            (Some(_), None) if self.at.is_some() || self.take.is_some() || self.table.is_some() => {
                return wrong("value", "`at`, `take` or `table`", "these with `column` alone");
            }
            (None, Some(_)) if self.at.is_some() == self.take.is_some() => {
                return wrong(
                    "column",
                    "no row, or two",
                    "`at`, such as a time, or `take`: last, largest, least, magnitude",
                );
            }
            _ => {}
        }
        let places = match (&self.value, &self.at) {
            (Some(Several::Many(values)), _) => values.len(),
            (_, Some(Several::Many(at))) => at.len(),
            _ if self.value.as_ref().is_some_and(|value| value.all()[0].contains('#')) => count,
            _ => 1,
        };
        if count == 0 || places != count {
            let expected = format!("as many places (`value` with #, or a list; `at`): found {places}");
            return wrong("published", &format!("{count} values"), &expected);
        }
        Ok(())
    }

    /// Its values, each with its own place.
    fn quantities(&self) -> impl Iterator<Item = Quantity> {
        self.published.all().iter().enumerate().map(|(k, published)| {
            let numbered = |path: &String| path.replace('#', &k.to_string());
            let place = match (&self.value, &self.column) {
                (Some(Several::One(path)), _) => ValuePlace::Report(numbered(path)),
                (Some(Several::Many(paths)), _) => ValuePlace::Report(paths[k].clone()),
                (None, column) => ValuePlace::Column {
                    table: self.table.clone(),
                    column: column.clone().unwrap_or_default(),
                    component: self.component,
                    row: match (&self.at, self.take) {
                        (Some(at), _) => Row::At(at.all()[k]),
                        (None, take) => Row::Take(take.unwrap_or(Take::Last)),
                    },
                },
            };
            let label = match (&self.at, self.published.all().len()) {
                (_, 1) => self.quantity.clone(),
                (Some(at), _) => format!("{} at {}", self.quantity, quantity(at.all()[k])),
                (None, _) => format!("{} {}", self.quantity, k + 1),
            };
            let tolerance = match (self.relative, self.absolute) {
                (Some(part), _) => Tolerance::Relative(part),
                (None, apart) => Tolerance::Absolute(apart.unwrap_or_default()),
            };
            Quantity {
                label,
                name: self.quantity.clone(),
                unit: self.unit.clone(),
                published: *published,
                tolerance,
                place,
                factor: self.factor,
                offset: self.offset,
                miss: self.miss.clone(),
                line: self.line,
            }
        })
    }
}
