//! Densities as a table for programs, as a chart and as a page.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::{LineChart, Scale};
use report::Responses as Page;

use super::responses::Responses;
use crate::commands::linear::curves::{self, Answer};
use crate::commands::modes::frequency_unit;

const NAME: &str = "psd";

/// The files that [`psd`](super::psd) writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    curves::files(folder, NAME)
}

pub(super) fn write(
    title: &str,
    time_unit: &str,
    responses: &Responses,
    page: Page,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let chart = chart(title, &frequency_unit(time_unit), responses);
    curves::write(folder, NAME, Answer { csv: csv(responses), chart, page })
}

/// A row a frequency: the density of each output, unit² per cycle per time.
fn csv(responses: &Responses) -> String {
    let mut csv = "frequency".to_owned();
    for (channel, _) in &responses.outputs {
        // Writing to a String cannot fail.
        let _ = write!(csv, ",{}", channel.name);
    }
    csv.push('\n');
    for (k, frequency) in responses.frequencies.iter().enumerate() {
        let _ = write!(csv, "{frequency:e}");
        for (_, response) in &responses.outputs {
            let _ = write!(csv, ",{:e}", response.density[k]);
        }
        csv.push('\n');
    }
    csv
}

fn chart(title: &str, unit: &str, responses: &Responses) -> LineChart {
    let curves = responses.outputs.iter().map(|(channel, response)| {
        let points = responses.frequencies.iter().copied().zip(response.density.iter().copied());
        (channel.name.clone(), points.collect())
    });
    let (y_scale, series) = curves::with_positive(curves.collect());
    LineChart {
        title: format!("{title}: power spectral density"),
        x_label: format!("Frequency ({unit})"),
        y_label: format!("Unit² per {unit}"),
        x_scale: Scale::Log,
        y_scale,
        series,
        reference: None,
    }
}
