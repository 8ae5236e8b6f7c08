//! The file of MBDyn's modal joint (`.fem`): modes, matrices, and the invariants of inertia of the whole mesh.
//!
//! Groups of records and their numbers are those of `modal.cc` of MBDyn; invariants are those that it finds itself of lumped masses, which
//! are not needed so.

use std::fmt::Write;

use super::reduced::Reduced;

/// The text of the file.
pub fn text(body: &Reduced<'_>) -> String {
    let (count, nodes) = (body.count(), &body.nodes);
    let mut text = format!("** MBDyn MODAL DATA FILE\n** {}\n", one_line(body.title));
    let mut group = |number: usize, name: &str, lines: Vec<String>| {
        // Writing to a text does not fail.
        _ = writeln!(text, "**\n** RECORD GROUP {number}, {name}");
        lines.iter().for_each(|line| _ = writeln!(text, "{line}"));
    };
    let head = [
        "**   REVISION,  NODE,  NORMAL, ATTACHMENT, CONSTRAINT, REJECTED MODES.".to_owned(),
        format!("   REV0  {}  {count}  0  0  0", nodes.len()),
    ];
    group(1, "HEADER", head.to_vec());
    group(2, "FINITE ELEMENT NODE LIST", nodes.iter().map(|node| label(&node.name)).collect());
    for (i, axis) in ["X", "Y", "Z"].iter().enumerate() {
        let of = nodes.iter().map(|node| numbers([node.position[i]])).collect();
        group(5 + i, &format!("NODAL {axis} COORDINATES"), of);
    }
    let mut shapes = Vec::new();
    for k in 0..count {
        shapes.push(format!("**    NORMAL MODE SHAPE #  {}", k + 1));
        shapes.extend(nodes.iter().map(|node| numbers(node.shapes[k].iter().chain(&node.turns[k]).copied())));
    }
    group(8, "MODE SHAPES", shapes);
    let diagonal = |value: &dyn Fn(usize) -> f64| -> Vec<String> {
        (0..count).map(|j| numbers((0..count).map(|k| if j == k { value(k) } else { 0.0 }))).collect()
    };
    group(9, "MODAL MASS MATRIX", diagonal(&|_| 1.0));
    group(10, "MODAL STIFFNESS MATRIX", diagonal(&|k| body.omegas[k].powi(2)));
    let mut inertia = vec![numbers([body.mass]), numbers(body.center.iter().copied())];
    inertia.extend(body.central_inertia.row_iter().map(|row| numbers(row.iter().copied())));
    group(12, "RIGID BODY INERTIA MATRIX", inertia);
    group(13, "MODAL DAMPING MATRIX", diagonal(&|k| body.damping(k)));
    // Three rows, columns as the lists say.
    let rows = |column: &dyn Fn(usize) -> Vec<f64>| -> Vec<String> { (0..3).map(|i| numbers(column(i))).collect() };
    group(14, "INVARIANT 3", rows(&|i| body.momenta.iter().map(|t| t[i]).collect()));
    group(15, "INVARIANT 4", rows(&|i| body.angular_momenta.iter().map(|b| b[i]).collect()));
    let of_one =
        |i: usize| (0..count).flat_map(move |k| body.cross_with_position(k).row(i).transpose().data.0[0]).collect();
    group(16, "INVARIANT 8", rows(&of_one));
    let pairs = || (0..count).flat_map(|j| (0..count).map(move |k| (j, k)));
    group(17, "INVARIANT 5", rows(&|i| pairs().map(|(j, k)| body.cross(j, k)[i]).collect()));
    let of_pair = |i: usize| pairs().flat_map(|(j, k)| body.double_cross(j, k).row(i).transpose().data.0[0]).collect();
    group(18, "INVARIANT 9", rows(&of_pair));
    _ = writeln!(text, "**");
    text
}

/// All digits of numbers, in a line.
fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|value| format!("{value:.16e}")).collect::<Vec<_>>().join(" ")
}

/// A name without blanks, which end a label.
fn label(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join("_")
}

/// A text without line breaks.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
