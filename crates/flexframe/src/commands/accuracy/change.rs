//! The change of the settings that mends the largest share of an error.

use std::mem::discriminant;

use scene::{Rows, StepControl, key_path};
use toml::Value;

use super::stated::{BodyError, index};
use crate::commands::run::StoppedBy;
use crate::report::rounded;
use crate::trust::{Place, percent};

/// The part of the accuracy that one setting may take.
pub(super) const PART: f64 = 0.1;
/// Part of the accuracy that a mesh is advised for.
const OF_MESH: f64 = 0.5;
/// A tolerance below this is rounding.
const LEAST_TOLERANCE: f64 = 1e-12;

/// A change of the settings.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// Static shapes of the loads beside the modes.
    StaticShapes,
    /// This number of modes.
    Modes(usize),
    /// The stiffening by stress that the scene has switched off.
    Stiffening,
    /// The program's choice of large modes.
    LargeModes,
    /// These large modes, numbered from 1, and the most that follow them.
    TheseLarge(Vec<usize>, usize),
    /// No modes that are large.
    NoneLarge,
    /// Modes about the bent rest.
    BentRest,
    /// This tolerance of the steps.
    Tolerance(f64),
    /// This tolerance in the place of a step, with rows at this interval.
    ToleranceForStep(f64, f64),
    /// This step, and the number of steps between rows where they are counted.
    Step(f64, Option<u64>),
    /// Influence of effects that are left out.
    Effects(f64),
}

/// The settings of a body, and what its model has made of them.
#[derive(Debug, Clone)]
pub(super) struct Facts {
    /// Natural modes.
    pub modes: usize,
    pub has_static_shapes: bool,
    pub has_large_modes: bool,
    /// True if the scene has switched the stiffening by stress off.
    pub is_without_stiffening: bool,
    /// True if the method has large deflections.
    pub may_bend_far: bool,
    /// Other large modes that the check has found better.
    pub better: Option<(Vec<usize>, usize)>,
    /// True if the modes are about a bent rest already.
    pub is_about_rest: bool,
    pub control: StepControl,
    pub rows: Rows,
    pub end: f64,
    /// True if the method can have a tolerance.
    pub estimates_error: bool,
    pub mesh_size: Option<f64>,
    /// True if most of what the modes leave out rings, which static shapes do not.
    pub modes_ring: bool,
    /// True if the steps were too long for a change.
    pub steps_are_in_the_way: bool,
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stop {
    pub by: StoppedBy,
    /// In words, with a cure.
    pub why: String,
}

/// Changes that have brought nothing, by body.
#[derive(Debug, Default)]
pub(super) struct Tried(Vec<(usize, Change)>);

impl Tried {
    pub fn add(&mut self, body: usize, change: &Change) {
        self.0.push((body, change.clone()));
    }

    /// True if other steps were tried.
    pub fn has_steps(&self) -> bool {
        self.0.iter().any(|(_, change)| change.is_of_steps())
    }

