//! Outputs that see nothing, inputs that move nothing, and motions that grow.

use faer::c64;
use linear::SecondOrder;

/// A row or a column below this part of the largest is rounding.
const NOTHING: f64 = 1e-12;
/// Growth below this part of the fastest pole is rounding.
const STILL: f64 = 1e-8;

/// Sentences about the outputs and inputs of equations that do nothing.
pub(super) fn unseen(equations: &SecondOrder) -> Vec<String> {
    let SecondOrder { forces, inputs, outputs, .. } = equations;
    let largest = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, |most: f64, x| most.max(x.abs()));
    // Of outputs of one unit, and of all inputs, the largest is the measure.
    let of_outputs: Vec<f64> = outputs
        .iter()
        .map(|output| largest(&mut output.rows.iter().flatten().chain(&output.direct).copied()))
        .collect();
    let of_unit = |k: usize| {
        let unit = &outputs[k].channel.unit;
        largest(&mut (0..outputs.len()).filter(|i| outputs[*i].channel.unit == *unit).map(|i| of_outputs[i]))
    };
    let blind = (0..outputs.len()).filter(|k| of_outputs[*k] <= NOTHING * of_unit(*k));
    let blind: Vec<&str> = blind.map(|k| &outputs[k].channel.name[..]).collect();
    let of_inputs: Vec<f64> = forces.col_iter().map(|column| largest(&mut column.iter().copied())).collect();
    let most = largest(&mut of_inputs.iter().copied());
    let idle = (0..inputs.len()).filter(|j| of_inputs[*j] <= NOTHING * most);
    let idle: Vec<&str> = idle.map(|j| &inputs[j].name[..]).collect();
    let mut found = Vec::new();
    if !blind.is_empty() {
        found.push(format!("outputs that see nothing, as of what a support holds: {}", blind.join(", ")));
    }
    if !idle.is_empty() {
        found.push(format!("inputs that move nothing: {}", idle.join(", ")));
    }
    found
}

/// A sentence about poles that grow; none where all decay or stay.
pub(super) fn growing(poles: &[c64]) -> Option<String> {
    let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let growing = poles.iter().filter(|pole| pole.im >= 0.0 && pole.re > STILL * fastest);
    let (count, most) = growing.fold((0, 0.0_f64), |(count, most), pole| (count + 1, most.max(pole.re)));
    (count > 0).then(|| {
        format!("unstable: {count} motions grow, the fastest at {most:.3e} per time; small motions do not stay small")
    })
}
