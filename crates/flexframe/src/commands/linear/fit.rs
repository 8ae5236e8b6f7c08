//! `flexframe fit`: parameters of a body by measured frequencies, with intervals of confidence.

mod least_squares;
mod report;
mod student;
mod subject;

use std::path::Path;

use ::report::Report;
use diagnostic::{Failure, Kind};
use faer::Mat;
use model::{BuildProgress, Builder};
use scene::{Measured, Scene};

use self::report::CONFIDENCE;
pub use self::report::{Fitted, FittedMode, FittedParameter};
use least_squares::{Fault, Residuals, Solution, Unseen, solve};
use subject::{Found, Subject};

/// The quantile of the normal distribution for it, on both sides.
const NORMAL: f64 = 1.959_963_984_540_054;

/// Settings of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSettings {
    /// Names of the parameters: paths of keys.
    pub parameters: Vec<String>,
    /// Measured modes, in the place of those of the scene.
    pub measured: Option<Measured>,
    /// Relative standard deviation of the measured frequencies that have none of their own.
    pub deviation: Option<f64>,
}

/// A body, or bodies in joints, that are fitted to measured frequencies.
pub struct ParameterFit {
    subject: Subject,
    measured: Measured,
    /// A standard deviation for each measured frequency: as stated, or the frequency itself where none is.
    deviations: Vec<f64>,
    is_stated: bool,
}

impl ParameterFit {
    /// The fit of a scene of one body, or of bodies in joints.
    ///
    /// # Errors
    /// [`Failure`] of parameters and tables that do not fit the scene or each other.
    pub fn new(
        scene: &Scene,
        builder: &Builder,
        settings: &FitSettings,
        progress: impl FnMut(BuildProgress),
    ) -> Result<Self, Failure> {
        let of_scene = || scene.bodies.iter().find_map(|body| body.modes.measured.clone());
        let measured = settings.measured.clone().or_else(of_scene).ok_or_else(|| {
            let found = "no measured frequencies: found neither --measured nor `measured` in [modes] of the scene";
            Kind::Usage.alone().help("name a CSV file with a column `frequency`: --measured test.csv").says(found)
        })?;
        let subject = Subject::new(scene, builder, &settings.parameters, &measured, progress)?;
        let (deviations, is_stated) = deviations(&measured, settings.deviation)?;
        Ok(Self { subject, measured, deviations, is_stated })
    }

    /// Frequencies of the modes that were measured, in the scene as it is.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn frequencies(&self) -> Result<Vec<f64>, Failure> {
        Ok(self.residuals(&vec![0.0; self.subject.names().len()])?.frequencies)
    }

    /// Gives the lines of the table other measured frequencies, with the same relative deviations.
    pub fn set_frequencies(&mut self, frequencies: &[f64]) {
        let lines = self.measured.modes.iter_mut().zip(&mut self.deviations);
        for ((mode, deviation), frequency) in lines.zip(frequencies) {
            *deviation *= frequency / mode.frequency;
            mode.frequency = *frequency;
        }
    }

    /// Finds the parameters.
    ///
    /// # Errors
    /// [`Failure`] of parameters that the frequencies do not tell, and where no values are found.
    pub fn run(&self) -> Result<Fitted, Failure> {
        let names = self.subject.names();
        let start = vec![0.0; names.len()];
        let limits = |x: &[f64]| self.is_within(x);
        let Solution { x, first, last, iterations, singular, right } =
            solve(&start, |x| self.residuals(x), limits).map_err(|fault| not_found(fault, &names))?;
        let (count, unknowns) = (self.measured.modes.len(), x.len());
        let freedom = count - unknowns;
        let sum: f64 = last.values.iter().map(|r| r * r).sum();
        // With stated deviations the scatter is known; else it follows from what is left.
        let scatter = if freedom > 0 { Some((sum / freedom as f64).sqrt()) } else { None };
        let (factor, quantile) = match (self.is_stated, scatter) {
            (true, _) => (Some(1.0), NORMAL),
            (false, scatter) => (scatter, if freedom > 0 { student::quantile(CONFIDENCE, freedom) } else { f64::NAN }),
        };
        // (JᵀJ)⁻¹ = V S⁻² Vᵀ.
        let covariance = Mat::from_fn(unknowns, unknowns, |i, j| {
            (0..unknowns).map(|k| right[(i, k)] * right[(j, k)] / singular[k].powi(2)).sum::<f64>()
        });
        let deviations: Vec<f64> = (0..unknowns).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
        let fitted = |(i, name): (usize, String)| {
            let deviation = factor.map(|factor| factor * deviations[i]);
            let at = |sign: f64, deviation: f64| self.subject.value(i, x[i] + sign * quantile * deviation);
            FittedParameter {
                name,
                is_key: self.subject.is_key(i),
                start: self.subject.value(i, 0.0),
                value: self.subject.value(i, x[i]),
                interval: deviation.map(|deviation| [at(-1.0, deviation), at(1.0, deviation)]),
            }
        };
        let correlation = |i: usize, j: usize| covariance[(i, j)] / (deviations[i] * deviations[j]);
        let modes = self.measured.modes.iter().enumerate().map(|(i, mode)| FittedMode {
            line: mode.line,
            mode: last.modes[i] + 1,
            measured: mode.frequency,
            before: first[i],
            after: last.frequencies[i],
            deviation: self.is_stated.then_some(self.deviations[i]),
        });
        Ok(Fitted {
            parameters: names.into_iter().enumerate().map(fitted).collect(),
            modes: modes.collect(),
            correlation: (0..unknowns).map(|i| (0..unknowns).map(|j| correlation(i, j)).collect()).collect(),
            freedom,
            is_stated: self.is_stated,
            scatter,
            iterations,
            singular,
        })
    }

    /// The frequencies of measured modes with their rates, in units of their deviations.
    fn residuals(&self, x: &[f64]) -> Result<Residuals, Failure> {
        let Found { frequencies, rates, modes } = self.subject.found(x, &self.measured)?;
        let of_modes = frequencies.iter().zip(&self.measured.modes).zip(&self.deviations);
        let values = of_modes.map(|((f, mode), deviation)| (f - mode.frequency) / deviation).collect();
        let jacobian = Mat::from_fn(modes.len(), x.len(), |i, j| rates[j][i] / self.deviations[i]);
        let relative = frequencies.iter().zip(&self.deviations).map(|(f, deviation)| deviation / f).collect();
        Ok(Residuals { values, jacobian, relative, frequencies, modes })
    }

    fn is_within(&self, x: &[f64]) -> bool {
        x.iter().enumerate().all(|(i, x)| self.subject.is_within(i, *x))
    }
}