    fn has(&self, body: usize, change: &Change) -> bool {
        self.0.iter().any(|(of, other)| *of == body && discriminant(other) == discriminant(change))
    }
}

/// The change that mends the largest share of an error, of those that were not tried in vain.
pub(super) fn next(error: &BodyError, facts: &Facts, accuracy: f64, tried: &Tried) -> Result<Change, Stop> {
    let mesh = error.share(Place::Mesh);
    if mesh >= accuracy {
        return Err(stopped_by_mesh(mesh, facts, accuracy, error.of.contains("stress")));
    }
    if error.at_most() < accuracy && error.unstable {
        return Err(unstable());
    }
    let is_known = |place: Place| error.shares[index(place)].is_some();
    if let (false, Some(unknown)) =
        ([Place::Mesh, Place::Modes, Place::Model].into_iter().all(is_known), &error.unknown)
    {
        return Err(Stop { by: StoppedBy::NotKnown, why: unknown.clone() });
    }
    let unknown_steps = !is_known(Place::Steps);
    let first = (unknown_steps || facts.steps_are_in_the_way).then_some(Place::Steps);
    for place in first.into_iter().chain(error.order()) {
        let found = changes(place, facts, accuracy).into_iter().find(|change| !tried.has(error.body, change));
        if let Some(change) = found {
            return Ok(change);
        }
        if error.share(place) >= accuracy {
            return Err(stopped_by(place, error, facts));
        }
    }
    Err(match &error.unknown {
        Some(unknown) if !error.unstable => Stop { by: StoppedBy::NotKnown, why: unknown.clone() },
        Some(_) => unstable(),
        None => stopped_by(error.order()[0], error, facts),
    })
}

/// Changes that may mend a place, the likeliest first.
fn changes(place: Place, facts: &Facts, accuracy: f64) -> Vec<Change> {
    match place {
        Place::Mesh => Vec::new(),
        Place::Modes => {
            let shapes = (!facts.has_static_shapes && !facts.modes_ring).then_some(Change::StaticShapes);
            shapes.into_iter().chain([Change::Modes(2 * facts.modes)]).collect()
        }
        Place::Steps => match facts.control {
            StepControl::Tolerance(tolerance) if tolerance > LEAST_TOLERANCE => {
                vec![Change::Tolerance(rounded((PART * tolerance).min(PART * accuracy), 1))]
            }
            StepControl::Tolerance(_) => Vec::new(),
            StepControl::Fixed(step) if facts.estimates_error => {
                let interval = match facts.rows {
                    Rows::EverySteps(every) => (every as f64 * step).min(facts.end),
                    Rows::Interval(interval) => interval,
                };
                vec![Change::ToleranceForStep(rounded(PART * accuracy, 1), interval)]
            }
            StepControl::Fixed(step) => {
                let every = match facts.rows {
                    Rows::EverySteps(every) => Some(4 * every),
                    Rows::Interval(_) => None,
                };
                vec![Change::Step(0.25 * step, every)]
            }
        },
        Place::Model if !facts.may_bend_far => Vec::new(),
        Place::Model => {
            let stiffening = facts.is_without_stiffening.then_some(Change::Stiffening);
            let better = facts.better.clone().map(|(large, following)| Change::TheseLarge(large, following));
            let rest = (!facts.is_about_rest).then_some(Change::BentRest);
            let large = if facts.has_large_modes { [better, rest] } else { [Some(Change::LargeModes), None] };
            stiffening.into_iter().chain(large.into_iter().flatten()).chain([Change::Modes(2 * facts.modes)]).collect()
        }
    }
}

fn stopped_by_mesh(error: f64, facts: &Facts, accuracy: f64, is_stress: bool) -> Stop {
    // An energy falls at least with the square of the size, and stress with its root.
    let ratio = OF_MESH * accuracy / error;
    let part = if is_stress { ratio } else { ratio.sqrt() };
    let part_in_words = rounded(part, 2);
    let size = match facts.mesh_size {
        Some(size) => format!("`mesh_size = {}` would do", rounded(part * size, 2)),
        None => format!("elements of about {part_in_words} of their size would do"),
    };
    Stop { by: StoppedBy::Mesh, why: format!("the mesh, which alone is off by {}: {size}", percent(error)) }
}

fn unstable() -> Stop {
    let why = "an unstable path: the full body has lost its stability in a row (`flexframe check` has it), where small causes decide";
    Stop { by: StoppedBy::Instability, why: why.to_owned() }
}

fn stopped_by(place: Place, error: &BodyError, facts: &Facts) -> Stop {
    if error.unstable {
        return unstable();
    }
    let share = percent(error.share(place));
    let (by, why) = match place {
        Place::Mesh => return stopped_by_mesh(error.share(place), facts, error.share(place), false),
        Place::Modes => (StoppedBy::Modes, format!("the modes: {share} is left out, and more of them do not help")),
        Place::Steps => (StoppedBy::Steps, format!("the steps in time: {share}, and finer ones do not help")),
        Place::Model if !facts.may_bend_far => {
            let cure = "take the conservative form, and large modes";
            (StoppedBy::LinearStrain, format!("linear strain: {share} is what the equations leave out; {cure}"))
        }
        Place::Model if error.drift >= 0.99 * error.share(place) => {
            let cure = "a shorter run, or damping";
            (
                StoppedBy::Model,
                format!("the model: its vibrations come out of step by up to {share} by the end; {cure}"),
            )
        }
        Place::Model => {
            let cure = "smaller loads, or a body in parts that joints hold together";
            (StoppedBy::Model, format!("the model: {share}; the body bends further than its large modes hold; {cure}"))
        }
    };
    Stop { by, why }
}

impl Change {
    /// The keys of the scene with their values, or none where they are taken out. `body` is the name of one of several.
    pub fn keys(&self, body: Option<&str>) -> Vec<(String, Option<Value>)> {
        let of_body = |key: &str| match body {
            Some(name) => format!("{}.{key}", key_path("bodies", name)),
            None => key.to_owned(),
        };
        let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        let large = |on: bool| (of_body("effects.large_deflection"), Some(Value::Boolean(on)));
        match self {
            Self::StaticShapes => vec![(of_body("modes.static_correction"), Some(Value::Boolean(true)))],
            Self::Modes(count) => {
                vec![(of_body("modes.most"), None), (of_body("modes.flexible"), Some(number(*count)))]
            }
            Self::Stiffening => vec![(of_body("effects.geometric_stiffening"), Some(Value::Boolean(true)))],
            Self::LargeModes => vec![large(true)],
            Self::NoneLarge => vec![large(false)],
            Self::TheseLarge(modes, following) => vec![
                large(true),
                (of_body("modes.large"), Some(Value::Array(modes.iter().map(|mode| number(*mode)).collect()))),
                (of_body("modes.following"), Some(number(*following))),
            ],
            Self::BentRest => vec![(of_body("modes.about"), Some("auto".into()))],
            Self::Effects(tolerance) => vec![(of_body("effects.tolerance"), Some((*tolerance).into()))],
            Self::Tolerance(tolerance) => vec![("time.tolerance".to_owned(), Some((*tolerance).into()))],
            Self::ToleranceForStep(tolerance, interval) => vec![
                ("time.step".to_owned(), None),
                ("output.every".to_owned(), None),
                ("time.tolerance".to_owned(), Some((*tolerance).into())),
                ("output.interval".to_owned(), Some((*interval).into())),
            ],
            Self::Step(step, every) => {
                let every = every.map(|every| {
                    let every = Value::Integer(i64::try_from(every).unwrap_or(i64::MAX));
                    ("output.every".to_owned(), Some(every))
                });
                std::iter::once(("time.step".to_owned(), Some((*step).into()))).chain(every).collect()
            }
        }
    }

