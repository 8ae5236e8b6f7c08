//! The ten-node tetrahedron against closed forms on finer and finer meshes: displacements of order 3 in the mean (fitted 3.01),
//! energies and frequencies of order 4 (3.95 and 3.88).
//!
//! A bar without Poisson's effect stretches by u = sin(πx/L) e_x, whether as a mode, ω = (π/L)√(E/ρ), or under the body
//! force ρω² u, which leaves its ends free of stress.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use fem_tet10::{Material, Mesh, shape_functions};
use modal::Support;

use crate::beam::order;
use crate::bodies::{Body, STEEL, block_mesh};

const SIZE: [f64; 3] = [8.0, 4.0, 4.0];
/// Cells across the bar; twice as many along it.
const CELLS: [usize; 4] = [1, 2, 3, 4];
const MATERIAL: Material = Material { poisson_ratio: 0.0, ..STEEL };

fn bar(cells: usize) -> (Mesh, Body) {
    let mesh = block_mesh(SIZE, [2 * cells, cells, cells]);
    let body = Body::new(&mesh, MATERIAL);
    (mesh, body)
}

fn stretch(x: f64) -> f64 {
    (PI * x / SIZE[0]).sin()
}

/// ω of the first mode along the bar.
fn frequency() -> f64 {
    PI / SIZE[0] * (MATERIAL.young_modulus / MATERIAL.density).sqrt()
}

/// The stretch at the nodes (3n×1).
fn at_nodes(positions: &[[f64; 3]]) -> Mat<f64> {
    Mat::from_fn(3 * positions.len(), 1, |i, _| if i % 3 == 0 { stretch(positions[i / 3][0]) } else { 0.0 })
}

/// Root of the mean of |u_h − u|² over the bar, u of amplitude 1.
fn mean_error(mesh: &Mesh, displacement: &Mat<f64>) -> f64 {
    // Gauss's rule with four points on each edge of a cube, of which one face is drawn together to an edge and a corner.
    let root = |sign: f64| (3.0 / 7.0 + sign * 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt();
    let weight = |sign: f64| (18.0 - sign * 30.0_f64.sqrt()) / 36.0;
    let rule = [(-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)]
        .map(|(side, sign): (f64, f64)| (0.5 + 0.5 * side * root(sign), 0.5 * weight(sign)));
    let mut sum = 0.0;
    let positions = mesh.positions();
    for nodes in mesh.elements() {
        let corner = |i: usize| nalgebra::Vector3::from(positions[nodes[i] as usize]);
        let edges = nalgebra::Matrix3::from_columns(&[1, 2, 3].map(|i| corner(i) - corner(0)));
        for place in 0..64 {
            let [(a, wa), (b, wb), (c, wc)] = [place / 16, place / 4 % 4, place % 4].map(|i| rule[i]);
            let point = [a, b * (1.0 - a), c * (1.0 - a) * (1.0 - b)];
            let measure = wa * wb * wc * (1.0 - a).powi(2) * (1.0 - b) * edges.determinant();
            let x = (corner(0) + edges * nalgebra::Vector3::from(point)).x;
            let shapes = shape_functions(point);
            let off = (0..3).map(|axis| {
                let found: f64 =
                    nodes.iter().zip(shapes).map(|(n, s)| s * displacement[(3 * *n as usize + axis, 0)]).sum();
                (found - if axis == 0 { stretch(x) } else { 0.0 }).powi(2)
            });
            sum += measure * off.sum::<f64>();
        }
    }
    (sum / SIZE.iter().product::<f64>()).sqrt()
}

/// Within 2 % of the figures measured here, and their fitted order within 0.15.
fn assert_converges(what: &str, errors: &[f64; 4], golden: [f64; 4], expected: f64) {
    let order = order(&CELLS[1..], &errors[1..]);
    println!("{what}: {errors:?}, order {order:.3}");
    assert!((order - expected).abs() < 0.15, "{what}: order {order}, {errors:?}");
    for (error, golden) in errors.iter().zip(golden) {
        assert!((error / golden - 1.0).abs() < 0.02, "{what}: {errors:?}");
    }
}

/// Closed form: u = sin(πx/L). The errors on each mesh are figures of this program.
#[test]
fn displacements_converge_with_the_third_power_of_the_element_length_and_energies_with_the_fourth() {
    let (mut mean, mut energy) = ([0.0; 4], [0.0; 4]);
    for (i, cells) in CELLS.into_iter().enumerate() {
        let (mesh, body) = bar(cells);
        let solver = body.held(&Support::free());
        let field = at_nodes(&body.positions);
        let force = solver.mass().product(field.as_ref()) * faer::Scale(frequency().powi(2));
        let answer = solver.static_response(force.as_ref()).unwrap();
        mean[i] = mean_error(&mesh, &answer);
        // f·u = m ω²/2 of the true stretch.
        let mass = MATERIAL.density * SIZE.iter().product::<f64>();
        energy[i] = 1.0 - (force.transpose() * &answer)[(0, 0)] / (0.5 * mass * frequency().powi(2));
    }
    assert_converges("displacement", &mean, [1.9832e-2, 2.0711e-3, 6.1659e-4, 2.5679e-4], 3.0);
    assert_converges("energy", &energy, [1.5518e-2, 1.0800e-3, 2.1813e-4, 6.9659e-5], 4.0);
}

/// Closed form: ω = (π/L) √(E/ρ). The errors on each mesh are figures of this program.
#[test]
fn frequencies_converge_with_the_fourth_power_of_the_element_length() {
    let errors = CELLS.map(|cells| {
        let (_, body) = bar(cells);
        let solver = body.held(&Support::free());
        let modes = solver.modes(14, |_| ()).unwrap();
        let momentum = solver.mass().product(at_nodes(&body.positions).as_ref());
        let overlap = momentum.transpose() * &modes.shapes;
        let along = (0..14).max_by(|a, b| overlap[(0, *a)].abs().total_cmp(&overlap[(0, *b)].abs())).unwrap();
        modes.natural_frequencies()[along] * TAU / frequency() - 1.0
    });
    assert_converges("frequency", &errors, [2.1694e-3, 1.5024e-4, 3.1361e-5, 1.0165e-5], 4.0);
}
