//! Names and units of inputs and outputs.

use diagnostic::{Failure, Kind};
use dynamics::PointShapes;
use faer::Mat;
use linear::{Channel, Output, Rate, SecondOrder};
use model::Model;
use nalgebra::Vector3;
use scene::{Body, Load, Shared};

use super::settings::LinearSettings;
use crate::commands::linear::names::{STRESS, is_asked};
use crate::rows::units::UnitLabels;

/// Equations with all the channels that a scene may have.
pub(super) struct Channels {
    pub equations: SecondOrder,
    /// Numbers of inputs and of outputs that are there unless others are asked for: the first ones.
    pub usual: [usize; 2],
    /// Inputs that would be there if they were asked for.
    pub more_inputs: Vec<String>,
}

impl Channels {
    /// The equations with the channels that are asked for.
    pub fn chosen(self, settings: &LinearSettings, scene: &Shared) -> Result<SecondOrder, Failure> {
        let Self { equations, usual, more_inputs } = self;
        let inputs: Vec<&str> = equations.inputs.iter().map(|channel| &channel.name[..]).collect();
        let outputs: Vec<&str> = equations.outputs.iter().map(|output| &output.channel.name[..]).collect();
        let pick = |what, list: &[&str], more: &[String], asked: &[String], usual: usize| {
            if let Some(found) = asked.iter().find(|asked| !list.iter().any(|name| is_asked(name, asked))) {
                let known: Vec<&str> = list.iter().copied().chain(more.iter().map(String::as_str)).collect();
                let expected = format!("one of {}", known.join(", "));
                let words = format!("no {what} `{found}`; expected {expected}");
                return Err(Kind::Usage.of(&scene.path).found(found).expected(expected).says(words));
            }
            let is_picked = |k: &usize| match asked {
                [] => *k < usual,
                asked => asked.iter().any(|asked| is_asked(list[*k], asked)),
            };
            Ok((0..list.len()).filter(is_picked).collect::<Vec<_>>())
        };
        let inputs = pick("input", &inputs, &more_inputs, &settings.inputs, usual[0])?;
        let outputs = pick("output", &outputs, &[], &settings.outputs, usual[1])?;
        let nothing = |what, help: &str| Err(Kind::Usage.of(&scene.path).help(help).says(format!("no {what}")));
        if inputs.is_empty() {
            return nothing(
                "inputs",
                "give the scene loads (their history does not matter) or joints that turn or slide, or ask for the motion of the base \
                 or of a drive (--inputs base)",
            );
        }
        if outputs.is_empty() {
            return nothing("outputs", "name points in [output], or give the scene joints that turn or slide");
        }
        Ok(equations.with_channels(&inputs, &outputs))
    }
}

/// Channels of a vector along three axes: their name with the letter of each.
pub(super) fn along_axes(name: &str, unit: &str) -> [Channel; 3] {
    ["x", "y", "z"].map(|axis| Channel::new(format!("{name}.{axis}"), unit))
}

/// The unit of a coordinate of unit mass: √mass · length.
pub(super) fn unit_of_coordinate(scene: &Shared) -> String {
    format!("√{} {}", scene.units.mass, scene.units.length)
}

/// The loads of a model, with their numbers in the scene.
pub(in crate::commands::linear) fn acting_loads<'a>(
    body: &'a Body,
    model: &Model,
) -> impl Iterator<Item = (usize, &'a Load)> {
    // Gravity that the scene does not call for is not among them.
    let all = body.loads.len() == model.loads().len();
    body.loads.iter().enumerate().filter(move |(_, load)| all || !load.is_gravity())
}

/// The acceleration of the support, global axes, that each load that acts stands for where its history is 1: zero of most.
pub(super) fn base_accelerations(body: &Body, model: &Model) -> Vec<Vector3<f64>> {
    acting_loads(body, model).map(|(_, load)| load.base_acceleration().into()).collect()
}

/// An input for each load that acts: its factor, so that 1 is the load as the scene has it where its history is 1.
pub(in crate::commands::linear) fn input_channels(body: &Body, model: &Model, prefix: &str) -> Vec<Channel> {
    let names: Vec<String> =
        acting_loads(body, model).map(|(i, load)| format!("{prefix}loads[{i}].{}", load.kind.name())).collect();
    (0..model.loads().len())
        .map(|k| Channel::new(names.get(k).cloned().unwrap_or_else(|| format!("{prefix}load{k}")), "factor"))
        .collect()
}

/// Displacements of the points of a body and stresses there, by rows over its coordinates: ρ and φ of its frame, and δq.
pub(in crate::commands::linear) struct BodyRows<'a> {
    given: &'a Body,
    model: &'a Model,
    modal_displacement: &'a [f64],
    /// With large modes, the slopes of what modes do over their coordinates.
    slopes: Option<Vec<Vec<f64>>>,
    /// The beginning of the names of its channels, where others have bodies, too.
    pub prefix: String,
}

