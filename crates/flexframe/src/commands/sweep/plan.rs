//! Plan of a sweep: a scene, its parameters, and the results of each run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Failure, Kind};
use foreign_program::read_at_most;
use keys::Hash;
use scene::{AssignError, Body, Scene, SceneError, assign, text_of};
use serde::Deserialize;
use toml::{Table, Value};

use crate::files::identity::{contents, identity_of_row};

/// More rows than these are a mistake.
const MAX_ROWS: usize = 1_000_000;
/// The largest file of a sweep, in bytes: as many as the tables of a scene.
const LONGEST: u64 = 16 << 20;

/// The file of a sweep.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    scene: PathBuf,
    #[serde(default)]
    combine: Combine,
    parameters: Table,
    results: BTreeMap<String, Asked>,
}

/// How the lists of the parameters are combined.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Combine {
    /// Every value of one with every value of the others; the last parameter changes first.
    #[default]
    Grid,
    /// The first values of all, then the second ones, and so on.
    Zip,
}

/// A result of a run.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Asked {
    /// The last row of a column of the results, such as `points/tip/displacement`.
    Final(String),
    /// The value of largest size over the rows, with its sign, of each number of a column.
    Peak(String),
    /// The natural frequencies of the body, cycles per time, as `flexframe modes` has them. They take no run.
    Frequencies,
    /// The same of the body of this name.
    FrequenciesOf(String),
}

impl Asked {
    /// The column of a run.
    pub fn column(&self) -> Option<&str> {
        match self {
            Self::Final(column) | Self::Peak(column) => Some(column),
            Self::Frequencies | Self::FrequenciesOf(_) => None,
        }
    }
}

/// A range of numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    from: f64,
    to: f64,
    count: usize,
}

const SCENE_CURE: &str = "correct `scene` in the file of the sweep; its path is relative to the folder of that file";

/// A sweep, ready to be run.
pub(super) struct Plan {
    pub title: String,
    /// The text of its file and that of the scene: what the table belongs to.
    pub identity: String,
    /// Keys of the scene, in alphabetical order, and their values in each row.
    pub parameters: Vec<(String, Vec<Value>)>,
    pub results: BTreeMap<String, Asked>,
    /// The scenes of the bodies in each row, or why there are none.
    pub rows: Vec<Result<Scene, String>>,
    /// Hash for each row: of its scene and of the bytes of all files that are read for it.
    pub identities: Vec<u64>,
}

/// A sweep of which no row is a scene.
#[derive(Debug, thiserror::Error)]
#[error("{source}\n  = with {with} (no row of the sweep is a scene that can be read)")]
struct NoRow {
    with: String,
    source: SceneError,
}

impl Diagnostic for NoRow {
    fn diagnosis(&self) -> Diagnosis {
        self.source.diagnosis()
    }
}

/// Help about the file of a sweep.
const SWEEP_CURE: &str = "correct it: docs/reference/cli.md, \"Sweeps\", has an example with all its keys";

impl Plan {
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = read_at_most(path, LONGEST).map_err(|error| {
            let help = "check its name; it is relative to the folder you are in";
            Kind::Io.of(path).help(help).says(format!("the file of the sweep cannot be read: {error}"))
        })?;
        let of_form = |words: String| Kind::Input.of(path).help(SWEEP_CURE).says(words);
        let of_sweep = String::from_utf8(bytes).map_err(|error| {
            of_form(format!("this is not text in UTF-8 (byte {})", error.utf8_error().valid_up_to() + 1))
        })?;
        let form = |error: toml::de::Error| of_form(error.to_string());
        let file: File = toml::from_str(&of_sweep).map_err(form)?;
        let scene_path = path.parent().unwrap_or(Path::new("")).join(&file.scene);
        let of_scene = |error: SceneError| match error {
            SceneError::Unreadable { path, cause, .. } => SceneError::Unreadable { path, cause, help: SCENE_CURE },
            other => other,
        };
        let unreadable = |error| Failure::from(of_scene(error).without_text());
        let of_all = text_of(&scene_path).map_err(unreadable)?;
        let scene = Scene::parse(&of_all, &scene_path).map_err(unreadable)?;

