//! The error that the trust card of a run states of each body, its points and its stress.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use results::TrustLine;

use crate::commands::check::report::RowCheck;
use crate::commands::run::RunReport;
use crate::trust::Place;

/// A point that moves by less than this part of the largest displacement of its body counts against that part.
pub(super) const STILL: f64 = 1e-2;

/// The error of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BodyError {
    /// Its number in the scene.
    pub body: usize,
    /// The share of each place in the answer that is worst; `None` where it is not known.
    pub shares: [Option<f64>; Place::ALL.len()],
    /// The answer that is worst.
    pub of: String,
    /// The part that is not known, in words.
    pub unknown: Option<String>,
    /// The part by which modes that are left out ring; `None` until it is compared.
    pub left_out: Option<f64>,
    /// The part of the model by which vibrations come out of step.
    pub drift: f64,
    /// True if the full body is unstable in a row, or may be.
    pub unstable: bool,
}

impl BodyError {
    /// The sum of the shares; `None` where one is not known.
    pub fn whole(&self) -> Option<f64> {
        let sum: Option<f64> = self.shares.iter().copied().sum();
        Some(sum? + self.left_out.unwrap_or(0.0))
    }

    /// The same with what is not known as infinite.
    pub fn at_most(&self) -> f64 {
        self.whole().filter(|_| self.unknown.is_none()).unwrap_or(f64::INFINITY)
    }

    /// The share of a place; 0 where it is not known.
    pub fn share(&self, place: Place) -> f64 {
        let left_out = self.left_out.filter(|_| place == Place::Modes).unwrap_or(0.0);
        self.shares[index(place)].unwrap_or(0.0) + left_out
    }

    /// The places, the largest share first.
    pub fn order(&self) -> [Place; Place::ALL.len()] {
        let mut places = Place::ALL;
        places.sort_by(|a, b| self.share(*b).total_cmp(&self.share(*a)));
        places
    }
}

pub(super) fn index(place: Place) -> usize {
    place as usize
}

/// The error of each body of a run that has a mesh, the worst first. `with_mesh`: their numbers.
pub(super) fn errors(report: &RunReport, with_mesh: &[usize]) -> Vec<BodyError> {
    let mut errors: Vec<BodyError> = with_mesh.iter().map(|body| of_body(report, *body)).collect();
    errors.sort_by(|a, b| b.at_most().total_cmp(&a.at_most()));
    errors
}

fn of_body(report: &RunReport, body: usize) -> BodyError {
    let name = report.bodies.get(body).map(|body| body.name.as_str()).filter(|_| report.bodies.len() > 1);
    let lines = report.trust.iter().flat_map(|card| &card.of_bodies);
    let lines: Vec<&TrustLine> = lines.filter(|line| line.body.as_deref() == name).collect();
    let line = |place: Place| lines.iter().find(|line| line.place == place.name());
    let card = Place::ALL.map(|place| line(place).and_then(|line| line.error));
    let checked = report.check.as_ref().and_then(|check| check.bodies.get(body));
    let rows = checked.map_or(&[][..], |checked| &checked.rows);
    let drift = rows.iter().map(|row| row.state.drift).fold(0.0, f64::max);
    let (shares, of) = worst(card, rows, drift);
    let not_known = Place::ALL.iter().find(|place| card[index(**place)].is_none());
    let unsettled = rows.iter().find(|row| !row.state.is_settled);
    let unknown = match (not_known, unsettled) {
        (Some(place), _) => {
            let words = line(*place).map_or_else(String::new, |line| {
                let why = line.meaning.trim_start_matches("not known: ");
                if line.next.is_empty() { why.to_owned() } else { format!("{why}; to do: {}", line.next) }
            });
            Some(format!("an error that is not known, of the {}: {words}", place.name()))
        }
        (None, Some(row)) => Some(format!(
            "an error that is not known, of the model at time {:.6}: it is so large that the full body has not settled it",
            row.state.time
        )),
        (None, None) => None,
    };
    let of = if let Some(name) = name { format!("{of} of body {name}") } else { of };
    BodyError { body, shares, of, unknown, left_out: None, drift, unstable: rows.iter().any(is_unstable) }
}

/// True if a vibration of the full body grows, or if it has lost stiffness and nothing tells whether its spin holds it.
fn is_unstable(row: &RowCheck) -> bool {
    let lost = row.state.negative_directions.is_some_and(|count| count > 0);
    row.state.growth > 0.0 || (lost && row.state.frequencies.is_empty())
}

type Shares = [Option<f64>; Place::ALL.len()];

/// The shares in the answer of a body that has the largest sum: displacements of the body, displacements of a point, stress.
fn worst(card: Shares, rows: &[RowCheck], drift: f64) -> (Shares, String) {
    let mut worst = (card, "displacements".to_owned());
    let [mesh, modes, steps, model] = [Place::Mesh, Place::Modes, Place::Steps, Place::Model].map(index);
    let (Some(of_mesh), Some(of_steps), Some(of_modes), Some(of_model)) =
        (card[mesh], card[steps], card[modes], card[model])
    else {
        return worst;
    };
    let mut most = of_mesh + of_steps + of_modes + of_model;
    let mut add = |of: String, of_mesh: f64, of_body: f64| {
        if of_mesh + of_steps + of_body > most {
            most = of_mesh + of_steps + of_body;
            // In proportion to what the card has of them.
            let known = of_modes + of_model;
            let part = if known > 0.0 { of_modes / known } else { 0.5 };
            let mut shares = card;
            shares[mesh] = Some(of_mesh);
            shares[modes] = Some(part * of_body);
            shares[model] = Some((1.0 - part) * of_body);
            worst = (shares, of);
        }
    };
    for (name, error) in points(rows) {
        add(format!("point {name}"), of_mesh, error.max(drift));
    }
    // The mesh line is an energy, of which the stress of elements is off by the root.
    for (name, error) in stresses(rows) {
        add(name, of_mesh.sqrt(), error.max(drift));
    }
    worst
}

/// The largest error of each point, over the largest displacement of it.
fn points(rows: &[RowCheck]) -> BTreeMap<&str, f64> {
    let least = STILL * rows.iter().map(|row| row.state.largest_displacement).fold(0.0, f64::max);
    let each = rows.iter().flat_map(|row| &row.state.points);
    let sizes = each.map(|point| {
        let [error, size] = [point.error, point.displacement].map(|v| Vector3::from(v).norm());
        (point.name.as_str(), [error, size])
    });
    over_largest(sizes, least)
}

/// The largest error of each stress that is asked for, over the largest of it.
fn stresses(rows: &[RowCheck]) -> BTreeMap<String, f64> {
    let each = rows.iter().filter_map(|row| row.state.stress.as_ref());
    let sizes = each.flat_map(|stress| {
        let points = stress.points.iter().map(|point| (format!("stress at {}", point.name), [point.error, point.full]));
        points.chain(stress.body.map(|body| ("largest stress".to_owned(), [body.error, body.full])))
    });
    over_largest(sizes, 0.0)
}

fn over_largest<K: Ord>(sizes: impl Iterator<Item = (K, [f64; 2])>, least: f64) -> BTreeMap<K, f64> {
    let mut largest: BTreeMap<K, [f64; 2]> = BTreeMap::new();
    for (name, [error, size]) in sizes {
        let of = largest.entry(name).or_default();
        *of = [of[0].max(error), of[1].max(size)];
    }
    let ratio = |[error, size]: [f64; 2]| if error > 0.0 { error / size.max(least) } else { 0.0 };
    largest.into_iter().map(|(name, of)| (name, ratio(of))).collect()
}