impl<'a> BodyRows<'a> {
    pub fn new(given: &'a Body, model: &'a Model, modal_displacement: &'a [f64], is_alone: bool) -> Self {
        let name = given.name.as_ref().filter(|_| !is_alone);
        let prefix = name.map_or_else(String::new, |name| format!("{name}."));
        Self { given, model, modal_displacement, slopes: model.coordinate_slopes(modal_displacement), prefix }
    }

    /// The name of each point, with its displacement along the axes of the body.
    pub fn points(&self) -> Vec<(String, [Vec<f64>; 3])> {
        let of_point = |(name, point): &(String, PointShapes)| {
            let arm = self.model.arm(point, self.modal_displacement);
            // ρ + φ×x + Ψ δq.
            let column = |k: usize| match k {
                0..3 => Vector3::ith(k, 1.0),
                3..6 => Vector3::ith(k - 3, 1.0).cross(&arm),
                _ => self.slopes.as_ref().map_or(point.columns()[k], |slopes| {
                    point.columns()[6..].iter().zip(&slopes[k - 6]).map(|(shape, slope)| *shape * *slope).sum()
                }),
            };
            let columns: Vec<Vector3<f64>> = (0..6 + self.modal_displacement.len()).map(column).collect();
            let row = |axis: usize| columns.iter().map(|column| column[axis]).collect();
            (format!("{}{name}", self.prefix), [0, 1, 2].map(row))
        };
        self.model.points.iter().map(of_point).collect()
    }

    /// Stress components of each point in each material there, body axes.
    pub fn stresses(&self) -> Vec<(Channel, Vec<f64>)> {
        let unit = UnitLabels::from(&self.given.units).stress();
        let of_stress = self.model.stress.as_ref().map_or(&[][..], |stress| stress.of_points());
        let mut rows = Vec::new();
        for ((name, _), materials) in self.model.points.iter().zip(of_stress) {
            for (number, shapes) in materials.iter().enumerate() {
                let material = if materials.len() > 1 { format!("[{number}]") } else { String::new() };
                for (component, letters) in STRESS.into_iter().enumerate() {
                    let of = |k: usize| match &self.slopes {
                        None => shapes[k][component],
                        Some(slopes) => shapes.iter().zip(&slopes[k]).map(|(of, slope)| of[component] * slope).sum(),
                    };
                    let modes = (0..self.modal_displacement.len()).map(of);
                    let name = format!("{}{name}.stress{material}.{letters}", self.prefix);
                    rows.push((Channel::new(name, unit.clone()), [0.0; 6].into_iter().chain(modes).collect()));
                }
            }
        }
        rows
    }
}

/// A row over the coordinates from `first` on, over independent coordinates by their columns.
pub(super) fn over_columns(row: &[f64], basis: &Mat<f64>, first: usize) -> Vec<f64> {
    let along = |j: usize| row.iter().enumerate().map(|(k, r)| r * basis[(first + k, j)]).sum();
    (0..basis.ncols()).map(along).collect()
}

/// Displacement, velocity and acceleration of a point along the axes of its body, by rows of its displacement.
pub(super) fn point_outputs(scene: &Shared, name: &str, rows: &[Vec<f64>; 3]) -> Vec<Output> {
    let UnitLabels { length, time, .. } = (&scene.units).into();
    let rates = [
        (Rate::Place, "displacement", length.to_owned()),
        (Rate::Velocity, "velocity", format!("{length}/{time}")),
        (Rate::Acceleration, "acceleration", format!("{length}/{time}²")),
    ];
    let of_rate = |(rate, quantity, unit): (Rate, &str, String)| {
        let channels = along_axes(&format!("{name}.{quantity}"), &unit);
        channels.into_iter().zip(rows).map(move |(channel, row)| Output::new(channel, rate, row.clone()))
    };
    rates.into_iter().flat_map(of_rate).collect()
}

/// Acceleration of a point relative to the support, along the axes of the body, by rows of its displacement.
pub(super) fn relative_outputs(scene: &Shared, name: &str, rows: &[Vec<f64>; 3]) -> Vec<Output> {
    let channels = along_axes(&format!("{name}.acceleration_relative"), &UnitLabels::from(&scene.units).acceleration());
    channels.into_iter().zip(rows).map(|(channel, row)| Output::new(channel, Rate::Acceleration, row.clone())).collect()
}

/// Names and units of the six components of a force and a moment.
pub(super) fn wrench_channels(scene: &Shared, name: &str) -> Vec<Channel> {
    let units = UnitLabels::from(&scene.units);
    let force = along_axes(&format!("{name}.force"), &units.force());
    force.into_iter().chain(along_axes(&format!("{name}.moment"), &units.moment())).collect()
}
