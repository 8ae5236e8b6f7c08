//! The Flex file of NASA's 42 (`.flex42`): modes at nodes, matrices, and the modal integrals of the whole mesh.
//!
//! Its order and its integrals are those of `InitFlexModes` in `42init.c`. Nodes are numbered as in the file, and 42's file of nodes has to
//! name them in the same order; the shapes of joints are left out, since their numbers are those of the spacecraft.

use std::fmt::Write;

use super::reduced::Reduced;

/// The text of the file.
pub fn text(body: &Reduced<'_>) -> String {
    let count = body.count();
    let mut lines = vec!["<<<<<<<<<<<<<<  Flexible Body Inputs for 42  >>>>>>>>>>>>>>>>>>>".to_owned()];
    lines.push(format!("{} ! Description", body.title.split_whitespace().collect::<Vec<_>>().join(" ")));
    lines.push(format!("{count} ! Number of Flex Modes"));
    lines.push(title("Initial Modal States x, u"));
    lines.extend((0..count).map(|k| format!("0.0 0.0 ! Mode {k}  x, u")));
    lines.push(title("Joint Node Mode Shapes"));
    for name in ["Non-zero Translation Mode Shape (PSI) Elements", "Non-zero Rotation Mode Shape (THETA) Elements"] {
        sparse(&mut lines, name, "[Mode] [Joint] [Axis] Value", std::iter::empty());
    }
    lines.push(title("Analysis Node Mode Shapes"));
    let places =
        || (0..count).flat_map(|k| (0..body.nodes.len()).flat_map(move |n| (0..3).map(move |axis| (k, n, axis))));
    let shapes = places().map(|(k, n, axis)| (vec![k, n, axis], body.nodes[n].shapes[k][axis]));
    sparse(&mut lines, "Non-zero Translation Mode Shape (PSI) Elements", "[Mode] [Node] [Axis] Value", shapes);
    let turns = places().map(|(k, n, axis)| (vec![k, n, axis], body.nodes[n].turns[k][axis]));
    sparse(&mut lines, "Non-zero Rotation Mode Shape (THETA) Elements", "[Mode] [Node] [Axis] Value", turns);
    let diagonals: [(&str, &dyn Fn(usize) -> f64); 3] =
        [("Mass", &|_| 1.0), ("Stiffness", &|k| body.omegas[k].powi(2)), ("Damping", &|k| body.damping(k))];
    for (name, value) in diagonals {
        let entries = (0..count).map(|k| (vec![k, k], value(k)));
        sparse(&mut lines, &format!("Non-zero {name} Matrix Elements"), "[Row] [Col] Value", entries);
    }
    for (name, integrals) in [
        ("Linear Momentum Modal Integral, Pf, 3 x Nf", &body.momenta),
        ("Angular Momentum Modal Integral, Hf, 3 x Nf", &body.angular_momenta),
    ] {
        lines.push(title(name));
        let line = |(k, v): (usize, &nalgebra::Vector3<f64>)| {
            format!("{:.16e} {:.16e} {:.16e} ! Mode {k}, [x y z]", v.x, v.y, v.z)
        };
        lines.extend(integrals.iter().enumerate().map(line));
    }
    let axes = || (0..3).flat_map(|a| (0..3).map(move |b| (a, b)));
    // ∫ X_a φ_b dm.
    let linear = axes().flat_map(|(a, b)| (0..count).map(move |k| (vec![a, b, k], body.with_position[k][(b, a)])));
    sparse(&mut lines, "Linear Modal Integral, L, 3 x 3 x Nf", "[i] [j] [Mode] Value", linear);
    let pairs = || (0..count).flat_map(|j| (0..count).map(move |k| (j, k)));
    let angular = axes().flat_map(|(a, b)| pairs().map(move |(j, k)| (vec![a, b, j, k], body.product(j, k)[(a, b)])));
    sparse(&mut lines, "Angular Modal Integral, N, 3 x 3 x Nf x Nf", "[i] [j] [Mode] [Mode] Value", angular);
    lines.push("[EOF]".to_owned());
    lines.join("\n") + "\n"
}

fn title(name: &str) -> String {
    format!("**************** {name} ****************")
}

/// The entries that are not zero, by their indices, with their number before them.
fn sparse(lines: &mut Vec<String>, name: &str, key: &str, entries: impl Iterator<Item = (Vec<usize>, f64)>) {
    let entries: Vec<_> = entries.filter(|(_, value)| *value != 0.0).collect();
    lines.push(title(name));
    lines.push(format!("{} ! Number of non-zero elements", entries.len()));
    lines.extend(entries.iter().map(|(indices, value)| {
        let mut line = String::new();
        // Writing to a text does not fail.
        indices.iter().for_each(|index| _ = write!(line, "{index} "));
        format!("{line}{value:.16e} ! {key}")
    }));
}
