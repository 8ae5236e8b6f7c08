//! The quantities of a run: their units for people, and what of them is rounding.

use std::f64::consts::TAU;

use results::{Column, Results};

use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use crate::rows::units::UnitLabels;

/// Numbers of one unit that are less than such a part of the greatest come from rounding.
const OF_GREATEST: f64 = 1e-12;
/// Numbers that are less than such a part of what the whole body moving by its own length in its fastest mode would give.
const OF_BODY: f64 = 1e-15;

/// Dimensions of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dimension {
    Length,
    Velocity,
    Acceleration,
    AngularVelocity,
    AngularAcceleration,
    Force,
    Moment,
    Momentum,
    AngularMomentum,
    Stress,
    Energy,
    Power,
    /// Angles, plain numbers, and what no unit of SI has a name for.
    Other,
}

impl Dimension {
    fn of(column: &Column<Row>) -> Self {
        let has = |word: &str| column.path.contains(word);
        match column.unit {
            "length" => Self::Length,
            "length/time" => Self::Velocity,
            "length/time^2" => Self::Acceleration,
            "rad/time" => Self::AngularVelocity,
            "rad/time^2" => Self::AngularAcceleration,
            "mass length/time^2" => Self::Force,
            "mass length^2/time^2" if has("moment") || has("torque") => Self::Moment,
            "mass length^2/time^2" => Self::Energy,
            "mass length/time" => Self::Momentum,
            "mass length^2/time" => Self::AngularMomentum,
            "mass/(length time^2)" => Self::Stress,
            "mass length^2/time^3" => Self::Power,
            _ => Self::Other,
        }
    }
}

/// The quantities of a run.
pub(super) struct Quantities<'a> {
    results: &'a Results,
    /// Mass of the body, its length, and the angular frequency of its fastest mode; 0 without.
    body: [f64; 3],
}

impl<'a> Quantities<'a> {
    pub(super) fn new(results: &'a Results) -> Self {
        let body = &results.metadata.body;
        let diagonal = |size: &[f64; 3]| size.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
        let length = body.mesh.as_ref().map_or(0.0, |mesh| diagonal(&mesh.size));
        let natural = body.frequencies.len().saturating_sub(body.static_shapes);
        let fastest = body.frequencies.iter().copied().take(natural).fold(0.0, f64::max);
        Self { results, body: [body.mass, length, TAU * fastest] }
    }

    /// The unit of a column: MPa in place of Mg/(mm s²). Empty for plain numbers.
    pub(super) fn unit(&self, column: &Column<Row>) -> String {
        let results::Units { length, mass, time } = &self.results.metadata.units;
        let units = UnitLabels { length, mass, time };
        match Dimension::of(column) {
            Dimension::Force => units.force(),
            Dimension::Moment => units.moment(),
            Dimension::Momentum => units.momentum(),
            Dimension::AngularMomentum => units.angular_momentum(),
            Dimension::Stress => units.stress(),
            Dimension::Energy => units.energy(),
            Dimension::Power => units.power(),
            _ if column.unit == "1" => String::new(),
            _ => column.unit(&self.results.metadata.units).replace("^2", "²"),
        }
    }

    /// How long the axis of a column is at least, so that rounding does not fill it.
    pub(super) fn least_range(&self, column: &Column<Row>) -> f64 {
        let dimension = Dimension::of(column);
        let is_alike = |other: &&Column<Row>| match dimension {
            Dimension::Other => other.unit == column.unit,
            _ => Dimension::of(other) == dimension,
        };
        let alike = COLUMNS.iter().filter(is_alike);
        let greatest = alike.map(|other| self.greatest(other)).fold(0.0, f64::max);
        (OF_GREATEST * greatest).max(OF_BODY * self.of_body(dimension))
    }

    /// Greatest magnitude in all rows and places of a column.
    fn greatest(&self, column: &Column<Row>) -> f64 {
        let Some((group, name)) = column.path.split_once('/') else { return self.greatest_in(column.path) };
        let places = column.places(&self.results.metadata);
        if places.is_empty() {
            return self.greatest_in(column.path);
        }
        places.iter().map(|place| self.greatest_in(&format!("{group}/{place}/{name}"))).fold(0.0, f64::max)
    }

    fn greatest_in(&self, path: &str) -> f64 {
        let Some(table) = self.results.table(path) else { return 0.0 };
        let values = (0..table.width()).filter_map(|k| table.column(k)).flatten();
        values.fold(0.0, |greatest, value| greatest.max(value.abs()))
    }

    /// Size of a quantity for a body that moves by its own length in its fastest mode. Energies are squares of what is
    /// rounded: their
    /// rounding is that of the greatest alone.
    fn of_body(&self, dimension: Dimension) -> f64 {
        let [mass, length, omega] = self.body;
        match dimension {
            Dimension::Length => length,
            Dimension::Velocity => length * omega,
            Dimension::Acceleration => length * omega * omega,
            Dimension::AngularVelocity => omega,
            Dimension::AngularAcceleration => omega * omega,
            Dimension::Force => mass * length * omega * omega,
            Dimension::Moment => mass * length * length * omega * omega,
            Dimension::Momentum => mass * length * omega,
            Dimension::AngularMomentum => mass * length * length * omega,
            Dimension::Stress if length > 0.0 => mass * omega * omega / length,
            Dimension::Stress | Dimension::Energy | Dimension::Power | Dimension::Other => 0.0,
        }
    }
}
