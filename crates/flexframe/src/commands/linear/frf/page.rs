//! The page of frequency responses: magnitude and phase.

use faer::c64;
use linear::FrequencyResponse;
use report::{Chart, Curve, Fact, Responses};

use super::peaks::Peak;
use crate::commands::linear::curves::program;
use crate::commands::linear::linearize::State;

/// The page of all responses.
pub(super) fn page(
    title: &str,
    frequency_unit: &str,
    (response, peaks, state): (&FrequencyResponse, &[Peak], &State),
    logarithmic: bool,
) -> Responses {
    let (rows, columns) = response.values.first().map_or((0, 0), |h| (h.nrows(), h.ncols()));
    let places = (0..columns).flat_map(|j| (0..rows).map(move |i| (i, j)));
    let curve = |((i, j), peak): ((usize, usize), &Peak)| {
        let values: Vec<c64> = response.values.iter().map(|h| h[(i, j)]).collect();
        let magnitude = values.iter().map(|value| value.norm()).collect();
        let phase = values.iter().map(|value| value.im.atan2(value.re).to_degrees()).collect();
        Curve {
            name: format!("{} / {}", peak.output, peak.input),
            units: vec![peak.unit.clone(), "°".to_owned()],
            values: vec![magnitude, phase],
            about: vec![format!("{:.4e} at {:.6} {frequency_unit}", peak.magnitude, peak.frequency)],
        }
    };
    let count = response.frequencies.len();
    Responses {
        title: format!("{title}: frequency response"),
        program: program(),
        facts: vec![Fact::new("About", state.to_string()), Fact::new("Frequencies", count.to_string())],
        warnings: state.warnings.clone(),
        frequency_unit: frequency_unit.to_owned(),
        logarithmic,
        frequencies: response.frequencies.clone(),
        charts: vec![
            Chart { name: "Magnitude".to_owned(), logarithmic: true },
            Chart { name: "Phase, degrees".to_owned(), logarithmic: false },
        ],
        headings: vec!["Highest".to_owned()],
        curves: places.zip(peaks).map(curve).collect(),
    }
}
