//! Names and units of inputs and outputs.

use diagnostic::{Failure, Kind};
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

/// Displacement, velocity and acceleration of a point along the axes of its body, by its displacement in each coordinate.
pub(super) fn point_outputs(scene: &Shared, name: &str, columns: &[Vector3<f64>]) -> Vec<Output> {
    let UnitLabels { length, time, .. } = (&scene.units).into();
    let rates = [
        (Rate::Place, "displacement", length.to_owned()),
        (Rate::Velocity, "velocity", format!("{length}/{time}")),
        (Rate::Acceleration, "acceleration", format!("{length}/{time}²")),
    ];
    let mut outputs = Vec::new();
    for (rate, quantity, unit) in rates {
        for (axis, channel) in along_axes(&format!("{name}.{quantity}"), &unit).into_iter().enumerate() {
            outputs.push(Output::new(channel, rate, columns.iter().map(|column| column[axis]).collect()));
        }
    }
    outputs
}

/// Acceleration of a point relative to the support, along the axes of the body, by its displacement in each coordinate.
pub(super) fn relative_outputs(scene: &Shared, name: &str, columns: &[Vector3<f64>]) -> Vec<Output> {
    let channels = along_axes(&format!("{name}.acceleration_relative"), &UnitLabels::from(&scene.units).acceleration());
    let row = |axis: usize| columns.iter().map(|column| column[axis]).collect();
    let channels = channels.into_iter().enumerate();
    channels.map(|(axis, channel)| Output::new(channel, Rate::Acceleration, row(axis))).collect()
}

/// Stress components of a point, body axes, by those of each modal displacement in each material there; `over` makes a row over the
/// coordinates of one over the modes.
pub(super) fn stress_outputs(
    scene: &Shared,
    name: &str,
    materials: &[Vec<[f64; 6]>],
    over: impl Fn(&[f64]) -> Vec<f64>,
) -> Vec<Output> {
    let unit = UnitLabels::from(&scene.units).stress();
    let mut outputs = Vec::new();
    for (number, shapes) in materials.iter().enumerate() {
        let material = if materials.len() > 1 { format!("[{number}]") } else { String::new() };
        for (component, letters) in STRESS.into_iter().enumerate() {
            let of_modes: Vec<f64> = shapes.iter().map(|stress| stress[component]).collect();
            let channel = Channel::new(format!("{name}.stress{material}.{letters}"), unit.clone());
            outputs.push(Output::new(channel, Rate::Place, over(&of_modes)));
        }
    }
    outputs
}

/// Names and units of the six components of a force and a moment.
pub(super) fn wrench_channels(scene: &Shared, name: &str) -> Vec<Channel> {
    let units = UnitLabels::from(&scene.units);
    let force = along_axes(&format!("{name}.force"), &units.force());
    force.into_iter().chain(along_axes(&format!("{name}.moment"), &units.moment())).collect()
}
