//! Standard Input Data of a flexible body (Wallrapp 1994), as SIMPACK and Modelica's FlexibleBodies read it.
//!
//! Terms are those of Schwertassek and Wallrapp, "Dynamik flexibler Mehrkörpersysteme" (1999), 6.4: Taylor polynomials m0 + Σ m1_k q_k in
//! the modal coordinates, where the entry `m1(i,k,j)` is that of row i, coordinate k and column j, and zeros are left out. `J` is the
//! list xx, yy, zz, xy, xz, yz. Stiffening by the spin is the part of `Oe` that is linear in the coordinates.

use std::fmt::Write;

use nalgebra::{Matrix3, Vector3};

use super::reduced::Reduced;

/// Pairs of spins in the order of `Oe`, and their places in the list 11, 22, 33, 23, 13, 12 of the stiffness.
const SPINS: [(usize, usize, usize); 6] = [(0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 5), (1, 2, 3), (0, 2, 4)];

/// Places of the entries of `J`.
const INERTIA: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// The text of the file.
pub fn text(body: &Reduced<'_>) -> String {
    let count = body.count();
    let (nodes, title) = (body.nodes.len(), one_line(body.title));
    let mut text = format!("{nodes:5}{count:5} :No. nodes, No. modes: {title}\npart\n    new modal\n        refmod\n");
    // Writing to a text does not fail.
    _ = writeln!(text, "            mass           = {}\n            nelastq        = {count}", number(body.mass));
    for (k, omega) in body.omegas.iter().enumerate() {
        let frequency = omega / std::f64::consts::TAU;
        _ = writeln!(text, "            ielastq ({:4}) = Eigen Mode {:4} : {frequency:14.6} Hz", k + 1, k + 1);
    }
    text.push_str("        end refmod\n        frame\n");
    for (n, node) in body.nodes.iter().enumerate() {
        _ = writeln!(text, "            new node = {}\n                rframe = body ref", n + 1);
        let vector = |of: Vector3<f64>| move |i: usize, _: usize| of[i];
        let shapes = |of: &[Vector3<f64>]| {
            let of = of.to_vec();
            move |i: usize, k: usize| of[k][i]
        };
        let origin = Taylor::full("origin", 3, 1).of(vector(node.position)).linear(count, |i, _, k| node.shapes[k][i]);
        let tilt = |i: usize, j: usize, k: usize| node.turns[k].cross_matrix()[(i, j)];
        let axes = Taylor::full("AP", 3, 3).of(|i, j| f64::from(u8::from(i == j))).linear(count, tilt);
        let parts = [
            origin,
            Taylor::full("phi", 3, count).of(shapes(&node.shapes)),
            Taylor::full("psi", 3, count).of(shapes(&node.turns)),
            axes,
            Taylor::zero("sigma", 6, 1),
        ];
        parts.iter().for_each(|part| part.write(&mut text, 16));
        text.push_str("            end node\n");
    }
    text.push_str("        end frame\n");
    for part in terms(body) {
        part.write(&mut text, 8);
    }
    text.push_str("    end modal\nend part\n");
    text
}

