//! Report of a fit.

use std::fmt;
use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use scene::{Shared, assign};
use serde::Serialize;
use toml::Value;
use whole_file::write_whole;

use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::files::write_error::WriteError;
use crate::report::quantity;

/// Probability that an interval has the true value in it.
pub(super) const CONFIDENCE: f64 = 0.95;
/// A correlation from which two parameters are hard to tell apart.
const ALIKE: f64 = 0.95;
/// Part of a frequency from which it is not met.
const MISSED: f64 = 0.05;
/// A scatter in stated deviations from which something else is wrong.
const SCATTERED: f64 = 2.0;

/// Report of `flexframe fit`.
#[derive(Debug, Clone, Serialize)]
pub struct FitReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// The parameters.
    pub parameters: Vec<FittedParameter>,
    /// Probability that an interval has the true value in it.
    pub confidence: f64,
    /// The measured modes.
    pub modes: Vec<FittedMode>,
    /// Correlations of the parameters, of logarithms but for Poisson's ratios.
    pub correlation: Vec<Vec<f64>>,
    /// Singular values of the rates of the frequencies, in units of their deviations, with the logarithms of the parameters.
    pub singular_values: Vec<f64>,
    /// Measured frequencies beyond the number of parameters.
    pub degrees_of_freedom: usize,
    /// True if the deviations of the frequencies are stated; else intervals follow from what is left.
    pub deviations_stated: bool,
    /// Standard deviation of what is left: in stated deviations, or relative to the frequencies. `null` without degrees of freedom.
    #[serde(serialize_with = "json::optional")]
    pub scatter: Option<f64>,
    /// Steps of the search.
    pub iterations: usize,
    /// Reservations.
    pub warnings: Vec<String>,
    /// The scene with the parameters, where it is written.
    #[serde(serialize_with = "json::optional_path")]
    pub file: Option<PathBuf>,
    #[serde(skip)]
    text: String,
}

/// A parameter that was fitted.
#[derive(Debug, Clone, Serialize)]
pub struct FittedParameter {
    /// The path of its key, or `thickness.GROUP.AXIS`.
    pub name: String,
    /// True if it stands in the scene; false of a factor on the shape of the mesh.
    pub is_key: bool,
    /// Its value in the scene.
    pub start: f64,
    /// Its value by the measured frequencies.
    pub value: f64,
    /// The interval that has the true value in it with the stated confidence; `null` where nothing tells the scatter.
    pub interval: Option<[f64; 2]>,
}

/// A measured mode.
#[derive(Debug, Clone, Serialize)]
pub struct FittedMode {
    /// Line of the table, from 1.
    pub line: usize,
    /// Number of the mode of the model, from 1.
    pub mode: usize,
    /// The measured frequency, cycles per time.
    pub measured: f64,
    /// Frequency of the model in the scene.
    pub before: f64,
    /// Frequency of the model with the parameters.
    pub after: f64,
    /// Standard deviation of the measured one, where it is stated.
    pub deviation: Option<f64>,
}

/// Numbers on a fit as a whole.
pub(super) struct Quality {
    pub freedom: usize,
    pub is_stated: bool,
    pub scatter: Option<f64>,
    pub iterations: usize,
    pub singular: Vec<f64>,
}

