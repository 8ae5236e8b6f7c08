//! OP4 of Nastran, as text: matrices in the coordinates of Craig and Bampton.
//!
//! Coordinates are the six motions of the base (translations along and rotations about the axes of the mesh, through the origin), then the
//! modes: the interface of a body that one rigid support holds, and its internal coordinates. `TREC` takes them to the
//! displacements and rotations of the nodes, six rows for each.

use std::fmt::Write;

use faer::Mat;

use super::reduced::Reduced;

/// Motions of the base.
const BASE: usize = 6;
/// Digits of a number after its point, its length, and numbers in a line: all digits of a double.
const FORMAT: &str = "1P,3E23.16";
const PER_LINE: usize = 3;

/// The text of the file.
pub fn text(body: &Reduced<'_>) -> String {
    let size = BASE + body.count();
    let [mut mass, mut stiffness, mut damping] = [(); 3].map(|()| Mat::<f64>::zeros(size, size));
    for (i, j) in (0..BASE).flat_map(|i| (0..BASE).map(move |j| (i, j))) {
        mass[(i, j)] = body.rigid_mass[(i, j)];
    }
    for k in 0..body.count() {
        let row = BASE + k;
        for i in 0..3 {
            for (column, value) in [(i, body.momenta[k][i]), (3 + i, body.angular_momenta[k][i])] {
                mass[(row, column)] = value;
                mass[(column, row)] = value;
            }
        }
        mass[(row, row)] = 1.0;
        stiffness[(row, row)] = body.omegas[k].powi(2);
        damping[(row, row)] = body.damping(k);
    }
    let mut recovery = Mat::<f64>::zeros(6 * body.nodes.len(), size);
    for (n, node) in body.nodes.iter().enumerate() {
        let arm = node.position.cross_matrix();
        for i in 0..3 {
            recovery[(6 * n + i, i)] = 1.0;
            recovery[(6 * n + 3 + i, 3 + i)] = 1.0;
            for j in 0..3 {
                recovery[(6 * n + i, 3 + j)] = -arm[(i, j)];
            }
            for k in 0..body.count() {
                recovery[(6 * n + i, BASE + k)] = node.shapes[k][i];
                recovery[(6 * n + 3 + i, BASE + k)] = node.turns[k][i];
            }
        }
    }
    let mut text = String::new();
    for (name, matrix, form) in [
        ("MXX", &mass, SYMMETRIC),
        ("KXX", &stiffness, SYMMETRIC),
        ("BXX", &damping, SYMMETRIC),
        ("TREC", &recovery, OTHER),
    ] {
        if matrix.nrows() > 0 {
            write(&mut text, name, matrix, form);
        }
    }
    text
}

/// Forms of a matrix.
const SYMMETRIC: usize = 6;
const OTHER: usize = 2;
/// Type of a matrix of real numbers in double precision.
const DOUBLE: usize = 2;

/// A matrix: a head, then for each column that is not zero its first row and its numbers from there, then one column more.
fn write(text: &mut String, name: &str, matrix: &Mat<f64>, form: usize) {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    // Writing to a text does not fail.
    _ = writeln!(text, "{columns:8}{rows:8}{form:8}{DOUBLE:8}{name:8}{FORMAT}");
    for (c, column) in matrix.col_iter().enumerate() {
        let filled = |value: &f64| *value != 0.0;
        let (Some(first), Some(last)) = (column.iter().position(filled), column.iter().rposition(filled)) else {
            continue;
        };
        _ = writeln!(text, "{:8}{:8}{:8}", c + 1, first + 1, last + 1 - first);
        let numbers: Vec<String> = (first..=last).map(|i| number(column[i])).collect();
        numbers.chunks(PER_LINE).for_each(|line| _ = writeln!(text, "{}", line.concat()));
    }
    _ = writeln!(text, "{:8}{:8}{:8}\n{}", columns + 1, 1, 1, number(1.0));
}

/// A number as Fortran's 1P,E23.16 writes it.
fn number(value: f64) -> String {
    let text = format!("{value:.16E}");
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
    let exponent = if digits.len() > 2 { format!("{sign}{digits}") } else { format!("E{sign}{digits:0>2}") };
    format!("{:>23}", format!("{mantissa}{exponent}"))
}
