//! Rates as a table for programs.

use std::fmt::Write;

use super::report::GradientReport;
use super::responses::AXES;
use crate::files::csv::quoted;

/// A row for each number and parameter.
pub(super) fn rows(report: &GradientReport) -> String {
    let mut csv = "quantity,value,parameter,parameter_value,rate,relative_rate\n".to_owned();
    for parameter in &report.parameters {
        let mut row = |quantity: String, value: f64, rate: f64| {
            let relative = if value == 0.0 { String::new() } else { format!("{:e}", parameter.value * rate / value) };
            // Writing to a String cannot fail.
            let _ = writeln!(
                csv,
                "{},{value:e},{},{:e},{rate:e},{relative}",
                quoted(&quantity),
                quoted(&parameter.name),
                parameter.value
            );
        };
        for (k, (value, rate)) in report.frequencies.iter().zip(&parameter.frequencies).enumerate() {
            row(format!("frequency.{}", k + 1), *value, *rate);
        }
        for (k, (values, rates)) in report.effective_masses.iter().zip(&parameter.effective_masses).enumerate() {
            for (axis, name) in AXES.iter().enumerate() {
                row(format!("effective_mass.{name}.{}", k + 1), values[axis], rates[axis]);
            }
        }
        for (answer, rates) in report.statics.iter().zip(&parameter.statics) {
            let Some(rates) = rates else { continue };
            for (axis, name) in AXES.iter().enumerate() {
                let quantity = format!("displacement.{}.{}.{name}", answer.load, answer.point);
                row(quantity, answer.displacement[axis], rates[axis]);
            }
        }
    }
    csv
}

/// A row for each frequency: real and imaginary parts of the responses, then of their rates with each parameter.
pub(super) fn responses(report: &GradientReport) -> String {
    let mut heads = vec!["frequency".to_owned()];
    let mut columns: Vec<&[[f64; 2]]> = Vec::new();
    for (i, response) in report.responses.iter().enumerate() {
        let name = format!("{}/{}", response.output, response.input);
        let rates = report.parameters.iter().filter_map(|parameter| {
            let rates = parameter.responses.get(i)?.as_deref()?;
            Some((format!("d {name} / d {}", parameter.name), rates))
        });
        for (name, values) in std::iter::once((name.clone(), &response.values[..])).chain(rates) {
            heads.extend([quoted(&format!("re {name}")), quoted(&format!("im {name}"))]);
            columns.push(values);
        }
    }
    let mut csv = heads.join(",");
    csv.push('\n');
    for (row, frequency) in report.response_frequencies.iter().enumerate() {
        let _ = write!(csv, "{frequency:e}");
        for [re, im] in columns.iter().map(|values| values[row]) {
            let _ = write!(csv, ",{re:e},{im:e}");
        }
        csv.push('\n');
    }
    csv
}
