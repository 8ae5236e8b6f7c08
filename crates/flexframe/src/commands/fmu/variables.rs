//! The variables of an FMU: inputs, and the columns of a results file as outputs.

use dynamics::{Coordinate, DrivenMotion, Effect};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use results::{Components, Dimension, History, JointMetadata, Metadata, Role, histories};
use scene::{End, Load, Scene};

use crate::commands::run::RunBody;
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
pub struct Input {
    /// Number of its body; of a joint, that of one that it holds.
    pub body: usize,
    /// Its kind.
    pub kind: InputKind,
}

/// Kinds of inputs of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputKind {
    /// The factor on a load of the scene, by its number among those that act.
    Factor(usize),
    /// A component of a force at a point of the output, global axes.
    Force(usize, usize),
    /// A component of a moment there, global axes.
    Moment(usize, usize),
    /// An acceleration that is added to that of the drive.
    DriveAcceleration,
    /// A moment about the turn of a joint, or a force along its slide, by its number in the scene.
    Motor(usize, Coordinate),
}

impl Input {
    /// Its value until it is set.
    pub fn start(self) -> f64 {
        if matches!(self.kind, InputKind::Factor(_)) { 1.0 } else { 0.0 }
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

/// All variables of a model: the time, the inputs of each body, then the columns of a results file.
pub(super) fn variables(scene: &Scene, bodies: &[RunBody<'_>], metadata: &Metadata) -> Vec<Variable> {
    let mut all =
        vec![Variable { name: "time".to_owned(), description: "time".to_owned(), unit: "time", source: Source::Time }];
    for (i, body) in bodies.iter().enumerate() {
        inputs(i, body, &Of::body(metadata, i), &mut all);
    }
    motors(scene, &mut all);
    let mut place = 0;
    for history in histories(&COLUMNS, metadata) {
        let count = history.width(metadata);
        all.extend((0..count).map(|index| of_history(history, metadata, index, place + index)));
        place += count;
    }
    all
}

/// The thing that variables are of, as their names and descriptions have it: nothing of a single body.
struct Of {
    prefix: String,
    words: String,
}

impl Of {
    fn body(metadata: &Metadata, body: usize) -> Self {
        match metadata.bodies.get(body).filter(|_| metadata.only_body().is_none()) {
            Some(body) => {
                Self { prefix: format!("{}.", identifier(&body.name)), words: format!(" of the body {}", body.name) }
            }
            None => Self { prefix: String::new(), words: String::new() },
        }
    }

    fn history(history: History<Row>, metadata: &Metadata) -> Self {
        match history.body {
            Some(body) => Self::body(metadata, body),
            None => match history.joint.and_then(|joint| metadata.joints.get(joint)) {
                Some(JointMetadata { name, kind, .. }) => {
                    let what = if ["spring", "bushing"].contains(&kind.as_str()) { kind } else { "joint" };
                    Self { prefix: format!("joints.{}.", identifier(name)), words: format!(" of the {what} {name}") }
                }
                None => Self { prefix: "system.".to_owned(), words: String::new() },
            },
        }
    }
}

fn inputs(number: usize, RunBody { body, model }: &RunBody<'_>, of: &Of, all: &mut Vec<Variable>) {
    let Of { prefix, words } = of;
    let mut add = |name: String, description: String, unit: &'static str, kind: InputKind| {
        let source = Source::Input(Input { body: number, kind });
        all.push(Variable { name: format!("{prefix}{name}"), description, unit, source });
    };
    let acts = |load: &Load| model.physics.effects[Effect::Gravity] || !load.is_gravity();
    for (acting, (i, _)) in body.loads.iter().enumerate().filter(|(_, load)| acts(load)).enumerate() {
        let whole = if words.is_empty() { " of the scene" } else { words };
        let description = format!("factor on load {}{whole}, counted from 1, beside its own history", i + 1);
        add(format!("loads[{}].factor", i + 1), description, "1", InputKind::Factor(acting));
    }
    let axes = Components::Vector.names();
    for (point, (name, _)) in model.points.iter().enumerate() {
        let name_of = |what: &str, axis: usize| format!("points.{}.{what}[{}]", identifier(name), axis + 1);
        for (axis, letter) in axes.iter().enumerate() {
            let description = format!("force on the point {name}{words}, {letter} (global)");
            add(name_of("force", axis), description, Dimension::Force.unit(), InputKind::Force(point, axis));
        }
        for (axis, letter) in axes.iter().enumerate() {
            let description = format!("moment on the point {name}{words}, {letter} (global)");
            add(name_of("moment", axis), description, Dimension::Moment.unit(), InputKind::Moment(point, axis));
        }
    }
    if let Some(drive) = &model.physics.drive {
        let dimension = match drive.motion {
            DrivenMotion::Turn { .. } => Dimension::AngularAcceleration,
            DrivenMotion::Slide { .. } => Dimension::Acceleration,
        };
        let description = format!("acceleration of the drive{words}, added to that of the scene");
        add("drive.acceleration".to_owned(), description, dimension.unit(), InputKind::DriveAcceleration);
    }
}

/// A motor along each coordinate of each joint.
fn motors(scene: &Scene, all: &mut Vec<Variable>) {
    for (number, joint) in scene.joints.iter().enumerate() {
        let Some(body) = joint.between.iter().find_map(End::body) else { continue };
        for along in joint.kind.coordinates() {
            let (what, words, unit) = match along {
                Coordinate::Turn => ("torque", "moment about the axis", Dimension::Moment.unit()),
                Coordinate::Slide => ("force", "force along the axis", Dimension::Force.unit()),
            };
            all.push(Variable {
                name: format!("joints.{}.motor.{what}", identifier(&joint.name)),
                description: format!("{words} of a motor in the joint {}, on the second body", joint.name),
                unit,
                source: Source::Input(Input { body, kind: InputKind::Motor(number, *along) }),
            });
        }
    }
}

fn of_history(history: History<Row>, metadata: &Metadata, index: usize, place: usize) -> Variable {
    let column = history.column;
    let Of { prefix, words } = Of::history(history, metadata);
    let each = history.values_of_each(metadata).max(1);
    let point = history.places(metadata).get(index / each);
    let [group, of_point] = [column.group.to_owned(), point.map_or_else(String::new, |name| identifier(name))];
    let parts = [group.as_str(), &of_point, column.name];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    let mut name = format!("{prefix}{}", parts.join("."));
    let mut description =
        format!("{}{}{words}", column.description, point.map_or_else(String::new, |name| format!(" {name}")));
    let component = index % each;
    if column.components() != Components::Number {
        name += &format!("[{}]", component + 1);
        let names = column.components().names();
        description += &names.get(component).map_or_else(|| format!(", {}", component + 1), |name| format!(", {name}"));
    }
    if column.frame != "none" {
        description += &format!(" ({})", column.frame);
    }
    let (is_direct, is_output) = (column.role == Role::Direct, column.role != Role::Internal);
    Variable { name, description, unit: column.dimension.unit(), source: Source::Row { place, is_direct, is_output } }
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
