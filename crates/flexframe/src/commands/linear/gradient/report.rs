//! Report of rates.

use std::iter::once;

use nalgebra::Vector3;
use report::{Form, Report, Table};
use scene::Scene;

use super::found::{Found, RatesOfNumber};
use super::number::Number;
use super::responses::{AXES, ResponseReport};
use crate::commands::modes::frequency_unit;

/// A relative rate below which it is rounding.
const NOTHING: f64 = 5e-7;

/// Numbers of a scene with what follows them.
pub(super) struct Rates {
    numbers: Vec<WithRates>,
    found: Found,
    /// Cycles per time; empty where none were asked for.
    response_frequencies: Vec<f64>,
}

/// A number with its rates.
struct WithRates {
    /// The path of its key, or `thickness.GROUP.AXIS`.
    name: String,
    value: f64,
    /// d ln f / d ln p.
    relative: Vec<f64>,
    rates: RatesOfNumber,
}

impl Rates {
    pub fn new(scene: &Scene, numbers: &[Number], mut found: Found, response_frequencies: Vec<f64>) -> Self {
        let rates = std::mem::take(&mut found.rates);
        let with_rates = |(number, rates): (&Number, RatesOfNumber)| {
            let value = number.value(scene);
            let of_frequencies = rates.frequencies.iter().zip(&found.frequencies);
            let relative = of_frequencies.map(|(rate, f)| value * rate / f).collect();
            WithRates { name: number.name.clone(), value, relative, rates }
        };
        Self { numbers: numbers.iter().zip(rates).map(with_rates).collect(), found, response_frequencies }
    }

    /// The report of a scene.
    pub fn report(self, scene: &Scene) -> Report {
        let mut report = Report::new(&scene.title);
        let unit = frequency_unit(&scene.units.time);
        let of = &self.numbers;
        let Found { frequencies, effective_masses, responses, .. } = &self.found;
        let repeated: Vec<[usize; 2]> = self.found.repeated.iter().map(|group| [group.start + 1, group.end]).collect();
        report.put("frequency_unit", &unit);
        report.put("frequencies", &frequencies[..]);
        report.put("repeated", &repeated[..]);
        report.put("effective_masses", &effective_masses[..]);
        report.put("response_frequencies", &self.response_frequencies[..]);
        report.table(
            Table::new("parameters", "parameters")
                .all()
                .text_only("", Form::Plain, (1..=of.len()).map(|k| format!("[{k}]")))
                .shown("name", "parameter", Form::Plain, of.iter().map(|of| &of.name))
                .shown("value", "value", Form::Plain, of.iter().map(|of| of.value))
                .column("frequencies", of.iter().map(|of| &of.rates.frequencies[..]))
                .column("relative", of.iter().map(|of| &of.relative[..]))
                .column("effective_masses", of.iter().map(|of| &of.rates.effective_masses[..]))
                .column("statics", of.iter().map(|of| &of.rates.statics[..]))
                .column("responses", of.iter().map(|of| &of.rates.responses[..])),
        );
        let count = frequencies.len();
        let table = Table::new("", None)
            .titled("relative rates d ln f / d ln p: percent of a frequency for one percent of a parameter")
            .text_only("mode", Form::Plain, 1..=count)
            .text_only(format!("frequency, {unit}"), Form::Fixed(6), frequencies.iter().copied());
        report.table(self.with_rates(table, |of| of.relative.iter().map(|rate| Some(*rate)).collect()));
        for [first, last] in &repeated {
            report.words(format!(
                "  modes {first} to {last} have one frequency: the rates are those of the modes that a parameter parts"
            ));
        }
        self.put_statics(&mut report);
        let each = || responses.iter();
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
    fn with_rates(&self, table: Table, rates: impl Fn(&WithRates) -> Vec<Option<f64>>) -> Table {
        let told = |rate: Option<f64>| rate.map(|rate| if rate.abs() < NOTHING { 0.0 } else { rate });
        self.numbers.iter().zip(1..).fold(table, |table, (of, k)| {
            table.text_only(format!("[{k}]"), Form::Fixed(6), rates(of).into_iter().map(told))
        })
    }

    fn put_statics(&self, report: &mut Report) {
        let each = || self.found.statics.iter();
        report.table(
            Table::new("statics", "statics")
                .column("load", each().map(|of| &of.load))
                .column("point", each().map(|of| &of.point))
                .column("displacement", each().map(|of| of.displacement)),
        );
        let moved: Vec<(usize, Vector3<f64>)> =
            each().map(|of| Vector3::from(of.displacement)).enumerate().filter(|(_, u)| u.norm() > 0.0).collect();
        let named = |(k, _): &(usize, _)| format!("{}, {}", self.found.statics[*k].load, self.found.statics[*k].point);
        let table = Table::new("", None)
            .titled("relative rates of static displacements, along the displacement")
            .all()
            .text_only("load, point", Form::Plain, moved.iter().map(named))
            .text_only("displacement", Form::Plain, moved.iter().map(|(_, u)| u.norm()));
        report.table(self.with_rates(table, |of| {
            let along = |(k, u): &(usize, Vector3<f64>)| {
                let rate = of.rates.statics.get(*k).copied().flatten()?;
                Some(of.value * u.dot(&Vector3::from(rate)) / u.norm_squared())
            };
            moved.iter().map(along).collect()
        }));
    }

    /// A row for each number and parameter.
    fn rows(&self) -> Table {
        let mut rows: Vec<(String, f64, &WithRates, f64)> = Vec::new();
        for of in &self.numbers {
            for (k, (value, rate)) in self.found.frequencies.iter().zip(&of.rates.frequencies).enumerate() {
                rows.push((format!("frequency.{}", k + 1), *value, of, *rate));
            }
            for (k, (values, rates)) in self.found.effective_masses.iter().zip(&of.rates.effective_masses).enumerate() {
                for (axis, name) in AXES.iter().enumerate() {
                    rows.push((format!("effective_mass.{name}.{}", k + 1), values[axis], of, rates[axis]));
                }
            }
            for (answer, rates) in self.found.statics.iter().zip(&of.rates.statics) {
                let Some(rates) = rates else { continue };
                for (axis, name) in AXES.iter().enumerate() {
                    let quantity = format!("displacement.{}.{}.{name}", answer.load, answer.point);
                    rows.push((quantity, answer.displacement[axis], of, rates[axis]));
                }
            }
        }
        let relative = |(_, value, of, rate): &(String, f64, &WithRates, f64)| {
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
        for (i, ResponseReport { input, output, values }) in self.found.responses.iter().enumerate() {
            let name = format!("{output}/{input}");
            let rates = self.numbers.iter().filter_map(|of| {
                let rates = of.rates.responses.get(i)?.as_deref()?;
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
