//! The variables of an FMU: inputs, and the columns of a results file as outputs.

use dynamics::{DrivenMotion, Effect};
use model::Model;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use results::{Column, Metadata, Values};
use scene::{Load, Scene};

use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;

/// Source of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The time.
    Time,
    /// A number that the importing program sets.
    Input(Input),
    /// A number of the row of a results file.
    Row {
        /// Its place in the row.
        place: usize,
        /// True if it follows the inputs at once, as accelerations do.
        is_direct: bool,
        /// True if it is an output; otherwise it can be looked at, but is not for wiring.
        is_output: bool,
    },
}

/// A number that the importing program sets. Each is held from one communication point to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// The factor on a load of the scene, by its number among those that act.
    Factor(usize),
    /// A component of a force at a point of the output, global axes.
    Force(usize, usize),
    /// A component of a moment there, global axes.
    Moment(usize, usize),
    /// An acceleration that is added to that of the drive.
    DriveAcceleration,
}

impl Input {
    /// Its value until it is set.
    pub fn start(self) -> f64 {
        if matches!(self, Self::Factor(_)) { 1.0 } else { 0.0 }
    }
}

/// A variable of an FMU, a real number.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name by the rules of the naming convention "structured"; indices count from 1.
    pub name: String,
    /// Its description, for people.
    pub description: String,
    /// Unit in the words length, mass, time and rad.
    pub unit: &'static str,
    /// Its source.
    pub source: Source,
}

/// Forces of the body at the moment follow the inputs at once.
const DIRECT: [&str; 4] = ["angular_acceleration", "acceleration", "rigid_acceleration", "drive/"];
/// Columns for looking at, not for wiring.
const LOCAL: [&str; 3] = ["modal/", "energy/", "momentum/"];

/// All variables of a model: the time, the inputs, then the columns of a results file.
pub(super) fn variables(scene: &Scene, model: &Model, metadata: &Metadata) -> Vec<Variable> {
    let mut all =
        vec![Variable { name: "time".to_owned(), description: "time".to_owned(), unit: "time", source: Source::Time }];
    inputs(scene, model, &mut all);
    let mut place = 0;
    for column in COLUMNS.iter().filter(|column| column.is_in(metadata)) {
        let count: usize = column.row_shape(metadata).iter().product();
        for index in 0..count {
            if column.path != "time" {
                all.push(of_column(column, metadata, index, place + index));
            }
        }
        place += count;
    }
    all
}

fn inputs(scene: &Scene, model: &Model, all: &mut Vec<Variable>) {
    let mut add = |name: String, description: String, unit: &'static str, input: Input| {
        all.push(Variable { name, description, unit, source: Source::Input(input) });
    };
    let acts = |load: &Load| model.physics.effects[Effect::Gravity] || !matches!(load, Load::Gravity(_));
    for (acting, (i, _)) in scene.loads.iter().enumerate().filter(|(_, load)| acts(load)).enumerate() {
        let description = format!("factor on load {} of the scene, counted from 1, beside its own history", i + 1);
        add(format!("loads[{}].factor", i + 1), description, "1", Input::Factor(acting));
    }
    for (point, (name, _)) in model.points.iter().enumerate() {
        let name_of = |what: &str, axis: usize| format!("points.{}.{what}[{}]", identifier(name), axis + 1);
        for (axis, letter) in AXES.iter().enumerate() {
            let description = format!("force on the point {name}, {letter} (global)");
            add(name_of("force", axis), description, "mass length/time^2", Input::Force(point, axis));
        }
        for (axis, letter) in AXES.iter().enumerate() {
            let description = format!("moment on the point {name}, {letter} (global)");
            add(name_of("moment", axis), description, "mass length^2/time^2", Input::Moment(point, axis));
        }
    }
    if let Some(drive) = &model.physics.drive {
        let unit = match drive.motion {
            DrivenMotion::Turn { .. } => "rad/time^2",
            DrivenMotion::Slide { .. } => "length/time^2",
        };
        let description = "acceleration of the drive, added to that of the scene".to_owned();
        add("drive.acceleration".to_owned(), description, unit, Input::DriveAcceleration);
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn of_column(column: &Column<Row>, metadata: &Metadata, index: usize, place: usize) -> Variable {
    let Column { path, frame, description, unit, .. } = column;
    let places = column.places(metadata);
    let each: usize = column.row_shape(metadata).iter().product::<usize>() / places.len().max(1);
    let (mut name, point) = match (path.split_once('/'), places.get(index / each.max(1))) {
        (Some((group, quantity)), Some(point)) => {
            (format!("{group}.{}.{quantity}", identifier(point)), format!(" {point}"))
        }
        _ => (path.replace('/', "."), String::new()),
    };
    let component = index % each.max(1);
    let names: &[&str] = match column.values {
        Values::Quaternion(_) => &["w", "x", "y", "z"],
        Values::PointNumbers(6, _) => &["xx", "yy", "zz", "xy", "yz", "zx"],
        Values::Vector(_) | Values::Points(_) | Values::Supports(_) => &AXES,
        _ => &[],
    };
    let mut description = format!("{description}{point}");
    if each > 1 || matches!(column.values, Values::Modal(_)) {
        name += &format!("[{}]", component + 1);
        description += &names.get(component).map_or_else(|| format!(", {}", component + 1), |name| format!(", {name}"));
    }
    if *frame != "none" {
        description += &format!(" ({frame})");
    }
    let is_direct = DIRECT.iter().any(|direct| path.trim_start_matches("points/").starts_with(direct))
        || path.starts_with("reaction/");
    let is_output = !LOCAL.iter().any(|group| path.starts_with(group));
    Variable { name, description, unit, source: Source::Row { place, is_direct, is_output } }
}

/// Characters that a name in quotes may not have in it.
const ENCODED: &AsciiSet = &CONTROLS.add(b'\'').add(b'"').add(b'\\').add(b'`').add(b'%');

/// A name of the user's as FMI allows it: as it is where it is an identifier, otherwise in quotes, with what may not stand
/// there as in a URL.
fn identifier(name: &str) -> String {
    let is_letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    if name.starts_with(is_letter) && name.chars().all(|c| is_letter(c) || c.is_ascii_digit()) {
        return name.to_owned();
    }
    format!("'{}'", utf8_percent_encode(name, ENCODED))
}

#[cfg(test)]
mod tests {
    use super::identifier;

    #[test]
    fn names_of_points_are_identifiers_or_stand_in_quotes() {
        for (name, expected) in [
            ("tip", "tip"),
            ("_P1", "_P1"),
            ("1", "'1'"),
            ("left wing", "'left wing'"),
            ("it's 50%", "'it%27s 50%25'"),
            ("Flügel", "'Fl%C3%BCgel'"),
        ] {
            assert_eq!(identifier(name), expected);
        }
    }
}
