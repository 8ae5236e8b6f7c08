//! The page of random responses: densities, and the root mean square that has come together up to each frequency.

use linear::{Channel, RandomResponse};
use report::{Chart, Curve, Fact, Responses as Page};
use scene::Shared;

use super::report::PsdReport;
use super::responses::Responses;
use crate::commands::linear::curves::program;
use crate::commands::linear::linearize::State;
use crate::commands::modes::frequency_unit;

/// The page of all outputs.
pub(super) fn page(scene: &Shared, state: &State, report: &PsdReport, responses: &Responses, weights: &[f64]) -> Page {
    let unit = frequency_unit(&scene.units.time);
    let curve = |(channel, response): &(Channel, RandomResponse)| {
        let mut square = 0.0;
        let cumulated = response.density.iter().zip(weights).map(|(density, weight)| {
            square += density * weight;
            f64::sqrt(square)
        });
        Curve {
            name: channel.name.clone(),
            units: vec![format!("({})²/{unit}", channel.unit), channel.unit.clone()],
            values: vec![response.density.clone(), cumulated.collect()],
            about: vec![format!("{:.4e} {}", response.rms, channel.unit)],
        }
    };
    let [low, high] = report.band;
    Page {
        title: format!("{}: random response", scene.title),
        program: program(),
        facts: vec![
            Fact::new("About", state.to_string()),
            Fact::new("Band", format!("{low} to {high} {unit}")),
            Fact::new("Inputs", report.inputs.join(", ")),
            Fact::new("Frequencies", responses.frequencies.len().to_string()),
        ],
        warnings: state.warnings.clone(),
        frequency_unit: unit.clone(),
        logarithmic: true,
        frequencies: responses.frequencies.clone(),
        charts: vec![
            Chart { name: "Power spectral density".to_owned(), logarithmic: true },
            Chart { name: "Cumulated rms".to_owned(), logarithmic: false },
        ],
        headings: vec!["rms".to_owned()],
        curves: responses.outputs.iter().map(curve).collect(),
    }
}