        let invalid = |key: &str, found: String, expected: &str| {
            let words = format!("`{key}`: found {found}, expected {expected}");
            Kind::Input.of(path).key(key).found(found).expected(expected).help(SWEEP_CURE).says(words)
        };
        if file.results.is_empty() {
            return Err(invalid(
                "results",
                "nothing".into(),
                "what to keep of each row, such as tip = { final = \"position\" } or f = \"frequencies\"",
            ));
        }
        // They become heads of a table, which spreadsheets read.
        let is_head = |name: &str| !name.starts_with(['=', '+', '-', '@']) && !name.contains(char::is_control);
        if let Some(name) = file.results.keys().find(|name| !is_head(name)) {
            let expected = "names of results on one line that do not begin with =, +, - or @";
            return Err(invalid("results", format!("{name:?}"), expected));
        }
        let lists: Vec<(String, Vec<Value>)> = file
            .parameters
            .into_iter()
            .map(|(key, value)| {
                let values = values(value)
                    .map_err(|(found, expected)| invalid(&format!("parameters.\"{key}\""), found, expected))?;
                Ok((key, values))
            })
            .collect::<Result<_, Failure>>()?;
        if lists.is_empty() {
            return Err(invalid("parameters", "nothing".into(), "keys of the scene with lists or ranges of values"));
        }
        let parameters = match file.combine {
            Combine::Zip => {
                let length = lists[0].1.len();
                if let Some((key, values)) = lists.iter().find(|(_, values)| values.len() != length) {
                    let expected = format!("{length} values, as many as the first list has, for combine = \"zip\"");
                    return Err(invalid(
                        &format!("parameters.\"{key}\""),
                        format!("{} values", values.len()),
                        &expected,
                    ));
                }
                lists
            }
            Combine::Grid => grid(&lists)
                .ok_or_else(|| invalid("parameters", format!("a grid of more than {MAX_ROWS} rows"), "fewer values"))?,
        };
        let count = parameters[0].1.len();
        let mut rows = Vec::with_capacity(count);
        let mut first_refusal = None;
        for row in 0..count {
            let values: Vec<_> = parameters.iter().map(|(key, values)| (key.clone(), values[row].clone())).collect();
            let text = assign(&of_all, &values).map_err(|AssignError { key, found, expected }| {
                invalid(&format!("parameters.\"{key}\""), found, &expected)
            })?;
            rows.push(match Scene::parse(&text, &scene_path) {
                Ok(scene) => Ok(scene),
                Err(refusal) => {
                    let words = refusal.to_string();
                    first_refusal.get_or_insert((row, refusal));
                    Err(words)
                }
            });
        }
        if rows.iter().all(Result::is_err)
            && let Some((row, source)) = first_refusal
        {
            let source: SceneError = source;
            let with = in_words(&parameters, row);
            return Err(NoRow { with, source }.into());
        }
        check_bodies(&scene, &file.results).map_err(|(key, found, expected)| invalid(&key, found, &expected))?;
        let identity = format!("{of_sweep}\n{of_all}");
        let identities = identities(&rows);
        Ok(Self { title: scene.title.clone(), identity, parameters, results: file.results, rows, identities })
    }

    /// True if something is asked of a run, and if the frequencies are asked for.
    pub fn asks(&self) -> [bool; 2] {
        let is_asked = |run: bool| self.results.values().any(|asked| asked.column().is_some() == run);
        [is_asked(true), is_asked(false)]
    }

    /// True if the frequencies of the body of a scene are asked for.
    pub fn asks_frequencies_of(&self, given: &Body) -> bool {
        self.results.values().any(|asked| match asked {
            Asked::Frequencies => given.name.is_none(),
            Asked::FrequenciesOf(body) => given.name.as_ref() == Some(body),
            Asked::Final(_) | Asked::Peak(_) => false,
        })
    }

    /// True if the files of the bodies of a row have changed since the sweep was read.
    pub fn has_changed(&self, row: usize) -> bool {
        self.rows[row]
            .as_ref()
            .is_ok_and(|system| identity_of_row(system, |body| contents(&body.source)) != self.identities[row])
    }
}

/// Refuses results of a body that the scene does not have: the key, what was found, and what was expected.
fn check_bodies(scene: &Scene, results: &BTreeMap<String, Asked>) -> Result<(), (String, String, String)> {
    let names: Vec<&str> = scene.bodies.iter().filter_map(|given| given.name.as_deref()).collect();
    for (name, asked) in results {
        let (found, expected) = match asked {
            Asked::Frequencies if !names.is_empty() => (
                "frequencies of no body".to_owned(),
                format!("{{ frequencies-of = \"NAME\" }} of one of {}", names.join(", ")),
            ),
            Asked::FrequenciesOf(body) if !names.contains(&body.as_str()) => match names.is_empty() {
                true => (format!("the body `{body}`"), "\"frequencies\", since a single body has no name".to_owned()),
                false => (format!("the body `{body}`"), format!("one of {}", names.join(", "))),
            },
            _ => continue,
        };
        return Err((format!("results.{name}"), found, expected));
    }
    Ok(())
}