    /// True if it is one of the steps in time.
    pub fn is_of_steps(&self) -> bool {
        matches!(self, Self::Tolerance(_) | Self::ToleranceForStep(..) | Self::Step(..))
    }

    /// The change in words.
    pub fn words(&self) -> String {
        match self {
            Self::StaticShapes => "static shapes".to_owned(),
            Self::Modes(count) => format!("{count} modes"),
            Self::Stiffening => "stiffening by stress".to_owned(),
            Self::LargeModes => "large modes".to_owned(),
            Self::NoneLarge => "no large modes".to_owned(),
            Self::TheseLarge(modes, following) => format!("large modes {modes:?}, {following} that follow"),
            Self::BentRest => "modes about the bent rest".to_owned(),
            Self::Tolerance(tolerance) | Self::ToleranceForStep(tolerance, _) => format!("tolerance {tolerance:e}"),
            Self::Step(step, _) => format!("step {step:e}"),
            Self::Effects(tolerance) => format!("effects from {}", percent(*tolerance)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts() -> Facts {
        Facts {
            modes: 4,
            has_static_shapes: false,
            has_large_modes: false,
            is_without_stiffening: false,
            may_bend_far: true,
            better: None,
            is_about_rest: false,
            control: StepControl::Tolerance(1e-3),
            rows: Rows::Interval(0.1),
            end: 1.0,
            estimates_error: true,
            mesh_size: None,
            modes_ring: false,
            steps_are_in_the_way: false,
        }
    }

    /// Shares of mesh, modes, steps and model.
    fn error(shares: [f64; 4]) -> BodyError {
        let of = "displacements".to_owned();
        BodyError { body: 0, shares: shares.map(Some), of, unknown: None, left_out: None, drift: 0.0, unstable: false }
    }

    #[test]
    fn the_largest_share_is_mended_by_its_first_change_that_was_not_tried() {
        let mut tried = Tried::default();
        let chosen = |shares, facts: &Facts, tried: &Tried| next(&error(shares), facts, 0.01, tried);
        let of_modes = [1e-3, 0.04, 1e-3, 0.02];
        assert_eq!(chosen(of_modes, &facts(), &tried), Ok(Change::StaticShapes));
        let shaped = Facts { has_static_shapes: true, ..facts() };
        assert_eq!(chosen(of_modes, &shaped, &tried), Ok(Change::Modes(8)));
        let ringing = Facts { modes_ring: true, ..facts() };
        assert_eq!(chosen(of_modes, &ringing, &tried), Ok(Change::Modes(8)));
        assert_eq!(chosen([1e-3, 1e-3, 0.02, 1e-3], &shaped, &tried), Ok(Change::Tolerance(1e-4)));
        let of_model = [1e-3, 1e-3, 1e-3, 0.3];
        assert_eq!(chosen(of_model, &facts(), &tried), Ok(Change::LargeModes));
        let soft = Facts { is_without_stiffening: true, ..facts() };
        assert_eq!(chosen(of_model, &soft, &tried), Ok(Change::Stiffening));
        let large = Facts { has_large_modes: true, better: Some((vec![1, 2], 3)), ..facts() };
        assert_eq!(chosen(of_model, &large, &tried), Ok(Change::TheseLarge(vec![1, 2], 3)));
        for vain in [Change::TheseLarge(Vec::new(), 0), Change::BentRest] {
            tried.add(0, &vain);
        }
        assert_eq!(chosen(of_model, &large, &tried), Ok(Change::Modes(8)));
        tried.add(0, &Change::Modes(8));
        assert_eq!(chosen(of_model, &large, &tried).unwrap_err().by, StoppedBy::Model);
        let long = Facts { steps_are_in_the_way: true, ..large.clone() };
        assert_eq!(chosen(of_model, &long, &tried), Ok(Change::Tolerance(1e-4)));
        // Those of another body are open.
        assert_eq!(
            next(&BodyError { body: 1, ..error(of_model) }, &large, 0.01, &tried).unwrap(),
            Change::TheseLarge(vec![1, 2], 3)
        );
    }

    /// Closed form: an energy that falls with the square of the size, from 4 % to half of 1 %, wants √(1/8) of it.
    #[test]
    fn a_mesh_that_is_worse_than_the_accuracy_stops_the_search_with_a_size() {
        let stop = |facts: &Facts| next(&error([0.04, 0.3, 0.0, 0.0]), facts, 0.01, &Tried::default()).unwrap_err();
        assert_eq!(stop(&facts()).by, StoppedBy::Mesh);
        assert!(stop(&facts()).why.contains("elements of about 0.35 of their size"), "{}", stop(&facts()).why);
        let sized = Facts { mesh_size: Some(2.0), ..facts() };
        assert!(stop(&sized).why.contains("`mesh_size = 0.71` would do"), "{}", stop(&sized).why);
    }

    #[test]
    fn what_nothing_mends_stops_the_search() {
        let stop = |error: BodyError, facts: &Facts| next(&error, facts, 0.01, &Tried::default()).unwrap_err().by;
        let linear = Facts { may_bend_far: false, ..facts() };
        assert_eq!(stop(error([0.0, 0.0, 0.0, 0.3]), &linear), StoppedBy::LinearStrain);
        let small = error([0.0, 0.0, 0.0, 1e-3]);
        assert_eq!(stop(BodyError { unstable: true, ..small.clone() }, &facts()), StoppedBy::Instability);
        // Steps of which nothing is known give way to a tolerance.
        let unknown = Some("steps".to_owned());
        let shares = [Some(0.0), Some(0.0), None, Some(0.0)];
        let steps = BodyError { shares, unknown, ..small };
        let fixed = Facts { control: StepControl::Fixed(0.01), rows: Rows::EverySteps(5), ..facts() };
        let change = next(&steps, &fixed, 0.01, &Tried::default());
        assert_eq!(change, Ok(Change::ToleranceForStep(1e-3, 0.05)));
        let keys = change.unwrap().keys(None);
        assert!(keys.contains(&("time.step".to_owned(), None)) && keys.contains(&("output.every".to_owned(), None)));
    }
}
