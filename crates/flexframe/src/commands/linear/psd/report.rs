//! Report of random responses.

use std::fmt;
use std::path::PathBuf;

use linear::RandomResponse;
use scene::Shared;
use serde::Serialize;

use super::responses::Responses;
use crate::commands::linear::linearize::LinearModel;
use crate::commands::modes::frequency_unit;
use crate::files::json;

/// Levels, in root mean squares, whose crossings are counted.
const LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// Report of `flexframe psd`.
#[derive(Debug, Clone, Serialize)]
pub struct PsdReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// Lowest and highest frequency.
    pub band: [f64; 2],
    /// Number of frequencies at which responses were computed.
    pub frequencies: usize,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Outputs, then von Mises stresses.
    pub outputs: Vec<RandomOutput>,
    /// Files.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
    /// The state that the responses are about, in words, with its damping.
    pub about: String,
    /// Reservations about the state.
    pub warnings: Vec<String>,
}

/// The random response of an output.
#[derive(Debug, Clone, Serialize)]
pub struct RandomOutput {
    /// Its name; with `von_mises` in the place of `stress` of an equivalent stress.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Root mean square.
    pub rms: f64,
    /// Root mean square of its rate, per time; none of an equivalent stress, which is no signal with a sign.
    pub rate_rms: Option<f64>,
    /// Upward crossings of 0, 1, 2 and 3 root mean squares, per time; the first is the apparent frequency.
    pub crossings: Option<[f64; 4]>,
}

impl PsdReport {
    /// The report before files are written.
    pub(super) fn new(scene: &Shared, model: &LinearModel, band: [f64; 2], responses: &Responses) -> Self {
        let output = |(k, (channel, response)): (usize, &(linear::Channel, RandomResponse))| {
            let is_signal = k < responses.first_von_mises;
            RandomOutput {
                output: channel.name.clone(),
                unit: channel.unit.clone(),
                rms: response.rms,
                rate_rms: is_signal.then_some(response.rate_rms),
                crossings: is_signal.then(|| LEVELS.map(|level| response.crossings(level * response.rms))),
            }
        };
        Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(&scene.units.time),
            band,
            frequencies: responses.frequencies.len(),
            about: model.state.to_string(),
            inputs: model.equations.inputs.iter().map(|input| input.name.clone()).collect(),
            outputs: responses.outputs.iter().enumerate().map(output).collect(),
            files: Vec::new(),
            warnings: model.state.warnings.clone(),
        }
    }
}

impl fmt::Display for PsdReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = &self.frequency_unit;
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  about    {}", self.about)?;
        writeln!(f, "  inputs   {}", self.inputs.join(", "))?;
        writeln!(f, "  band     {} to {} {unit}, {} frequencies", self.band[0], self.band[1], self.frequencies)?;
        write!(f, "  {:<32}  {:>14}  {:>16}  {:>14}", "root mean squares", "rms", "apparent", "above 3 rms")?;
        for RandomOutput { output, unit: of, rms, crossings, .. } in &self.outputs {
            write!(f, "\n  {output:<32}  {:>14}", format!("{rms:.6e} {of}"))?;
            if let Some([apparent, .., third]) = crossings.filter(|_| *rms > 0.0) {
                write!(f, "  {:>16}  {third:>9.3e} {unit}", format!("{apparent:.6} {unit}"))?;
            }
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
