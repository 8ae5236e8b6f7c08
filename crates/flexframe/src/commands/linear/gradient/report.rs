//! Report of rates.

use std::iter::once;

use model::{BodyRates, Parameter, ParameterRates, VariedBody};
use nalgebra::Vector3;
use report::{Form, Report, Table};
use scene::{Scene, Shared};

use super::number::Number;
use super::responses::{self, AXES, ResponseReport};
use super::system::SystemRates;
use crate::commands::modes::frequency_unit;

/// A relative rate below which it is rounding.
const NOTHING: f64 = 5e-7;

/// Frequencies, effective masses, static displacements and responses, with their rates.
pub(super) struct Rates {
    /// Cycles per time.
    pub frequencies: Vec<f64>,
    /// Numbers, from 1, of the first and the last mode of each group of one frequency.
    pub repeated: Vec<[usize; 2]>,
    /// For each mode, in translations of the base along the axes of the mesh; the mean of modes of one frequency.
    pub effective_masses: Vec<[f64; 3]>,
    /// Empty of a body that is not held, and without loads or points of the output.
    pub statics: Vec<Static>,
    /// Cycles per time; empty where none were asked for.
    pub response_frequencies: Vec<f64>,
    /// Responses of the points to the loads.
    pub responses: Vec<ResponseReport>,
    pub parameters: Vec<OfParameter>,
}

/// The static displacement of a point under a load where its history is 1.
pub(super) struct Static {
    load: String,
    point: String,
    /// Axes of the mesh.
    displacement: [f64; 3],
}

/// Rates with a parameter: by its unit.
pub(super) struct OfParameter {
    /// The path of its key, or `thickness.GROUP.AXIS`.
    name: String,
    value: f64,
    /// For each mode; where modes have one frequency, for the modes that the parameter parts, in rising order.
    frequencies: Vec<f64>,
    /// d ln f / d ln p.
    relative: Vec<f64>,
    effective_masses: Vec<[f64; 3]>,
    /// None of a load whose forces change with the shape.
    statics: Vec<Option<[f64; 3]>>,
    /// Real and imaginary part at each frequency; none as of static displacements.
    responses: Vec<Option<Vec<[f64; 2]>>>,
}

impl Rates {
    pub fn new(body: &VariedBody, parameters: &[Parameter], found: &BodyRates, response_frequencies: Vec<f64>) -> Self {
        let given = body.scene();
        let (loads, damping) = (body.load_names(), &given.modes.damping);
        let points: Vec<String> = given.output.points.keys().cloned().collect();
        let of_parameter = |(parameter, rates): (&Parameter, &ParameterRates)| {
            let value = parameter.value(body.body());
            let of_statics = rates.statics.iter().flatten().flat_map(|of_load| match of_load {
                Some(of_points) => of_points.iter().map(|rate| Some((*rate).into())).collect(),
                None => vec![None; points.len()],
            });
            let of_frequencies = rates.frequencies.iter().zip(&found.frequencies);
            OfParameter {
                name: parameter.name.clone(),
                value,
                frequencies: rates.frequencies.clone(),
                relative: of_frequencies.map(|(rate, f)| value * rate / f).collect(),
                effective_masses: rates.effective_masses.clone().unwrap_or_default(),
                statics: of_statics.collect(),
                responses: if response_frequencies.is_empty() {
                    Vec::new()
                } else {
                    responses::rates(found, rates, points.len(), damping, &response_frequencies)
                },
            }
        };
        let of_load = |(load, of_points): (&String, &Vec<Vector3<f64>>)| {
            let of_point = |(point, u): (&String, &Vector3<f64>)| Static {
                load: load.clone(),
                point: point.clone(),
                displacement: (*u).into(),
            };
            points.iter().zip(of_points).map(of_point).collect::<Vec<_>>()
        };
        Self {
            frequencies: found.frequencies.clone(),
            repeated: found.repeated.iter().map(|group| [group.start + 1, group.end]).collect(),
            effective_masses: found.effective_masses.clone().unwrap_or_default(),
            statics: loads.iter().zip(found.statics.iter().flatten()).flat_map(of_load).collect(),
            responses: if response_frequencies.is_empty() {
                Vec::new()
            } else {
                responses::responses(found, [&loads, &points], damping, &response_frequencies)
            },
            parameters: parameters.iter().zip(&found.rates).map(of_parameter).collect(),
            response_frequencies,
        }
    }

