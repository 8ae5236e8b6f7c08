//! The quantities of a run: their units for people, and what of them is rounding.

use std::f64::consts::TAU;

use results::{BodyMetadata, Column, Dimension, History, Results, histories};

use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use crate::rows::units::UnitLabels;

/// Numbers of one unit that are less than such a part of the greatest come from rounding.
const OF_GREATEST: f64 = 1e-12;
/// Numbers that are less than such a part of what the whole body moving by its own length in its fastest mode would give.
const OF_BODY: f64 = 1e-15;

/// The quantities of a run.
pub(super) struct Quantities<'a> {
    results: &'a Results,
    /// Mass of each body, its length, and the angular frequency of its fastest mode; 0 without.
    bodies: Vec<[f64; 3]>,
}

impl<'a> Quantities<'a> {
    pub(super) fn new(results: &'a Results) -> Self {
        let diagonal = |size: &[f64; 3]| size.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
        let of_body = |body: &BodyMetadata| {
            let model = &body.model;
            let length = model.mesh.as_ref().map_or(0.0, |mesh| diagonal(&mesh.size));
            let natural = model.frequencies.len().saturating_sub(model.static_shapes);
            let fastest = model.frequencies.iter().copied().take(natural).fold(0.0, f64::max);
            [model.mass, length, TAU * fastest]
        };
        Self { results, bodies: results.metadata.bodies.iter().map(of_body).collect() }
    }

    /// The unit of a column: MPa in place of Mg/(mm s²). Empty for plain numbers.
    pub(super) fn unit(&self, column: &Column<Row>) -> String {
        let results::Units { length, mass, time } = &self.results.metadata.units;
        let units = UnitLabels { length, mass, time };
        match column.dimension {
            Dimension::Number => String::new(),
            Dimension::Force => units.force(),
            Dimension::Moment => units.moment(),
            Dimension::Momentum => units.momentum(),
            Dimension::AngularMomentum => units.angular_momentum(),
            Dimension::Stress => units.stress(),
            Dimension::Energy => units.energy(),
            Dimension::Power => units.power(),
            _ => column.unit(&self.results.metadata.units).replace("^2", "²"),
        }
    }

    /// How long the axis of a history is at least, so that rounding does not fill it.
    pub(super) fn least_range(&self, history: History<Row>) -> f64 {
        let dimension = history.column.dimension;
        let alike = histories(&COLUMNS, &self.results.metadata).filter(|other| {
            (other.body, other.joint) == (history.body, history.joint) && other.column.dimension == dimension
        });
        let greatest = alike.map(|other| self.greatest(other)).fold(0.0, f64::max);
        let bodies = match history.body {
            Some(body) => &self.bodies[body..=body],
            None => &self.bodies,
        };
        let of_body = bodies.iter().map(|body| of_body(dimension, body)).fold(0.0, f64::max);
        (OF_GREATEST * greatest).max(OF_BODY * of_body)
    }

    /// Greatest magnitude in all rows and places of a history.
    fn greatest(&self, history: History<Row>) -> f64 {
        let metadata = &self.results.metadata;
        let greatest_in = |place: Option<&str>| {
            let table = self.results.table(&history.path_of(metadata, place));
            let values = table.map_or(&[][..], |table| table.values());
            values.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()))
        };
        match history.is_of_places() {
            true => history.places(metadata).iter().map(|place| greatest_in(Some(place))).fold(0.0, f64::max),
            false => greatest_in(None),
        }
    }
}

/// Size of a quantity for a body that moves by its own length in its fastest mode. Energies are squares of what is rounded:
/// their rounding is that of the greatest alone.
fn of_body(dimension: Dimension, [mass, length, omega]: &[f64; 3]) -> f64 {
    match dimension {
        Dimension::Length => *length,
        Dimension::Velocity => length * omega,
        Dimension::Acceleration => length * omega * omega,
        Dimension::AngularVelocity => *omega,
        Dimension::AngularAcceleration => omega * omega,
        Dimension::Force => mass * length * omega * omega,
        Dimension::Moment => mass * length * length * omega * omega,
        Dimension::Momentum => mass * length * omega,
        Dimension::AngularMomentum => mass * length * length * omega,
        Dimension::Stress if *length > 0.0 => mass * omega * omega / length,
        _ => 0.0,
    }
}
