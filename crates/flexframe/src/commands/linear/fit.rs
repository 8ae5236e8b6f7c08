//! `flexframe fit`: parameters of a body by measured frequencies, with intervals of confidence.

mod error;
mod least_squares;
mod report;
mod student;

use fem_tet10::BodyNumber;
use model::{BuildError, BuildProgress, Builder, Parameter, RatesOf, VariedBody};
use scene::{Measured, MeshedBody, Scene};

pub use error::FitError;
pub use report::{FitReport, FittedMode, FittedParameter};

use crate::commands::modes::unloaded_body;
use faer::Mat;
use least_squares::{Residuals, Solution, solve};
use report::{CONFIDENCE, Quality};

/// The quantile of the normal distribution for it, on both sides.
const NORMAL: f64 = 1.959_963_984_540_054;
/// The limits within which Poisson's ratio is searched.
const POISSON: [f64; 2] = [-0.95, 0.499];

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

/// A body that is fitted to measured frequencies.
pub struct Fit {
    body: VariedBody,
    parameters: Vec<Parameter>,
    measured: Measured,
    /// A standard deviation for each measured frequency: as stated, or the frequency itself where none is.
    deviations: Vec<f64>,
    is_stated: bool,
}

impl Fit {
    /// The fit of a scene's body.
    ///
    /// # Errors
    /// [`FitError`] of parameters and tables that do not fit the scene or each other.
    pub fn new(
        scene: &Scene,
        builder: &Builder,
        settings: &FitSettings,
        progress: impl FnMut(BuildProgress),
    ) -> Result<Self, FitError> {
        let scene = &unloaded_body(scene).map_err(BuildError::from)?;
        let measured = settings.measured.clone().or_else(|| scene.modes.measured.clone()).ok_or(FitError::NoTable)?;
        if settings.parameters.is_empty() {
            return Err(FitError::NoParameters { names: names(&Parameter::all(scene).map_err(BuildError::from)?) });
        }
        let parameters = Parameter::named(scene, &settings.parameters).map_err(BuildError::from)?;
        if let Some(parameter) = parameters.iter().find(|parameter| !parameter.is_key()) {
            return Err(FitError::NoKey { name: parameter.name.clone() });
        }
        let (count, unknowns) = (measured.modes.len(), parameters.len());
        if unknowns > count {
            let file = measured.file.clone();
            return Err(FitError::TooFew { file, count, unknowns, names: names(&parameters) });
        }
        let body = builder.varied(scene, progress)?;
        let (deviations, is_stated) = deviations(&measured, settings.deviation)?;
        Ok(Self { body, parameters, measured, deviations, is_stated })
    }

    /// Frequencies of the modes that were measured, in the scene as it is.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn frequencies(&self) -> Result<Vec<f64>, FitError> {
        Ok(self.residuals(&vec![0.0; self.parameters.len()])?.frequencies)
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
    /// [`FitError`] of parameters that the frequencies do not tell, and where no values are found.
    pub fn run(&self) -> Result<FitReport, FitError> {
        let start = vec![0.0; self.parameters.len()];
        let limits = |x: &[f64]| self.is_within(x);
        let Solution { x, first, last, iterations, singular, right } = solve(&start, |x| self.residuals(x), limits)
            .map_err(|fault| FitError::of_fault(fault, &self.parameters))?;
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
        let fitted = |(i, parameter): (usize, &Parameter)| {
            let value = self.value(parameter, x[i]);
            let deviation = factor.map(|factor| factor * deviations[i]);
            let at = |sign: f64, deviation: f64| self.value(parameter, x[i] + sign * quantile * deviation);
            FittedParameter {
                name: parameter.name.clone(),
                start: parameter.value(self.body.body()),
                value,
                interval: deviation.map(|deviation| [at(-1.0, deviation), at(1.0, deviation)]),
            }
        };
        let correlation = |i: usize, j: usize| covariance[(i, j)] / (deviations[i] * deviations[j]);
        let modes = self.measured.modes.iter().enumerate().map(|(i, mode)| FittedMode {
            line: mode.line,
            mode: last.modes[i] + 1,
            measured: mode.frequency,
            before: first.frequencies[i],
            after: last.frequencies[i],
            deviation: self.is_stated.then_some(self.deviations[i]),
        });
        Ok(FitReport::new(
            self.body.scene(),
            self.parameters.iter().enumerate().map(fitted).collect(),
            modes.collect(),
            (0..unknowns).map(|i| (0..unknowns).map(|j| correlation(i, j)).collect()).collect(),
            Quality { freedom, is_stated: self.is_stated, scatter, iterations, singular },
        ))
    }

