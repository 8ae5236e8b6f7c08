//! Report of a fit.

use std::path::Path;

use diagnostic::{Failure, Kind};
use report::{Form, Report, Table, quantity};
use scene::{Shared, assign};
use toml::Value;
use whole_file::write_whole;

use crate::commands::modes::frequency_unit;
use crate::files::write_error::WriteError;

/// Probability that an interval has the true value in it.
pub(super) const CONFIDENCE: f64 = 0.95;
/// A correlation from which two parameters are hard to tell apart.
const ALIKE: f64 = 0.95;
/// Part of a frequency from which it is not met.
const MISSED: f64 = 0.05;
/// A scatter in stated deviations from which something else is wrong.
const SCATTERED: f64 = 2.0;

/// Parameters by measured frequencies.
pub struct Fitted {
    /// The parameters, as asked for.
    pub parameters: Vec<FittedParameter>,
    /// The modes, in the order of the table.
    pub modes: Vec<FittedMode>,
    /// Between the parameters; between logarithms but for Poisson's ratios.
    pub correlation: Vec<Vec<f64>>,
    /// Measured frequencies beyond the number of parameters.
    pub freedom: usize,
    /// True if the deviations of the frequencies are stated; else intervals follow from what is left.
    pub is_stated: bool,
    /// Standard deviation of what is left: in stated deviations, or relative to the frequencies. None without degrees of freedom.
    pub scatter: Option<f64>,
    /// Steps of the search.
    pub iterations: usize,
    /// Singular values of the rates of the frequencies, in units of their deviations, with the logarithms of the parameters.
    pub singular: Vec<f64>,
}

/// A parameter that was fitted.
pub struct FittedParameter {
    /// The path of its key, or `thickness.GROUP.AXIS`.
    pub name: String,
    /// True if it stands in the scene; false of a factor on the shape of the mesh.
    pub is_key: bool,
    /// Its value in the scene.
    pub start: f64,
    /// Its value by the measured frequencies.
    pub value: f64,
    /// The interval that has the true value in it with the confidence; none where nothing tells the scatter.
    pub interval: Option<[f64; 2]>,
}

/// A measured mode.
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

impl Fitted {
    /// The report; the scene with the parameters is written to a file where one is named.
    pub(super) fn report(self, scene: &Shared, output: Option<&Path>) -> Result<Report, Failure> {
        if let Some(output) = output {
            write_whole(output, self.scene_text(scene)?).map_err(WriteError::of(output))?;
        }
        let mut report = Report::new(&scene.title);
        let unit = frequency_unit(&scene.units.time);
        let (of, modes) = (&self.parameters, &self.modes);
        let off = |mode: &FittedMode| match mode.deviation {
            Some(deviation) => format!("{:.2} deviations", (mode.after - mode.measured) / deviation),
            None => format!("{:.3} %", 100.0 * (mode.after / mode.measured - 1.0)),
        };
        report.put("frequency_unit", &unit);
        report.put("confidence", CONFIDENCE);
        report.table(
            Table::new("modes", "modes")
                .all()
                .column("line", modes.iter().map(|mode| mode.line))
                .shown("mode", "mode", Form::Plain, modes.iter().map(|mode| mode.mode))
                .shown("measured", format!("measured, {unit}"), Form::Fixed(6), modes.iter().map(|mode| mode.measured))
                .shown("before", "before", Form::Fixed(6), modes.iter().map(|mode| mode.before))
                .shown("after", "after", Form::Fixed(6), modes.iter().map(|mode| mode.after))
                .column("deviation", modes.iter().map(|mode| mode.deviation))
                .text_only("off by", Form::Plain, modes.iter().map(off)),
        );
        let interval = |of: &FittedParameter| of.interval.map(|ends| ends.map(quantity).join(" to "));
        let mut table = Table::new("parameters", "parameters")
            .all()
            .shown("name", "parameter", Form::Plain, of.iter().map(|of| &of.name))
            .column("is_key", of.iter().map(|of| of.is_key))
            .shown("start", "in the scene", Form::Plain, of.iter().map(|of| of.start))
            .shown("value", "fitted", Form::Plain, of.iter().map(|of| of.value))
            .column("interval", of.iter().map(|of| of.interval))
            .text_only(format!("with {:.0} % confidence", 100.0 * CONFIDENCE), Form::Plain, of.iter().map(interval));
        if of.len() > 1 {
            for (k, row) in self.correlation.iter().enumerate() {
                let heading = if k == 0 { "correlation" } else { "" };
                table = table.text_only(heading, Form::Fixed(3), row.iter().copied());
            }
        }
        report.table(table);
        let scatter = match (self.scatter, self.is_stated) {
            (None, _) => "unknown".to_owned(),
            (Some(scatter), true) => format!("{scatter:.2} stated deviations"),
            (Some(scatter), false) => format!("{:.3} % of a frequency", 100.0 * scatter),
        };
        let (freedom, steps) = (self.freedom, self.iterations);
        report.line("scatter", format!("{scatter}, by {freedom} more frequencies than parameters; {steps} steps"));
        report.put("correlation", &self.correlation[..]);
        report.put("singular_values", &self.singular[..]);
        report.put("degrees_of_freedom", freedom);
        report.put("deviations_stated", self.is_stated);
        report.put("scatter", self.scatter);
        report.put("iterations", steps);
        report.put("file", output.map(|output| output.display().to_string()));
        match output {
            Some(output) => report.line("wrote", output.display().to_string()),
            None => report.line("to use", self.use_in_words()),
        }
        report.warnings = self.warnings();
        Ok(report)
    }

    fn use_in_words(&self) -> String {
        let (keys, stretches): (Vec<_>, Vec<_>) = self.parameters.iter().partition(|parameter| parameter.is_key);
        let set = |parameter: &&FittedParameter| format!("--set '{}={}'", parameter.name, parameter.value);
        let mesh = |of: &&FittedParameter| format!("a mesh with {} = {}", of.name, quantity(of.value));
        let keys = keys.iter().map(set).collect::<Vec<_>>().join(" ");
        let all = (!keys.is_empty()).then_some(keys).into_iter().chain(stretches.iter().map(mesh));
        all.collect::<Vec<_>>().join(" and ")
    }

    fn warnings(&self) -> Vec<String> {
        let Self { parameters, modes, correlation, is_stated, scatter, .. } = self;
        let mut warnings = Vec::new();
        for (i, row) in correlation.iter().enumerate() {
            for (j, together) in row.iter().enumerate().take(i).filter(|(_, together)| together.abs() > ALIKE) {
                warnings.push(format!(
                    "{} and {} are hard to tell apart by these frequencies: their correlation is {together:.4}",
                    parameters[j].name, parameters[i].name
                ));
            }
        }
        if let Some(scatter) = scatter.filter(|scatter| *is_stated && *scatter > SCATTERED) {
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
        if scatter.is_none() && !*is_stated {
            warnings.push(
                "as many parameters as frequencies: nothing tells the scatter, so that there are no intervals"
                    .to_owned(),
            );
        }
        warnings
    }

    /// The text of the scene with the parameters in it.
    fn scene_text(&self, scene: &Shared) -> Result<String, Failure> {
        if let Some(parameter) = self.parameters.iter().find(|parameter| !parameter.is_key) {
            return Err(no_key(&parameter.name));
        }
        let values: Vec<(String, Value)> =
            self.parameters.iter().map(|parameter| (parameter.name.clone(), Value::Float(parameter.value))).collect();
        assign(&scene.text, &values).map_err(|error| no_key(&error.key))
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