impl FitReport {
    pub(super) fn new(
        scene: &Shared,
        parameters: Vec<FittedParameter>,
        modes: Vec<FittedMode>,
        correlation: Vec<Vec<f64>>,
        Quality { freedom, is_stated, scatter, iterations, singular }: Quality,
    ) -> Self {
        let mut warnings = Vec::new();
        for (i, row) in correlation.iter().enumerate() {
            for (j, together) in row.iter().enumerate().take(i).filter(|(_, together)| together.abs() > ALIKE) {
                warnings.push(format!(
                    "{} and {} are hard to tell apart by these frequencies: their correlation is {together:.4}",
                    parameters[j].name, parameters[i].name
                ));
            }
        }
        if let Some(scatter) = scatter.filter(|scatter| is_stated && *scatter > SCATTERED) {
            warnings.push(format!(
                "the frequencies are off by {scatter:.1} times their stated deviations: the model lacks something, modes are mistaken for \
                 each other, or the deviations are larger; the intervals do not have this in them"
            ));
        }
        let off = |mode: &FittedMode| (mode.after / mode.measured - 1.0).abs();
        if let Some(worst) = modes.iter().max_by(|a, b| off(a).total_cmp(&off(b))).filter(|worst| off(worst) > MISSED) {
            warnings.push(format!(
                "mode {} is still off by {:.0} % of what line {} of the table has: these parameters do not give it; see whether modes are \
                 mistaken for each other, and whether something else is wrong in the model",
                worst.mode,
                100.0 * off(worst),
                worst.line
            ));
        }
        if scatter.is_none() && !is_stated {
            warnings.push(
                "as many parameters as frequencies: nothing tells the scatter, so that there are no intervals"
                    .to_owned(),
            );
        }
        Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(&scene.units.time),
            parameters,
            confidence: CONFIDENCE,
            modes,
            correlation,
            singular_values: singular,
            degrees_of_freedom: freedom,
            deviations_stated: is_stated,
            scatter,
            iterations,
            warnings,
            file: None,
            text: scene.text.to_string(),
        }
    }

    /// The text of the scene with the parameters in it.
    ///
    /// # Errors
    /// A factor on the shape, and of a key that cannot be set.
    pub fn scene_text(&self) -> Result<String, Failure> {
        if let Some(parameter) = self.parameters.iter().find(|parameter| !parameter.is_key) {
            return Err(no_key(&parameter.name));
        }
        let values: Vec<(String, Value)> =
            self.parameters.iter().map(|parameter| (parameter.name.clone(), Value::Float(parameter.value))).collect();
        assign(&self.text, &values).map_err(|error| no_key(&error.key))
    }

    /// Writes the scene with the parameters in it.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn write_scene(&mut self, path: &Path) -> Result<(), Failure> {
        write_whole(path, self.scene_text()?).map_err(WriteError::of(path))?;
        self.file = Some(path.to_owned());
        Ok(())
    }
}

impl fmt::Display for FitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        writeln!(f, "\n  mode  measured, {:<6}       before        after  off by", self.frequency_unit)?;
        for FittedMode { mode, measured, before, after, deviation, .. } in &self.modes {
            let off = match deviation {
                Some(deviation) => format!("{:.2} deviations", (after - measured) / deviation),
                None => format!("{:.3} %", 100.0 * (after / measured - 1.0)),
            };
            writeln!(f, "  {mode:>4}  {measured:>16.6} {before:>12.6} {after:>12.6}  {off}")?;
        }
        writeln!(f)?;
        for FittedParameter { name, start, value, interval, .. } in &self.parameters {
            write!(f, "  {name} = {}", quantity(*value))?;
            if let Some([low, high]) = interval {
                let percent = 100.0 * self.confidence;
                write!(f, ", with {percent:.0} % confidence {} to {}", quantity(*low), quantity(*high))?;
            }
            writeln!(f, "; the scene has {}", quantity(*start))?;
        }
        let freedom = self.degrees_of_freedom;
        let scatter = match (self.scatter, self.deviations_stated) {
            (None, _) => "unknown".to_owned(),
            (Some(scatter), true) => format!("{scatter:.2} stated deviations"),
            (Some(scatter), false) => format!("{:.3} % of a frequency", 100.0 * scatter),
        };
        write!(f, "  scatter  {scatter}, by {freedom} more frequencies than parameters; {} steps", self.iterations)?;
        if self.parameters.len() > 1 {
            write!(f, "\n  correlation")?;
            for (row, parameter) in self.correlation.iter().zip(&self.parameters) {
                let numbers: Vec<String> = row.iter().map(|number| format!("{number:>7.3}")).collect();
                write!(f, "\n    {}  {}", numbers.join(" "), parameter.name)?;
            }
        }
        match &self.file {
            Some(file) => write!(f, "\n  wrote    {}", file.display())?,
            None => {
                let (keys, stretches): (Vec<_>, Vec<_>) =
                    self.parameters.iter().partition(|parameter| parameter.is_key);
                let set = |parameter: &&FittedParameter| format!("--set '{}={}'", parameter.name, parameter.value);
                let mesh = |parameter: &&FittedParameter| {
                    format!("a mesh with {} = {}", parameter.name, quantity(parameter.value))
                };
                let keys = keys.iter().map(set).collect::<Vec<_>>().join(" ");
                let all = (!keys.is_empty()).then_some(keys).into_iter().chain(stretches.iter().map(mesh));
                write!(f, "\n  to use   {}", all.collect::<Vec<_>>().join(" and "))?;
            }
        }
        self.warnings.iter().try_for_each(|warning| write!(f, "\n  warning  {warning}"))
    }
}

/// The refusal of a number that does not stand in the scene.
fn no_key(name: &str) -> Failure {
    let words = format!(
        "{name} is no key of the scene, which cannot be written with it: found a factor on the shape of the mesh, expected numbers of \
         materials and point masses"
    );
    Kind::Usage.alone().help("leave -o out, and mesh the body with the thickness that was found").says(words)
}