    /// Rates of the frequencies and responses of bodies in joints.
    pub fn of_system(scene: &Scene, parameters: &[Number], found: SystemRates, response_frequencies: Vec<f64>) -> Self {
        let SystemRates { frequencies, repeated, rates, responses } = found;
        let of_parameter = |((parameter, rates), of_responses): ((&Number, Vec<f64>), Vec<_>)| {
            let value = parameter.value(scene);
            OfParameter {
                name: parameter.name.clone(),
                value,
                relative: rates.iter().zip(&frequencies).map(|(rate, f)| value * rate / f).collect(),
                frequencies: rates,
                effective_masses: Vec::new(),
                statics: Vec::new(),
                responses: of_responses,
            }
        };
        Self {
            repeated: repeated.into_iter().map(|group| [group.start + 1, group.end]).collect(),
            effective_masses: Vec::new(),
            statics: Vec::new(),
            responses: responses.responses,
            response_frequencies,
            parameters: parameters.iter().zip(rates).zip(responses.rates).map(of_parameter).collect(),
            frequencies,
        }
    }
}

impl Rates {
    /// The report of a scene.
    pub fn report(self, scene: &Shared) -> Report {
        let mut report = Report::new(&scene.title);
        let unit = frequency_unit(&scene.units.time);
        let of = &self.parameters;
        report.put("frequency_unit", &unit);
        report.put("frequencies", &self.frequencies[..]);
        report.put("repeated", &self.repeated[..]);
        report.put("effective_masses", &self.effective_masses[..]);
        report.put("response_frequencies", &self.response_frequencies[..]);
        report.table(
            Table::new("parameters", "parameters")
                .all()
                .text_only("", Form::Plain, (1..=of.len()).map(|k| format!("[{k}]")))
                .shown("name", "parameter", Form::Plain, of.iter().map(|of| &of.name))
                .shown("value", "value", Form::Plain, of.iter().map(|of| of.value))
                .column("frequencies", of.iter().map(|of| &of.frequencies[..]))
                .column("relative", of.iter().map(|of| &of.relative[..]))
                .column("effective_masses", of.iter().map(|of| &of.effective_masses[..]))
                .column("statics", of.iter().map(|of| &of.statics[..]))
                .column("responses", of.iter().map(|of| &of.responses[..])),
        );
        let count = self.frequencies.len();
        let table = Table::new("", None)
            .titled("relative rates d ln f / d ln p: percent of a frequency for one percent of a parameter")
            .text_only("mode", Form::Plain, 1..=count)
            .text_only(format!("frequency, {unit}"), Form::Fixed(6), self.frequencies.iter().copied());
        report.table(self.with_rates(table, |of| of.relative.iter().map(|rate| Some(*rate)).collect()));
        for [first, last] in &self.repeated {
            report.words(format!(
                "  modes {first} to {last} have one frequency: the rates are those of the modes that a parameter parts"
            ));
        }
        self.put_statics(&mut report);
        let each = || self.responses.iter();
        report.table(
            Table::new("responses", "responses")
                .column("input", each().map(|of| &of.input))
                .column("output", each().map(|of| &of.output))
                .column("values", each().map(|of| &of.values[..])),
        );
        report.csv_tables.extend([self.rows(), self.response_rows()]);
        report
    }

