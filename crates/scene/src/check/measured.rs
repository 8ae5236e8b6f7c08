//! The rules on tables of measured modes.

use std::io::Read;
use std::path::Path;

use crate::body::measured::{Measured, MeasuredMode};
use crate::body::modes::Flexible;
use crate::check::Check;
use crate::error::SceneError;
use crate::text::ordinary_file::open_ordinary;
use crate::text::place::Place;
use crate::text::shorten::shorten;

const KEY: &str = "modes.measured";
const HEAD: &str = "columns `frequency`, `deviation`, `damping` and, for shapes, `POINT.x`, `POINT.y`, `POINT.z` of points of the output";
/// Bytes of a table at the most.
const LONGEST: u64 = 1 << 24;

/// A column of the table.
enum Column {
    Frequency,
    Deviation,
    Damping,
    Shape(usize),
}

impl Check<'_> {
    /// The measured modes of a file, which is read.
    pub fn measured(&self, file: &Path, flexible: Flexible) -> Result<Measured, SceneError> {
        let file = self.document.folder().join(file);
        let text = self.table_text(KEY, &file)?;
        let measured = parse(&text, &file)?;
        if measured.places.is_empty() {
            self.not_more_than_modes(KEY, measured.modes.len(), flexible)?;
        }
        Ok(measured)
    }
}

impl Measured {
    /// The measured modes of a file that no scene names.
    ///
    /// # Errors
    /// [`SceneError`] with the line of the file.
    pub fn read(file: &Path) -> Result<Self, SceneError> {
        let mut text = String::new();
        let read = open_ordinary(file).and_then(|opened| opened.take(LONGEST + 1).read_to_string(&mut text));
        let refuse = |found: String| {
            let help = "name a CSV file in UTF-8: a line of names, then a line for each measured mode";
            Err(Place::unseen(file, 1, KEY.to_owned()).refuse(found, HEAD, help))
        };
        match read {
            Err(cause) => refuse(format!("a table that cannot be read: {}: {cause}", shorten(&file.to_string_lossy()))),
            Ok(length) if length as u64 > LONGEST => refuse(format!("a table of more than {LONGEST} bytes")),
            Ok(_) => parse(&text, file),
        }
    }
}

/// A field in messages: a number. Other words are not shown, since a scene from elsewhere may name any file of the user's.
fn shown(field: &str) -> String {
    match field.parse::<f64>() {
        Ok(number) => number.to_string(),
        Err(_) if field.is_empty() => "that is not there".to_owned(),
        Err(_) => "that is no number".to_owned(),
    }
}

/// The modes of a CSV text, whose first line names the columns; empty lines and those that begin with `#` are left out.
fn parse(text: &str, file: &Path) -> Result<Measured, SceneError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let refuse = |line: usize, found: String, expected: &str, help: &str| {
        Err(Place::unseen(file, line, KEY.to_owned()).refuse(found, expected, help))
    };
    let is_data = |line: &&str| !line.is_empty() && !line.starts_with('#');
    let mut lines = (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| is_data(line));
    let mut places = Vec::new();
    let mut columns = Vec::new();
    if let Some((line, head)) = lines.next() {
        for name in head.split(',').map(str::trim) {
            let axis = |axis: &str| ["x", "y", "z"].iter().position(|known| *known == axis);
            let place = name.rsplit_once('.').and_then(|(point, of)| Some((point.to_owned(), axis(of)?)));
            columns.push(match (name, place) {
                ("frequency", _) => Column::Frequency,
                ("deviation", _) => Column::Deviation,
                ("damping", _) => Column::Damping,
                (_, Some(place)) => {
                    places.push(place);
                    Column::Shape(places.len() - 1)
                }
                _ => {
                    let found = format!("another name of the column {}", columns.len() + 1);
                    return refuse(line, found, HEAD, "name the columns in the first line");
                }
            });
        }
        let count = |is: fn(&Column) -> bool| columns.iter().filter(|column| is(column)).count();
        let twice = (1..places.len()).find(|i| places[..*i].contains(&places[*i]));
        if count(|column| matches!(column, Column::Frequency)) != 1
            || count(|column| matches!(column, Column::Deviation)) > 1
            || count(|column| matches!(column, Column::Damping)) > 1
            || twice.is_some()
        {
            return refuse(
                line,
                "a column that is there twice, or no `frequency`".to_owned(),
                HEAD,
                "name each column once, and `frequency` always",
            );
        }
    }
    let mut modes: Vec<MeasuredMode> = Vec::new();
    for (line, row) in lines {
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != columns.len() {
            let found = format!("{} field(s) in the line", fields.len());
            return refuse(line, found, &format!("{}, one for each column", columns.len()), "correct the line");
        }
        let shape = vec![0.0; places.len()];
        let mut mode = MeasuredMode { line, frequency: 0.0, deviation: None, damping_ratio: None, shape };
        for (column, field) in columns.iter().zip(&fields) {
            let number = field.parse().ok().filter(|number: &f64| number.is_finite());
            match (column, number) {
                (Column::Frequency, Some(frequency)) if frequency > 0.0 => mode.frequency = frequency,
                (Column::Frequency, _) => {
                    return refuse(
                        line,
                        format!("the frequency {}", shown(field)),
                        "a number above 0, cycles per time",
                        "correct it",
                    );
                }
                (Column::Deviation, None) if field.is_empty() => {}
                (Column::Deviation, Some(deviation)) if deviation > 0.0 => mode.deviation = Some(deviation),
                (Column::Deviation, _) => {
                    let expected = "a standard deviation of the frequency above 0, cycles per time, or nothing";
                    return refuse(line, format!("the deviation {}", shown(field)), expected, "correct it");
                }
                (Column::Damping, None) if field.is_empty() => {}
                (Column::Damping, Some(ratio)) if ratio >= 0.0 => mode.damping_ratio = Some(ratio),
                (Column::Damping, _) => {
                    let expected = "a fraction of critical damping, 0 or more, or nothing for that of the scene";
                    return refuse(line, format!("the damping {}", shown(field)), expected, "correct it");
                }
                (Column::Shape(place), Some(value)) => mode.shape[*place] = value,
                (Column::Shape(_), None) => {
                    return refuse(
                        line,
                        format!("the entry {} of a shape", shown(field)),
                        "a finite number",
                        "correct it",
                    );
                }
            }
        }
        if !mode.shape.is_empty() && mode.shape.iter().all(|value| *value == 0.0) {
            return refuse(line, "a shape of zeros".to_owned(), "a shape that moves", "leave the line out");
        }
        if let Some(before) = modes.last().filter(|before| places.is_empty() && before.frequency > mode.frequency) {
            let found = format!("the frequency {:?} after {:?}", mode.frequency, before.frequency);
            let help = "put the lines in order, or add the shapes, so that modes are matched by these";
            return refuse(line, found, "frequencies that rise, since modes are matched by their order", help);
        }
        modes.push(mode);
    }
    if modes.is_empty() {
        return refuse(
            1,
            "no measured mode".to_owned(),
            "a line of names and one or more lines of numbers",
            "add them",
        );
    }
    Ok(Measured { file: file.to_owned(), places, modes })
}
