//! `flexframe frf`: frequency responses of a scene about rest or a steady spin, as a table and as charts.

mod page;
mod peaks;

use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

use diagnostic::{Diagnostic, Failure};
use faer::c64;
use figures::{LineChart, Scale};
use linear::{Damping, FrequencyResponse, SecondOrder};
use model::{BuildProgress, Builder};
use scene::System;
use serde::Serialize;

pub use peaks::Peak;
use peaks::peaks;

use crate::commands::linear::curves::{self, Answer};
use crate::commands::linear::frequencies::Frequencies;
use crate::commands::linear::linearize::{AtOnce, LinearSettings, linear_model};
use crate::commands::modes::frequency_unit;
use crate::files::json;

const NAME: &str = "frf";
/// The most frequencies.
const MAX_FREQUENCIES: usize = 1_000_000;

/// Settings of frequency responses.
#[derive(Debug, Clone, PartialEq)]
pub struct FrfSettings {
    /// The state that the equations are about.
    pub linear: LinearSettings,
    /// The frequencies.
    pub frequencies: Frequencies,
    /// True where frequencies are spaced by equal ratios.
    pub logarithmic: bool,
    /// Loss factor of structural damping in the place of the scene's damping.
    pub loss_factor: Option<f64>,
}

/// Report of `flexframe frf`.
#[derive(Debug, Clone, Serialize)]
pub struct FrfReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// Files.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
    /// The state that the responses are about, in words, with its damping.
    pub about: String,
    /// The highest response of each output to each input.
    pub peaks: Vec<Peak>,
    /// Rank of D, where outputs are as many as inputs.
    pub at_once: Option<AtOnce>,
    /// Reservations about the state.
    pub warnings: Vec<String>,
}

/// The files that [`frf`] writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    curves::files(folder, NAME)
}

/// Computes the responses of a scene, and writes `frf.csv`, the page `frf.html`, and `frf` as SVG, PDF and PNG to a folder.
///
/// # Errors
/// [`Failure`].
pub fn frf(
    system: &System,
    builder: &Builder,
    folder: &Path,
    settings: &FrfSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<FrfReport, Failure> {
    let frequencies = match settings.logarithmic {
        true => settings.frequencies.by_ratios(MAX_FREQUENCIES),
        false => settings.frequencies.evenly(MAX_FREQUENCIES),
    }?;
    let mut model = linear_model(system, builder, &settings.linear, progress)?;
    if let Some(loss_factor) = settings.loss_factor {
        model.state.damping = structural(loss_factor);
    }
    let equations = &model.equations;
    let response = equations.frequency_response(&frequencies, damping_of(settings.loss_factor));
    let response = response.map_err(|source| source.in_file(&system.path))?;

    let unit = frequency_unit(&system.units.time);
    let logarithmic = settings.logarithmic;
    let peaks = peaks(equations, &response);
    let answer = Answer {
        csv: csv(equations, &response),
        chart: chart(&system.title, &unit, equations, &response, logarithmic),
        page: page::page(&system.title, &unit, (&response, &peaks, &model.state), logarithmic),
    };
    Ok(FrfReport {
        title: system.title.clone(),
        frequency_unit: unit,
        files: curves::write(folder, NAME, answer)?,
        about: model.state.to_string(),
        peaks,
        at_once: AtOnce::of_equations(equations),
        warnings: model.state.warnings,
    })
}

/// Structural damping in words, in the place of the scene's.
pub(super) fn structural(loss_factor: f64) -> String {
    format!("structural damping, loss factor {loss_factor}")
}

/// The damping of the equations, or structural damping with a loss factor.
pub(super) fn damping_of(loss_factor: Option<f64>) -> Damping {
    loss_factor.map_or(Damping::OfEquations, Damping::Structural)
}

/// A row a frequency: magnitude and phase (degrees) of each output by each input.
fn csv(equations: &SecondOrder, response: &FrequencyResponse) -> String {
    let mut csv = "frequency".to_owned();
    for input in &equations.inputs {
        for output in &equations.outputs {
            // Writing to a String cannot fail.
            let _ = write!(csv, ",|{o}/{i}|,phase {o}/{i}", o = output.channel.name, i = input.name);
        }
    }
    csv.push('\n');
    for (frequency, values) in response.frequencies.iter().zip(&response.values) {
        let _ = write!(csv, "{frequency:e}");
        for value in values.col_iter().flat_map(|column| column.iter().copied().collect::<Vec<c64>>()) {
            let _ = write!(csv, ",{:e},{:.6}", value.norm(), value.im.atan2(value.re).to_degrees());
        }
        csv.push('\n');
    }
    csv
}

fn chart(
    title: &str,
    unit: &str,
    equations: &SecondOrder,
    response: &FrequencyResponse,
    logarithmic: bool,
) -> LineChart {
    let mut curves = Vec::new();
    for (j, input) in equations.inputs.iter().enumerate() {
        for (i, output) in equations.outputs.iter().enumerate() {
            let points: Vec<(f64, f64)> =
                response.frequencies.iter().copied().zip(response.values.iter().map(|h| h[(i, j)].norm())).collect();
            curves.push((format!("{} / {}", output.channel.name, input.name), points));
        }
    }
    let (y_scale, series) = curves::with_positive(curves);
    LineChart {
        title: format!("{title}: frequency response"),
        x_label: format!("Frequency ({unit})"),
        y_label: "Magnitude".to_owned(),
        x_scale: if logarithmic { Scale::Log } else { Scale::Linear },
        y_scale,
        series,
        reference: None,
    }
}

impl fmt::Display for FrfReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  about    {}", self.about)?;
        write!(f, "  highest responses")?;
        for Peak { output, unit, input, magnitude, frequency } in &self.peaks {
            write!(
                f,
                "\n  {output:<28} by {input:<20} {magnitude:.6e} {unit} at {frequency:.6} {}",
                self.frequency_unit
            )?;
        }
        if let Some(words) = self.at_once.as_ref().and_then(AtOnce::in_words) {
            write!(f, "\n  D        {words}")?;
        }
        for file in &self.files {
            write!(f, "\n  wrote    {}", file.display())?;
        }
        for warning in &self.warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}
