//! The part of a scene that all its bodies share.

use std::path::PathBuf;
use std::sync::Arc;

use dynamics::{Method, Rows, StepControl};
use schemars::JsonSchema;
use serde::Deserialize;

/// The part of a scene file that all its bodies share. A [`Body`](crate::Body) and a [`Scene`](crate::Scene) show it as theirs.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// Title of the run, for headings.
    pub title: String,
    /// Labels of the units, for axes and tables.
    pub units: Units,
    /// How far and how to step.
    pub time: Time,
    /// When a state is written, besides the first and the last: key `every`, after that number of steps, or `interval`, at the
    /// multiples of this time. By default after each step, or after as many as give 5000 rows; with a tolerance, at each 500th
    /// of the end.
    pub rows: Rows,
    /// Error of the answer, between 0 and 1, for which a run finds the settings; `None` leaves them as they are.
    pub accuracy: Option<f64>,
    /// The scene file, as it was named to [`Scene::read`](crate::Scene::read) or [`Scene::parse`](crate::Scene::parse).
    pub path: PathBuf,
    /// The text of the scene file.
    pub text: Arc<str>,
    /// Number of bodies in the file, of which some may have been left out.
    pub bodies_of_file: usize,
}

/// Labels of the units. The program never converts: they are shown, not used.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Label of the unit of length, e.g. `mm`.
    pub length: String,
    /// Label of the unit of mass, e.g. `Mg`.
    pub mass: String,
    /// Label of the unit of time, e.g. `s`.
    pub time: String,
}

/// How far and how to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// Time > 0 at the end of the run, which starts at 0.
    pub end: f64,
    /// Control of the length of a step: key `step`, 1e-12 end ≤ step ≤ end, or `tolerance`, above 0 and below 1.
    pub control: StepControl,
    /// The equations of motion and the way from one step to the next: keys `formulation` and `scheme`. Where bodies are in joints, springs
    /// or bushings it is one of [`Method::OF_JOINTS`]; [`Body::method`](crate::Body::method) is the one of a body.
    pub method: Method,
}
