//! Report of `flexframe linearize`.

use std::f64::consts::TAU;
use std::fmt;
use std::path::{Path, PathBuf};

use faer::c64;
use linear::StateSpace;
use scene::Shared;
use serde::Serialize;

use super::at_once::AtOnce;
use super::space::LinearSpace;
use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::report::counted;

/// Poles that are shown.
const POLES: usize = 20;

/// Report of `flexframe linearize`.
#[derive(Debug, Clone, Serialize)]
pub struct LinearReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// The file.
    #[serde(serialize_with = "json::path")]
    pub file: PathBuf,
    /// Time of the state.
    pub time: f64,
    /// Angular velocity of the state, global.
    pub omega_global: [f64; 3],
    /// The state in words, with its damping.
    pub about: String,
    /// Number of states, inputs and outputs of what is written.
    pub states: usize,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// States of the whole model.
    pub whole: usize,
    /// Bound of the error of a balanced truncation, largest singular value at any frequency.
    pub error_bound: Option<f64>,
    /// Hankel values of the whole model, where it is reduced.
    pub hankel_values: Vec<f64>,
    /// Poles, slowest first: one of each conjugate pair.
    pub poles: Vec<Pole>,
    /// Rank of D, where outputs are as many as inputs.
    pub at_once: Option<AtOnce>,
    /// Reservations about the state.
    pub warnings: Vec<String>,
}

/// A pole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pole {
    /// Growth per time.
    pub growth: f64,
    /// Cycles per time.
    pub frequency: f64,
    /// −growth over the magnitude; 0 of a pole of zero.
    pub damping_ratio: f64,
    /// Its complex mode: real and imaginary part of each output, the largest of the unit of the first output 1.
    pub shape: Vec<[f64; 2]>,
}

impl LinearReport {
    pub(super) fn new(scene: &Shared, space: &LinearSpace, poles: &[c64], file: &Path) -> Self {
        let LinearSpace { whole, state, .. } = space;
        let (written, balanced) = (space.model(), space.balanced());
        let pole = |pole: &c64| Pole {
            growth: pole.re,
            frequency: pole.im / TAU,
            damping_ratio: if pole.norm() > 0.0 { -pole.re / pole.norm() } else { 0.0 },
            shape: shape(written, *pole),
        };
        Self {
            title: scene.title.clone(),
            time: state.time,
            frequency_unit: frequency_unit(&scene.units.time),
            file: file.to_owned(),
            omega_global: state.omega_global,
            about: state.to_string(),
            states: written.states.len(),
            inputs: written.inputs.iter().map(|channel| channel.name.clone()).collect(),
            outputs: written.outputs.iter().map(|channel| channel.name.clone()).collect(),
            whole: whole.states.len(),
            error_bound: balanced.map(|(bound, _)| *bound),
            hankel_values: balanced.map_or_else(Vec::new, |(_, values)| values.clone()),
            poles: poles.iter().filter(|pole| pole.im >= 0.0).map(pole).collect(),
            at_once: AtOnce::of(written),
            warnings: state.warnings.clone(),
        }
    }
}

/// The outputs in the complex mode of a pole, in the scale of the largest of one unit.
fn shape(model: &StateSpace, pole: c64) -> Vec<[f64; 2]> {
    let outputs = model.complex_mode(pole);
    let unit = model.outputs.first().map(|channel| &channel.unit);
    let of_unit = outputs.iter().zip(&model.outputs).filter(|(_, channel)| Some(&channel.unit) == unit);
    let largest = of_unit.map(|(output, _)| *output).max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let scale = largest.filter(|largest| largest.norm() > 0.0).unwrap_or(c64::ONE);
    outputs.into_iter().map(|output| output / scale).map(|output| [output.re, output.im]).collect()
}

impl fmt::Display for LinearReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  about    {}", self.about)?;
        let inputs = counted(self.inputs.len(), ["input", "inputs"]);
        let outputs = counted(self.outputs.len(), ["output", "outputs"]);
        write!(f, "  model    {}, {inputs}, {outputs}", counted(self.states, ["state", "states"]))?;
        match self.error_bound {
            Some(bound) => writeln!(f, "; of {} states, no response wrong by more than {bound:.3e}", self.whole)?,
            None if self.states < self.whole => writeln!(f, "; of {} states, exact at frequency 0", self.whole)?,
            None => writeln!(f)?,
        }
        writeln!(f, "  inputs   {}", self.inputs.join(", "))?;
        writeln!(f, "  outputs  {}", self.outputs.join(", "))?;
        if let Some(words) = self.at_once.as_ref().and_then(AtOnce::in_words) {
            writeln!(f, "  D        {words}")?;
        }
        writeln!(f, "  file     {}", self.file.display())?;
        write!(f, "\n  {:>16}  {:>12}  {:>12}", format!("poles, {}", self.frequency_unit), "damping", "growth")?;
        for pole in self.poles.iter().take(POLES) {
            write!(f, "\n  {:>16.6}  {:>12.4e}  {:>12.4e}", pole.frequency, pole.damping_ratio, pole.growth)?;
        }
        if self.poles.len() > POLES {
            write!(f, "\n  … {} in all", self.poles.len())?;
        }
        for warning in &self.warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}
