//! The highest responses.

use linear::{FrequencyResponse, SecondOrder};
use serde::Serialize;

/// The highest response of an output to an input.
#[derive(Debug, Clone, Serialize)]
pub struct Peak {
    /// The output.
    pub output: String,
    /// Its unit, by that of the input.
    pub unit: String,
    /// The input.
    pub input: String,
    /// Magnitude.
    pub magnitude: f64,
    /// Cycles per time.
    pub frequency: f64,
}

/// The highest response of each output to each input, input by input.
pub(super) fn peaks(equations: &SecondOrder, response: &FrequencyResponse) -> Vec<Peak> {
    let mut peaks = Vec::new();
    for (j, input) in equations.inputs.iter().enumerate() {
        for (i, output) in equations.outputs.iter().enumerate() {
            let all = response.frequencies.iter().zip(&response.values).map(|(f, values)| (*f, values[(i, j)].norm()));
            let (frequency, magnitude) = all.fold((0.0, 0.0), |best, at| if at.1 > best.1 { at } else { best });
            let unit = format!("{} per {}", output.channel.unit, input.unit);
            let (output, input) = (output.channel.name.clone(), input.name.clone());
            peaks.push(Peak { output, unit, input, magnitude, frequency });
        }
    }
    peaks
}
