//! The page of frequency responses: magnitude and phase.

use faer::c64;
use linear::{FrequencyResponse, SecondOrder};
use report::{Chart, Curve, Responses};

use crate::commands::linear::curves::{fact, program};
use crate::commands::linear::linearize::State;

/// The page of all responses.
pub(super) fn page(
    title: &str,
    frequency_unit: &str,
    (equations, response, state): (&SecondOrder, &FrequencyResponse, &State),
    (loss_factor, logarithmic): (Option<f64>, bool),
) -> Responses {
    let mut curves = Vec::new();
    for (j, input) in equations.inputs.iter().enumerate() {
        for (i, output) in equations.outputs.iter().enumerate() {
            let values: Vec<c64> = response.values.iter().map(|h| h[(i, j)]).collect();
            let magnitude: Vec<f64> = values.iter().map(|value| value.norm()).collect();
            let phase = values.iter().map(|value| value.im.atan2(value.re).to_degrees()).collect();
            let of = response.frequencies.iter().zip(&magnitude);
            let (at, highest) = of.fold((0.0, 0.0), |best, (f, h)| if *h > best.1 { (*f, *h) } else { best });
            curves.push(Curve {
                name: format!("{} / {}", output.channel.name, input.name),
                units: vec![format!("{} per {}", output.channel.unit, input.unit), "°".to_owned()],
                values: vec![magnitude, phase],
                about: vec![format!("{highest:.4e} at {at:.6} {frequency_unit}")],
            });
        }
    }
    let damping = loss_factor.map_or_else(|| "of the scene".to_owned(), |g| format!("structural, loss factor {g}"));
    let count = response.frequencies.len();
    Responses {
        title: format!("{title}: frequency response"),
        program: program(),
        facts: vec![fact("About", state.to_string()), fact("Frequencies", count.to_string()), fact("Damping", damping)],
        warnings: state.warnings.clone(),
        frequency_unit: frequency_unit.to_owned(),
        logarithmic,
        frequencies: response.frequencies.clone(),
        charts: vec![
            Chart { name: "Magnitude".to_owned(), logarithmic: true },
            Chart { name: "Phase, degrees".to_owned(), logarithmic: false },
        ],
        headings: vec!["Highest".to_owned()],
        curves,
    }
}
