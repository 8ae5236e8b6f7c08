//! Matrices with rotations at the nodes: a cantilever and a free beam of Euler–Bernoulli elements.

use std::fmt::Write;

use faer::sparse::{SparseColMat, Triplet};
use nalgebra::{Matrix3, Vector3};

use super::files::matrix_market;
use super::{Files, MARKET};
use crate::{build, close, observations};

/// A steel beam along x with a section of 40 × 30 mm.
const LENGTH: f64 = 2000.0;
const YOUNG: f64 = 210e3;
const SHEAR: f64 = 81e3;
const DENSITY: f64 = 7.85e-9;
const AREA: f64 = 40.0 * 30.0;
const ABOUT_Y: f64 = 30.0 * 40.0 * 40.0 * 40.0 / 12.0;
const ABOUT_Z: f64 = 40.0 * 30.0 * 30.0 * 30.0 / 12.0;

fn beam(elements: usize) -> Files {
    beam_with(elements, 0.0, Vector3::zeros())
}

/// The beam with a mass on its last node that is off the axis: it couples the node's translations and rotations.
fn beam_with(elements: usize, mass: f64, offset: Vector3<f64>) -> Files {
    let h = LENGTH / elements as f64;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    let mut add = |rows: &[usize], stiffness: &dyn Fn(usize, usize) -> f64, inertia: &dyn Fn(usize, usize) -> f64| {
        for (i, j) in (0..rows.len()).flat_map(|i| (0..rows.len()).map(move |j| (i, j))) {
            for first in (0..elements).map(|element| 6 * element) {
                k.push(Triplet::new(first + rows[i], first + rows[j], stiffness(i, j)));
                m.push(Triplet::new(first + rows[i], first + rows[j], inertia(i, j)));
            }
        }
    };
    let polar = ABOUT_Y + ABOUT_Z;
    for (rows, rigidity, inertia) in [([0, 6], YOUNG * AREA, DENSITY * AREA), ([3, 9], SHEAR * polar, DENSITY * polar)]
    {
        add(&rows, &|i, j| if i == j { rigidity / h } else { -rigidity / h }, &|i, j| {
            inertia * h / if i == j { 3.0 } else { 6.0 }
        });
    }
    let bending = [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    let consistent =
        [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]];
    for (rows, sense, moment) in [([1, 5, 7, 11], 1.0, ABOUT_Z), ([2, 4, 8, 10], -1.0, ABOUT_Y)] {
        let scale = |i: usize| if i % 2 == 1 { sense * h } else { 1.0 };
        add(&rows, &|i, j| YOUNG * moment / h.powi(3) * bending[i][j] * scale(i) * scale(j), &|i, j| {
            DENSITY * AREA * h / 420.0 * consistent[i][j] * scale(i) * scale(j)
        });
    }
    let cross = offset.cross_matrix();
    let coupled = [[Matrix3::identity(), -cross], [cross, -cross * cross]];
    for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
        let value = mass * coupled[i / 3][j / 3][(i % 3, j % 3)];
        m.push(Triplet::new(6 * elements + i, 6 * elements + j, value));
    }
    let size = 6 * (elements + 1);
    let matrix = |entries: &[Triplet<usize, usize, f64>]| {
        SparseColMat::<usize, f64>::try_new_from_triplets(size, size, entries).unwrap()
    };
    let files = Files::new();
    files.write("K.mtx", &matrix_market(matrix(&k).as_ref(), true));
    files.write("M.mtx", &matrix_market(matrix(&m).as_ref(), true));
    let mut nodes = "x,y,z\n".to_owned();
    (0..=elements).for_each(|i| writeln!(nodes, "{:?},0,0", h * i as f64).unwrap());
    files.write("nodes.csv", &nodes);
    files
}

