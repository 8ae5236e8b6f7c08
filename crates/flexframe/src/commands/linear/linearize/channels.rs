//! Names and units of inputs and outputs.

use linear::{Channel, Output, Rate};
use model::Model;
use nalgebra::Vector3;
use scene::{Load, Scene};

use crate::rows::units::UnitLabels;

/// The unit of a coordinate of unit mass: √mass · length.
pub(super) fn unit_of_coordinate(scene: &Scene) -> String {
    format!("√{} {}", scene.units.mass, scene.units.length)
}

/// An input for each load that acts: its factor, so that 1 is the load as the scene has it where its history is 1.
pub(super) fn input_channels(scene: &Scene, model: &Model, prefix: &str) -> Vec<Channel> {
    // Gravity that the scene does not call for is not among the loads of the model.
    let all = scene.loads.len() == model.loads().len();
    let acting = scene.loads.iter().enumerate().filter(|(_, load)| all || !matches!(load, Load::Gravity(_)));
    let names: Vec<String> = acting.map(|(i, load)| format!("{prefix}loads[{i}].{}", load.kind())).collect();
    (0..model.loads().len())
        .map(|k| Channel::new(names.get(k).cloned().unwrap_or_else(|| format!("{prefix}load{k}")), "factor"))
        .collect()
}

/// Displacement, velocity and acceleration of a point along the axes of its body, by its displacement in each coordinate.
pub(super) fn point_outputs(scene: &Scene, name: &str, columns: &[Vector3<f64>]) -> Vec<Output> {
    let UnitLabels { length, time, .. } = (&scene.units).into();
    let rates = [
        (Rate::Place, "displacement", length.to_owned()),
        (Rate::Velocity, "velocity", format!("{length}/{time}")),
        (Rate::Acceleration, "acceleration", format!("{length}/{time}²")),
    ];
    let mut outputs = Vec::new();
    for (rate, quantity, unit) in rates {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            let row = columns.iter().map(|column| column[axis]).collect();
            outputs.push(Output {
                channel: Channel::new(format!("{name}.{quantity}.{letter}"), unit.clone()),
                rate,
                row,
            });
        }
    }
    outputs
}
