//! Rates as a table for programs.

use std::fmt::Write;

use super::report::GradientReport;

/// Axes.
const AXES: [&str; 3] = ["x", "y", "z"];

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
                field(&quantity),
                field(&parameter.name),
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

/// A field of a CSV file, in quotes where it needs them.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