/// Closed form: a couple on the last node bends a cantilever into a circle: w = M L²/(2 E I), and turns its end by M
/// L/(E I).
#[test]
fn a_moment_at_a_node_with_rotations() {
    let files = beam(8);
    let moment = 1000.0;
    let rest = format!(
        "[effects]\ngravity = \"auto\"\n[[constraints]]\nkind = \"clamp\"\nat = [0.0, 0.0, 0.0]\nradius = 1.0\n\
         [[loads]]\nkind = \"moment\"\nat = [{LENGTH:?}, 0.0, 0.0]\ndirection = [0, 0, 1]\namplitude = {moment:?}\nframe = \"body\"\n\
         history = {{ kind = \"ramp\", duration = 1.0 }}\n"
    );
    let time = "end = 3.0\nstep = 1e-3\n[output]\ninterval = 1.0\npoints = { tip = [2000.0, 0.0, 0.0], middle = [1000.0, 0.0, 0.0] }";
    let scene = files.scene(MARKET, "flexible = 4\ndamping_ratio = 0.7\nstatic_correction = true", &rest, time);
    let model = build(&scene);
    let omega = (1.875_104_068_711_961_f64 / LENGTH).powi(2) * (YOUNG * ABOUT_Z / (DENSITY * AREA)).sqrt();
    close(model.natural_frequencies()[0], omega / std::f64::consts::TAU, 1e-4);
    let last = observations(&scene, &model).pop().unwrap();
    let expected = |x: f64| moment * x * x / (2.0 * YOUNG * ABOUT_Z);
    for (point, x) in last.points.iter().zip([1000.0, LENGTH]) {
        close(point.displacement.y, expected(x), 1e-6);
    }
}

#[test]
fn a_rigid_region_of_nodes_with_rotations_is_refused() {
    let files = beam(8);
    let of = |tie: &str| {
        let body =
            format!("{MARKET}\nmarkers = {{ tip = {{ box = [[1700, -1, -1], [2001, 1, 1]], tie = \"{tie}\" }} }}");
        files.scene(&body, "flexible = 4", "", "end = 1e-3\nstep = 1e-5")
    };
    build(&of("mean"));
    let message = crate::refusal(&of("rigid")).to_string();
    let expected = [
        "`body.markers.tip.tie`: found a rigid part of a body whose nodes have rotations",
        "`\"mean\"` or `\"nodes\"`",
        "rigid elements",
    ];
    for words in expected {
        assert!(message.contains(words), "{words:?} is not in: {message}");
    }
}

/// Conserved: a body in free fall does not begin to turn, wherever its masses are on their nodes.
#[test]
fn gravity_acts_at_the_centre_of_mass_of_a_mass_beside_its_node() {
    let files = beam_with(8, 2e-3, Vector3::new(10.0, 120.0, -60.0));
    let gravity = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n";
    let scene = files.scene(MARKET, "flexible = 6", gravity, "end = 0.5\nstep = 1e-3");
    let rows = observations(&scene, &build(&scene));
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    // With the weight on the nodes themselves, it turns by some tenths of a radian.
    let turned = first.attitude.angle_to(&last.attitude);
    assert!(turned < 1e-9, "{turned:e}");
    assert!(last.strain_energy < 1e-12 * last.kinetic_energy, "{:e}", last.strain_energy / last.kinetic_energy);
    close(last.velocity_global.norm(), 9810.0 * 0.5, 1e-9);
}

/// Conserved: order 2: the part of a consistent mass that the large rotation leaves out goes with the square of the
/// length of the elements.
#[test]
fn what_is_left_out_of_the_mass_is_told() {
    let left_out = |elements: usize| {
        let files = beam(elements);
        let scene = files.scene(MARKET, "flexible = 4", "", "end = 1.0\nstep = 1e-3");
        let model = build(&scene);
        let checks = model.meshed.as_ref().and_then(|meshed| meshed.checks).unwrap();
        assert!(!checks.is_scalar_mass && checks.dofs == 6, "{checks:?}");
        checks.left_out
    };
    let (coarse, fine) = (left_out(8), left_out(16));
    assert!(coarse < 0.05 && fine > 0.0, "{coarse:e}, {fine:e}");
    let order = (coarse / fine).log2();
    assert!((1.8..2.4).contains(&order), "{coarse:e}, {fine:e}: order {order}");
}