    /// A table with a column for the relative rates of each parameter.
    fn with_rates(&self, table: Table, rates: impl Fn(&OfParameter) -> Vec<Option<f64>>) -> Table {
        let told = |rate: Option<f64>| rate.map(|rate| if rate.abs() < NOTHING { 0.0 } else { rate });
        self.parameters.iter().zip(1..).fold(table, |table, (of, k)| {
            table.text_only(format!("[{k}]"), Form::Fixed(6), rates(of).into_iter().map(told))
        })
    }

    fn put_statics(&self, report: &mut Report) {
        let each = || self.statics.iter();
        report.table(
            Table::new("statics", "statics")
                .column("load", each().map(|of| &of.load))
                .column("point", each().map(|of| &of.point))
                .column("displacement", each().map(|of| of.displacement)),
        );
        let moved: Vec<(usize, Vector3<f64>)> =
            each().map(|of| Vector3::from(of.displacement)).enumerate().filter(|(_, u)| u.norm() > 0.0).collect();
        let named = |(k, _): &(usize, _)| format!("{}, {}", self.statics[*k].load, self.statics[*k].point);
        let table = Table::new("", None)
            .titled("relative rates of static displacements, along the displacement")
            .all()
            .text_only("load, point", Form::Plain, moved.iter().map(named))
            .text_only("displacement", Form::Plain, moved.iter().map(|(_, u)| u.norm()));
        report.table(self.with_rates(table, |of| {
            let along = |(k, u): &(usize, Vector3<f64>)| {
                let rate = of.statics.get(*k).copied().flatten()?;
                Some(of.value * u.dot(&Vector3::from(rate)) / u.norm_squared())
            };
            moved.iter().map(along).collect()
        }));
    }

    /// A row for each number and parameter.
    fn rows(&self) -> Table {
        let mut rows: Vec<(String, f64, &OfParameter, f64)> = Vec::new();
        for of in &self.parameters {
            for (k, (value, rate)) in self.frequencies.iter().zip(&of.frequencies).enumerate() {
                rows.push((format!("frequency.{}", k + 1), *value, of, *rate));
            }
            for (k, (values, rates)) in self.effective_masses.iter().zip(&of.effective_masses).enumerate() {
                for (axis, name) in AXES.iter().enumerate() {
                    rows.push((format!("effective_mass.{name}.{}", k + 1), values[axis], of, rates[axis]));
                }
            }
            for (answer, rates) in self.statics.iter().zip(&of.statics) {
                let Some(rates) = rates else { continue };
                for (axis, name) in AXES.iter().enumerate() {
                    let quantity = format!("displacement.{}.{}.{name}", answer.load, answer.point);
                    rows.push((quantity, answer.displacement[axis], of, rates[axis]));
                }
            }
        }
        let relative = |(_, value, of, rate): &(String, f64, &OfParameter, f64)| {
            Some(of.value * rate / value).filter(|_| *value != 0.0)
        };
        Table::new("gradient", None)
            .column("quantity", rows.iter().map(|row| &row.0))
            .column("value", rows.iter().map(|row| row.1))
            .column("parameter", rows.iter().map(|row| &row.2.name))
            .column("parameter_value", rows.iter().map(|row| row.2.value))
            .column("rate", rows.iter().map(|row| row.3))
            .column("relative_rate", rows.iter().map(relative))
    }

    /// A row for each frequency: real and imaginary parts of the responses, then of their rates with each parameter.
    fn response_rows(&self) -> Table {
        let mut table = Table::new("gradient_frf", None).column("frequency", self.response_frequencies.iter().copied());
        for (i, ResponseReport { input, output, values }) in self.responses.iter().enumerate() {
            let name = format!("{output}/{input}");
            let rates = self.parameters.iter().filter_map(|of| {
                let rates = of.responses.get(i)?.as_deref()?;
                Some((format!("d {name} / d {}", of.name), rates))
            });
            for (name, values) in once((name.clone(), &values[..])).chain(rates) {
                table = table.column(format!("re {name}"), values.iter().map(|[re, _]| *re));
                table = table.column(format!("im {name}"), values.iter().map(|[_, im]| *im));
            }
        }
        table
    }
}
