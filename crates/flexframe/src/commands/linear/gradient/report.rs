//! Report of rates, for people and for scripts.

use std::fmt;
use std::path::PathBuf;

use model::{BodyRates, Parameter, ParameterRates, VariedBody};
use nalgebra::Vector3;
use serde::Serialize;

use scene::System;

use super::number::Number;
use super::responses::{self, ResponseReport};
use super::system::SystemRates;
use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::report::quantity;

/// More modes than this do not fit a page; --json and the table have all.
const SHOWN: usize = 30;
/// A relative rate below which it is rounding.
const NOTHING: f64 = 5e-7;

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
    /// Frequencies of the responses, cycles per time; empty where none were asked for.
    pub response_frequencies: Vec<f64>,
    /// Responses of the points to the loads.
    pub responses: Vec<ResponseReport>,
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
    /// Rates of the frequencies: of modes of one frequency, rates of the modes that the parameter parts, in rising order.
    pub frequencies: Vec<f64>,
    /// Relative rates of the frequencies, d ln f / d ln p.
    pub relative: Vec<f64>,
    /// Rates of the effective masses.
    pub effective_masses: Vec<[f64; 3]>,
    /// Rates of the static displacements, in their order; `null` of a load whose forces change with the shape.
    pub statics: Vec<Option<[f64; 3]>>,
    /// Rates of the responses, in their order: real and imaginary part at each frequency; `null` as of static displacements.
    pub responses: Vec<Option<Vec<[f64; 2]>>>,
}

impl GradientReport {
    pub(super) fn new(
        body: &VariedBody,
        parameters: &[Parameter],
        found: &BodyRates,
        response_frequencies: Vec<f64>,
    ) -> Self {
        let scene = body.scene();
        let (loads, damping) = (body.load_names(), &scene.modes.damping);
        let points: Vec<String> = scene.output.points.keys().cloned().collect();
        let of_parameter = |(parameter, rates): (&Parameter, &ParameterRates)| {
            let value = parameter.value(body.body());
            let of_statics = rates.statics.iter().flatten().flat_map(|of_load| match of_load {
                Some(of_points) => of_points.iter().map(|rate| Some((*rate).into())).collect(),
                None => vec![None; points.len()],
            });
            let of_frequencies = rates.frequencies.iter().zip(&found.frequencies);
            ParameterReport {
                name: parameter.name.clone(),
                value,
                frequencies: rates.frequencies.clone(),
                relative: of_frequencies.map(|(rate, f)| value * rate / f).collect(),
                effective_masses: rates.effective_masses.clone().unwrap_or_default(),
                statics: of_statics.collect(),
                responses: if response_frequencies.is_empty() {
                    Vec::new()
                } else {
                    responses::rates(found, rates, points.len(), damping, &response_frequencies)
                },
            }
        };
        let of_load = |(load, of_points): (&String, &Vec<Vector3<f64>>)| {
            let of_point = |(point, u): (&String, &Vector3<f64>)| StaticReport {
                load: load.clone(),
                point: point.clone(),
                displacement: (*u).into(),
            };
            points.iter().zip(of_points).map(of_point).collect::<Vec<_>>()
        };
        Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(&scene.units.time),
            frequencies: found.frequencies.clone(),
            repeated: found.repeated.iter().map(|group| [group.start + 1, group.end]).collect(),
            effective_masses: found.effective_masses.clone().unwrap_or_default(),
            statics: loads.iter().zip(found.statics.iter().flatten()).flat_map(of_load).collect(),
            responses: if response_frequencies.is_empty() {
                Vec::new()
            } else {
                responses::responses(found, [&loads, &points], damping, &response_frequencies)
            },
            parameters: parameters.iter().zip(&found.rates).map(of_parameter).collect(),
            response_frequencies,
            files: Vec::new(),
        }
    }

    /// Rates of the frequencies and responses of bodies in joints.
    pub(super) fn of_system(
        system: &System,
        parameters: &[Number],
        found: SystemRates,
        response_frequencies: Vec<f64>,
    ) -> Self {
        let SystemRates { frequencies, repeated, rates, responses } = found;
        let of_parameter = |((parameter, rates), of_responses): ((&Number, Vec<f64>), Vec<_>)| {
            let value = parameter.value(system);
            ParameterReport {
                name: parameter.name.clone(),
                value,
                relative: rates.iter().zip(&frequencies).map(|(rate, f)| value * rate / f).collect(),
                frequencies: rates,
                effective_masses: Vec::new(),
                statics: Vec::new(),
                responses: of_responses,
            }
        };
        Self {
            title: system.title.clone(),
            frequency_unit: frequency_unit(&system.units.time),
            repeated: repeated.into_iter().map(|group| [group.start + 1, group.end]).collect(),
            effective_masses: Vec::new(),
            statics: Vec::new(),
            responses: responses.responses,
            response_frequencies,
            parameters: parameters.iter().zip(rates).zip(responses.rates).map(of_parameter).collect(),
            frequencies,
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
        for (k, frequency) in self.frequencies.iter().enumerate().take(SHOWN) {
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