    /// The frequencies of measured modes with their rates, in units of their deviations.
    fn residuals(&self, x: &[f64]) -> Result<Residuals, FitError> {
        let body = self.body_at(x);
        let found = self.body.rates(&body, &self.parameters, RatesOf::Frequencies)?;
        let modes = self.body.matched(&self.measured, &found)?;
        let frequencies: Vec<f64> = modes.iter().map(|k| found.frequencies[*k]).collect();
        let of_modes = frequencies.iter().zip(&self.measured.modes).zip(&self.deviations);
        let values = of_modes.map(|((f, mode), deviation)| (f - mode.frequency) / deviation).collect();
        let slope = |j: usize| match self.parameters[j].number {
            BodyNumber::PoissonRatio(_) => 1.0,
            _ => self.parameters[j].value(&body),
        };
        let jacobian = Mat::from_fn(modes.len(), x.len(), |i, j| {
            slope(j) * found.rates[j].frequencies[modes[i]] / self.deviations[i]
        });
        let relative = frequencies.iter().zip(&self.deviations).map(|(f, deviation)| deviation / f).collect();
        Ok(Residuals { values, jacobian, relative, frequencies, modes })
    }

    /// A body with the parameters at coordinates: logarithms of ratios to the first values, differences of Poisson's ratio.
    fn body_at(&self, x: &[f64]) -> MeshedBody {
        let mut body = self.body.body().clone();
        for (parameter, x) in self.parameters.iter().zip(x) {
            parameter.set(&mut body, self.value(parameter, *x));
        }
        body
    }

    fn value(&self, parameter: &Parameter, x: f64) -> f64 {
        let first = parameter.value(self.body.body());
        match parameter.number {
            BodyNumber::PoissonRatio(_) => first + x,
            _ => first * x.exp(),
        }
    }

    fn is_within(&self, x: &[f64]) -> bool {
        self.parameters.iter().zip(x).all(|(parameter, x)| match parameter.number {
            BodyNumber::PoissonRatio(_) => (POISSON[0]..=POISSON[1]).contains(&self.value(parameter, *x)),
            _ => x.abs() < 20.0,
        })
    }
}

/// Fits parameters of a scene's body to measured frequencies.
///
/// # Errors
/// [`FitError`].
pub fn fit(
    scene: &Scene,
    builder: &Builder,
    settings: &FitSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<FitReport, FitError> {
    Fit::new(scene, builder, settings, progress)?.run()
}

fn names(parameters: &[Parameter]) -> Vec<String> {
    parameters.iter().map(|parameter| parameter.name.clone()).collect()
}

/// Standard deviations of the measured frequencies, and true if they are stated: of all of them or of none.
fn deviations(measured: &Measured, relative: Option<f64>) -> Result<(Vec<f64>, bool), FitError> {
    let of = |mode: &scene::MeasuredMode| mode.deviation.or(relative.map(|relative| relative * mode.frequency));
    let stated: Vec<f64> = measured.modes.iter().filter_map(of).collect();
    if stated.is_empty() {
        return Ok((measured.modes.iter().map(|mode| mode.frequency).collect(), false));
    }
    match measured.modes.iter().find(|mode| of(mode).is_none()) {
        Some(mode) => Err(FitError::SomeDeviations { file: measured.file.clone(), line: mode.line }),
        None => Ok((stated, true)),
    }
}
