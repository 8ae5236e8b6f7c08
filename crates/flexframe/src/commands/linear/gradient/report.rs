//! Report of rates, for people and for scripts.

use std::fmt;
use std::path::PathBuf;

use model::{BodyRates, Parameter, VariedBody};
use nalgebra::Vector3;
use serde::Serialize;

use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::report::quantity;

/// A relative rate below which it is rounding.
const NOTHING: f64 = 5e-8;

/// Report of `flexframe gradient`.
#[derive(Debug, Clone, Serialize)]
pub struct GradientReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// Natural frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// Numbers, from 1, of the first and the last mode of each group of one frequency.
    pub repeated: Vec<[usize; 2]>,
    /// Effective masses of each mode in translations of the base along the axes of the mesh; of modes of one frequency, their mean.
    pub effective_masses: Vec<[f64; 3]>,
    /// Static displacements; empty of a body that is not held, and without loads or points of the output.
    pub statics: Vec<StaticReport>,
    /// The rates with each parameter.
    pub parameters: Vec<ParameterReport>,
    /// Files.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}

/// The static displacement of a point under a load where its history is 1.
#[derive(Debug, Clone, Serialize)]
pub struct StaticReport {
    /// The load.
    pub load: String,
    /// The point.
    pub point: String,
    /// Its displacement, axes of the mesh.
    pub displacement: [f64; 3],
}

/// Rates with a parameter: by its unit.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterReport {
    /// The path of its key, or `thickness.GROUP.AXIS`.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Of the frequencies. Of modes of one frequency they are those of the modes that the parameter parts, in rising order.
    pub frequencies: Vec<f64>,
    /// Relative rates of the frequencies, d ln f / d ln p.
    pub relative: Vec<f64>,
    /// Of the effective masses.
    pub effective_masses: Vec<[f64; 3]>,
    /// Of the static displacements, in their order; `null` of a load whose forces change with the shape.
    pub statics: Vec<Option<[f64; 3]>>,
}

impl GradientReport {
    pub(super) fn new(body: &VariedBody, parameters: &[Parameter], found: BodyRates) -> Self {
        let scene = body.scene();
        let points = || scene.output.points.keys();
        let BodyRates { frequencies, repeated, effective_masses, statics, rates, .. } = found;
        let of_parameter = |(parameter, rates): (&Parameter, model::ParameterRates)| {
            let value = parameter.value(body.body());
            let of_statics = rates.statics.unwrap_or_default().into_iter().flat_map(|of_load| match of_load {
                Some(of_points) => of_points.into_iter().map(|rate| Some(rate.into())).collect(),
                None => vec![None; points().len()],
            });
            ParameterReport {
                name: parameter.name.clone(),
                value,
                relative: rates.frequencies.iter().zip(&frequencies).map(|(rate, f)| value * rate / f).collect(),
                effective_masses: rates.effective_masses.unwrap_or_default(),
                statics: of_statics.collect(),
                frequencies: rates.frequencies,
            }
        };
        let parameters = parameters.iter().zip(rates).map(of_parameter).collect();
        let of_load = |(load, of_points): (String, Vec<_>)| {
            let of_point = |(point, u): (&String, Vector3<f64>)| StaticReport {
                load: load.clone(),
                point: point.clone(),
                displacement: u.into(),
            };
            points().zip(of_points).map(of_point).collect::<Vec<_>>()
        };
        Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(&scene.units.time),
            repeated: repeated.into_iter().map(|group| [group.start + 1, group.end]).collect(),
            effective_masses: effective_masses.unwrap_or_default(),
            statics: body.load_names().into_iter().zip(statics.unwrap_or_default()).flat_map(of_load).collect(),
            frequencies,
            parameters,
            files: Vec::new(),
        }
    }
}

impl fmt::Display for GradientReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        for (k, parameter) in self.parameters.iter().enumerate() {
            writeln!(f, "  {:<8} {} = {}", format!("[{}]", k + 1), parameter.name, quantity(parameter.value))?;
        }
        let heads = |f: &mut fmt::Formatter<'_>| {
            (1..=self.parameters.len()).try_for_each(|k| write!(f, "  {:>10}", format!("[{k}]")))
        };
        let relative = |f: &mut fmt::Formatter<'_>, rate: f64| {
            write!(f, "  {:>10.6}", if rate.abs() < NOTHING { 0.0 } else { rate })
        };
        writeln!(f, "\n  relative rates d ln f / d ln p: percent of a frequency for one percent of a parameter")?;
        write!(f, "  mode  frequency, {:<6}", self.frequency_unit)?;
        heads(f)?;
        for (k, frequency) in self.frequencies.iter().enumerate() {
            write!(f, "\n  {:>4}  {frequency:>17.6}", k + 1)?;
            self.parameters.iter().try_for_each(|parameter| relative(f, parameter.relative[k]))?;
        }
        for [first, last] in &self.repeated {
            write!(
                f,
                "\n  modes {first} to {last} have one frequency: the rates are those of the modes that a parameter parts"
            )?;
        }
        if !self.statics.is_empty() {
            write!(
                f,
                "\n\n  relative rates of static displacements, along the displacement\n  {:<24}  {:>12}",
                "load, point", "displacement"
            )?;
            heads(f)?;
        }
        for (k, answer) in self.statics.iter().enumerate() {
            let u = Vector3::from(answer.displacement);
            if u.norm() == 0.0 {
                continue;
            }
            write!(f, "\n  {:<24}  {:>12}", format!("{}, {}", answer.load, answer.point), quantity(u.norm()))?;
            for parameter in &self.parameters {
                match parameter.statics.get(k).copied().flatten() {
                    Some(rate) => {
                        let along = u.dot(&Vector3::from(rate));
                        relative(f, parameter.value * along / u.norm_squared())?;
                    }
                    None => write!(f, "  {:>10}", "-")?,
                }
            }
        }
        self.files.iter().try_for_each(|file| write!(f, "\n  wrote    {}", file.display()))
    }
}