/// Fits parameters of a scene to measured frequencies, and writes the scene with them to a file where one is named.
///
/// # Errors
/// [`Failure`] of parameters and tables that do not fit the scene or each other, of parameters that the frequencies do not tell, and where no
/// values are found.
pub fn fit(
    scene: &Scene,
    builder: &Builder,
    settings: &FitSettings,
    output: Option<&Path>,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let fit = ParameterFit::new(scene, builder, settings, progress)?;
    fit.run()?.report(fit.subject.scene(), output)
}

/// Standard deviations of the measured frequencies, and true if they are stated: of all of them or of none.
fn deviations(measured: &Measured, relative: Option<f64>) -> Result<(Vec<f64>, bool), Failure> {
    let of = |mode: &scene::MeasuredMode| mode.deviation.or(relative.map(|relative| relative * mode.frequency));
    let stated: Vec<f64> = measured.modes.iter().filter_map(of).collect();
    if stated.is_empty() {
        return Ok((measured.modes.iter().map(|mode| mode.frequency).collect(), false));
    }
    match measured.modes.iter().find(|mode| of(mode).is_none()) {
        Some(mode) => {
            let wrong = Kind::Input.of(&measured.file).line(mode.line).found("no deviation");
            let help = "add it, give --deviation for those that have none, or leave the column out";
            Err(wrong.expected("one, since other lines have theirs").help(help).into())
        }
        None => Ok((stated, true)),
    }
}

/// The error of parameters that could not be found.
fn not_found(fault: Fault<Failure>, names: &[String]) -> Failure {
    let refused = |words: String, help: &str| Kind::Refused.alone().help(help).says(words);
    match fault {
        Fault::Residuals(error) => error,
        Fault::Coordinates(Unseen::NoInfluence(j)) => refused(
            format!("{} changes none of the measured frequencies", names[j]),
            "leave it out, or measure modes that it changes: `flexframe gradient` shows them",
        ),
        Fault::Coordinates(Unseen::Gone(j)) => refused(
            format!(
                "the search has taken {} to where it changes none of the measured frequencies: no value of it gives them",
                names[j]
            ),
            "see whether modes are mistaken for each other, or fit what is wrong in the model",
        ),
        Fault::Coordinates(Unseen::Apart(parts)) => {
            let together: Vec<&str> = parts.iter().map(|(j, _)| &*names[*j]).collect();
            let grown: Vec<String> =
                parts.iter().map(|(j, part)| format!("{} grows by s^{part:.2}", names[*j])).collect();
            refused(
                format!(
                    "the measured frequencies do not tell {} apart: none of them changes where {}, for any s",
                    together.join(" and "),
                    grown.join(", ")
                ),
                "leave one of them out, or measure a mass or a static displacement",
            )
        }
        Fault::Coordinates(Unseen::Steps(steps)) => {
            let help = "begin with values nearer to the truth, or fit fewer parameters; `flexframe gradient` shows what each changes";
            Kind::Run.alone().help(help).says(format!("no values were found in {steps} steps"))
        }
    }
}