/// The matrices of the equations of motion.
fn terms(body: &Reduced<'_>) -> Vec<Taylor> {
    let count = body.count();
    let cross: Vec<Matrix3<f64>> = (0..count).map(|k| body.cross_with_position(k)).collect();
    let by_column = |k: usize| (k / 3, k % 3);
    let gyroscopic = |i: usize, column: usize| {
        let (k, j) = by_column(column);
        2.0 * cross[k][(i, j)]
    };
    // −2 ∫ φ_kᵀ [φ_l×] dm.
    let coriolis = |k: usize, column: usize| {
        let (l, j) = by_column(column);
        -2.0 * body.cross(k, l)[j]
    };
    // ∫ φ_kᵀ [ω×][ω×] v dm of a pair of spins, by ∫ φ_k vᵀ dm.
    let centrifugal = |of: &Matrix3<f64>, pair: usize| {
        let (a, b, _) = SPINS[pair];
        if a == b { of[(a, a)] - of.trace() } else { of[(a, b)] + of[(b, a)] }
    };
    let of_shapes = |k: usize, pair: usize, l: usize| {
        let stiffness = body.spin_stiffness.map_or(0.0, |stiffness| {
            let (a, b, place) = SPINS[pair];
            stiffness[place][(k, l)] * if a == b { 1.0 } else { 2.0 }
        });
        centrifugal(&body.product(k, l), pair) + stiffness
    };
    let diagonal = |name, value: &dyn Fn(usize) -> f64| Taylor::diagonal(name, count, value);
    vec![
        Taylor::full("mdCM", 3, 1).of(|i, _| body.mass * body.center[i]).linear(count, |i, _, k| body.momenta[k][i]),
        Taylor::full("J", 6, 1)
            .of(|i, _| body.inertia[INERTIA[i]])
            .linear(count, |i, _, k| (cross[k] + cross[k].transpose())[INERTIA[i]]),
        Taylor::full("Ct", count, 3).of(|k, i| body.momenta[k][i]),
        Taylor::full("Cr", count, 3).of(|k, i| body.angular_momenta[k][i]).linear(count, |k, i, l| body.cross(l, k)[i]),
        Taylor { structure: 4, ..Taylor::zero("Me", count, count) },
        Taylor::full("Gr", 3, 3 * count).of(gyroscopic),
        Taylor::full("Ge", count, 3 * count).of(coriolis),
        Taylor::full("Oe", count, 6).of(|k, pair| centrifugal(&body.with_position[k], pair)).linear(count, of_shapes),
        Taylor::zero("ksigma", count, 1),
        diagonal("Ke", &|k| body.omegas[k].powi(2)),
        diagonal("De", &|k| body.damping(k)),
    ]
}

/// A polynomial of matrices.
struct Taylor {
    name: &'static str,
    rows: usize,
    columns: usize,
    /// 0 of zeros, 1 diagonal, 3 full, 4 the identity.
    structure: usize,
    constant: Vec<f64>,
    /// Number of coordinates, and the parts linear in them by row, column, coordinate.
    linear: Option<(usize, Vec<f64>)>,
}

impl Taylor {
    fn full(name: &'static str, rows: usize, columns: usize) -> Self {
        Self { name, rows, columns, structure: 3, constant: Vec::new(), linear: None }
    }

    fn zero(name: &'static str, rows: usize, columns: usize) -> Self {
        Self { structure: 0, ..Self::full(name, rows, columns) }
    }

    fn diagonal(name: &'static str, size: usize, value: &dyn Fn(usize) -> f64) -> Self {
        Self { structure: 1, constant: (0..size).map(value).collect(), ..Self::full(name, size, size) }
    }

    fn of(self, value: impl Fn(usize, usize) -> f64) -> Self {
        let columns = self.columns;
        let constant = (0..self.rows * columns).map(|at| value(at / columns, at % columns)).collect();
        Self { constant, ..self }
    }

    fn linear(self, count: usize, value: impl Fn(usize, usize, usize) -> f64) -> Self {
        let columns = self.columns;
        let of = |at: usize| value(at / count / columns, at / count % columns, at % count);
        let linear = (0..self.rows * columns * count).map(of).collect();
        Self { linear: Some((count, linear)), ..self }
    }

    fn write(&self, text: &mut String, indent: usize) {
        let pad = " ".repeat(indent);
        let count = self.linear.as_ref().map_or(0, |(count, _)| *count);
        let order = usize::from(count > 0);
        _ = writeln!(text, "{pad}{}", self.name);
        for (key, value) in [
            ("order", order),
            ("nrow", self.rows),
            ("ncol", self.columns),
            ("nq", count),
            ("nqn", 0),
            ("structure", self.structure),
        ] {
            _ = writeln!(text, "{pad}    {key:<12} = {value}");
        }
        for (at, value) in self.constant.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let (i, j) = if self.structure == 1 { (at, at) } else { (at / self.columns, at % self.columns) };
            _ = writeln!(text, "{pad}    m0({:2},{:2})    = {}", i + 1, j + 1, number(*value));
        }
        if let Some((count, linear)) = &self.linear {
            for (at, value) in linear.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                let (i, j, k) = (at / count / self.columns, at / count % self.columns, at % count);
                _ = writeln!(text, "{pad}    m1({:2},{:2},{:2}) = {}", i + 1, k + 1, j + 1, number(*value));
            }
        }
        _ = writeln!(text, "{pad}end {}", self.name);
    }
}

/// A number with the letter of a double of Fortran.
fn number(value: f64) -> String {
    format!("{value:.16e}").replace('e', "D")
}

/// A text without line breaks.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
