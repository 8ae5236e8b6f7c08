//! Outputs that see nothing, and inputs that move nothing.

use linear::{Channel, SecondOrder};

/// A row or a column below this part of the largest of its unit is rounding.
const NOTHING: f64 = 1e-12;

/// Sentences about the outputs and inputs of equations that do nothing; the `whole` equations, with coordinates that may be left out, say
/// what is much.
pub(super) fn unseen(whole: &SecondOrder, equations: &SecondOrder) -> Vec<String> {
    let SecondOrder { inputs, outputs, .. } = equations;
    let seen = |of: &SecondOrder| -> Vec<f64> {
        of.outputs.iter().map(|output| largest(output.rows.iter().flatten().chain(&output.direct))).collect()
    };
    let of_outputs: Vec<&Channel> = outputs.iter().map(|output| &output.channel).collect();
    let blind = nothing(&of_outputs, &seen(whole), &seen(equations));
    let moved = |of: &SecondOrder| -> Vec<f64> { of.forces.col_iter().map(|column| largest(column.iter())).collect() };
    let of_inputs: Vec<&Channel> = inputs.iter().collect();
    let mut idle = nothing(&of_inputs, &moved(whole), &moved(equations));
    // An input may act on outputs by itself, as the motion of a base does.
    for output in outputs.iter().filter(|output| !output.direct.is_empty()) {
        let direct: Vec<f64> = output.direct.iter().map(|x| x.abs()).collect();
        let without = nothing(&of_inputs, &direct, &direct);
        idle.retain(|j| without.contains(j));
    }
    let names = |of: &[&Channel], numbers: &[usize]| -> String {
        numbers.iter().map(|k| &of[*k].name[..]).collect::<Vec<_>>().join(", ")
    };
    let mut found = Vec::new();
    if !blind.is_empty() {
        let names = names(&of_outputs, &blind);
        found.push(format!("outputs that see nothing, as of what a support holds: {names}"));
    }
    if !idle.is_empty() {
        found.push(format!("inputs that move nothing: {}", names(&of_inputs, &idle)));
    }
    found
}

/// Channels whose numbers are rounding beside the largest of their unit in the whole equations.
fn nothing(channels: &[&Channel], whole: &[f64], own: &[f64]) -> Vec<usize> {
    let of_unit = |k: usize| {
        let alike = channels.iter().zip(whole).filter(|(channel, _)| channel.unit == channels[k].unit);
        alike.map(|(_, size)| *size).fold(0.0, f64::max)
    };
    (0..channels.len()).filter(|k| own[*k] <= NOTHING * of_unit(*k)).collect()
}

fn largest<'a>(list: impl Iterator<Item = &'a f64>) -> f64 {
    list.fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use faer::Mat;
    use linear::{Output, Rate};

    use super::*;

    /// Two modes, the first of which is rigid, with forces and accelerations of the base as inputs.
    fn equations(columns: &[([f64; 2], &str, &str)], direct: Vec<f64>) -> SecondOrder {
        let acceleration =
            Output { direct, ..Output::new(Channel::new("tip", "m/s²"), Rate::Acceleration, vec![1.0, 1.0]) };
        SecondOrder {
            stiffness: Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i == 1 && j == 1))),
            damping: Mat::zeros(2, 2),
            forces: Mat::from_fn(2, columns.len(), |i, j| columns[j].0[i]),
            inputs: columns.iter().map(|(_, name, unit)| Channel::new(*name, *unit)).collect(),
            outputs: vec![acceleration],
            coordinates: ["x1", "x2"].map(|name| Channel::new(name, "√kg m")).to_vec(),
        }
    }

    #[test]
    fn an_input_that_acts_by_itself_or_is_small_in_its_unit_is_not_idle() {
        let columns = [
            ([0.0; 2], "base.x", "m/s²"),
            ([1e9, 0.0], "push", "N"),
            ([1e-6, 0.0], "turn", "N m"),
            ([0.0; 2], "idle", "N"),
        ];
        let all = equations(&columns, vec![1.0, 0.0, 0.0, 0.0]);
        assert_eq!(unseen(&all, &all), ["inputs that move nothing: idle"]);
        let all = equations(&columns, Vec::new());
        assert_eq!(unseen(&all, &all), ["inputs that move nothing: base.x, idle"]);
    }

    #[test]
    fn a_rigid_motion_moves_nothing_where_it_is_left_out() {
        let all = equations(&[([1.0, 1e-17], "weight", ""), ([1.0, 1.0], "push", "N")], Vec::new());
        assert!(unseen(&all, &all).is_empty());
        assert_eq!(unseen(&all, &all.without(&[0])), ["inputs that move nothing: weight"]);
    }
}