/// Hash for each row.
fn identities(rows: &[Result<Scene, String>]) -> Vec<u64> {
    // The files of each body are read once.
    let mut bodies: BTreeMap<Vec<PathBuf>, Hash> = BTreeMap::new();
    let mut contents_of = |body: &Body| {
        let files = body.source.files().into_iter().map(Path::to_owned).collect();
        *bodies.entry(files).or_insert_with(|| contents(&body.source))
    };
    let of_row = |row: &Result<Scene, String>| row.as_ref().map_or(0, |scene| identity_of_row(scene, &mut contents_of));
    rows.iter().map(of_row).collect()
}

/// The values of the parameters in a row.
pub(super) fn in_words(parameters: &[(String, Vec<Value>)], row: usize) -> String {
    let each = parameters.iter().map(|(key, values)| format!("{key} = {}", values[row]));
    each.collect::<Vec<_>>().join(", ")
}

/// The values of a list or a range.
fn values(value: Value) -> Result<Vec<Value>, (String, &'static str)> {
    const EXPECTED: &str = "a list such as [1, 2, 5] or a range such as { from = 0, to = 100, count = 21 }; a key with dots is \
                            written in quotes, \"initial.angular_velocity[2]\"";
    let found = format!("{value}");
    match value {
        Value::Array(list) if !list.is_empty() => Ok(list),
        Value::Table(table) => match table.try_into() {
            Ok(Range { from, to, count }) if (1..=MAX_ROWS).contains(&count) && from.is_finite() && to.is_finite() => {
                let step = |i: usize| if count == 1 { 0.0 } else { i as f64 / (count - 1) as f64 };
                // The last is what was written, to the last bit.
                let at = |i: usize| if i + 1 == count && count > 1 { to } else { from + (to - from) * step(i) };
                Ok((0..count).map(|i| Value::Float(at(i))).collect())
            }
            _ => Err((found, EXPECTED)),
        },
        _ => Err((found, EXPECTED)),
    }
}

/// Each list as long as the grid; the last parameter changes first.
fn grid(lists: &[(String, Vec<Value>)]) -> Option<Vec<(String, Vec<Value>)>> {
    let rows = lists.iter().try_fold(1usize, |rows, (_, values)| rows.checked_mul(values.len()))?;
    if rows > MAX_ROWS {
        return None;
    }
    let mut each = rows;
    let column = |(key, values): &(String, Vec<Value>)| {
        each /= values.len();
        (key.clone(), (0..rows).map(|row| values[row / each % values.len()].clone()).collect())
    };
    Some(lists.iter().map(column).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files that a geometry includes, and a table: each changes what the rows are.
    #[test]
    fn a_row_follows_from_every_file_that_is_read_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let scene = r#"
            title = "a"
            units = { length = "m", mass = "kg", time = "s" }
            body = { mesh = "part.geo", material = { young_modulus = 1e9, poisson_ratio = 0.3, density = 1e3 } }
            modes = { flexible = 1, measured = "modes.csv" }
            time = { end = 1.0, step = 0.1 }
            [[loads]]
            kind = "gravity"
            direction = [0, 0, -1]
            amplitude = 9.81
            history = { kind = "table", file = "table.csv" }
        "#;
        let files = [
            ("scene.toml", scene),
            ("part.geo", "Include \"size.geo\";"),
            ("size.geo", "h = 1;"),
            ("table.csv", "0, 0\n1, 1\n"),
            ("modes.csv", "frequency, damping\n10, 0.01\n"),
            (
                "sweep.toml",
                "scene = \"scene.toml\"\nparameters = { title = [\"a\", \"b\"] }\nresults = { a = { final = \"time\" } }",
            ),
        ];
        let write = |(name, text): (&str, &str)| std::fs::write(at(name), text).unwrap();
        files.into_iter().for_each(write);
        let plan = || Plan::read(&at("sweep.toml")).unwrap();
        let first = plan();
        assert!(first.identities[0] != first.identities[1] && !first.has_changed(0));
        for (name, text) in [
            ("part.geo", "Include \"size.geo\"; "),
            ("size.geo", "h = 2;"),
            ("table.csv", "0, 0\n1, 2\n"),
            ("modes.csv", "frequency, damping\n11, 0.01\n"),
            ("modes.csv", "frequency, damping\n10, 0.02\n"),
            ("modes.csv", "frequency\n10\n"),
        ] {
            write((name, text));
            let now = plan();
            assert!(now.identities[0] != first.identities[0], "{name}");
            assert!(now.identity == first.identity);
            assert_eq!(first.has_changed(0), name.starts_with("part") || name.starts_with("size"));
            files.into_iter().for_each(write);
            assert_eq!(plan().identities, first.identities);
        }
    }
}
