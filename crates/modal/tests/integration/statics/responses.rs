//! Static responses, and what is made of them.

use faer::Mat;
use fem_tet10::{Material, Materials, second_order_forces};
use modal::{ModalError, StaticAccuracy, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::{Body, STEEL, block_mesh, mesh_file};
use crate::held::supports::{allowed, body, nodes, supports};

/// A bar along x without Poisson effect.
pub struct Bar {
    pub length: f64,
    pub width: f64,
    pub height: f64,
    pub body: Body,
}

impl Bar {
    pub fn new(length: f64) -> Self {
        let (width, height) = (4.0, 6.0);
        let material = Material { poisson_ratio: 0.0, ..STEEL };
        Self { length, width, height, body: Body::new(&block_mesh([length, width, height], [20, 1, 1]), material) }
    }

    pub fn clamp(&self) -> Support {
        let end = -0.5 * self.length;
        let held = nodes(&self.body.positions, |x| x.x < end + 1e-9);
        Support::new(RigidMotion::clamp(Vector3::new(end, 0.0, 0.0)), held)
    }

    /// The nodal forces of a uniform traction with resultant 1 along `axis` on the end of the bar at `x = side·L/2`.
    /// Each end is two quadratic triangles: their mid-edge nodes take a third of the area, their corners nothing.
    pub fn traction(&self, side: f64, axis: usize) -> Mat<f64> {
        let mut force = Mat::zeros(3 * self.body.positions.len(), 1);
        for (node, x) in self.body.positions.iter().enumerate() {
            let is_on_end = (x[0] - 0.5 * side * self.length).abs() < 1e-9;
            let (inner_y, inner_z) = (x[1].abs() < 1e-9, x[2].abs() < 1e-9);
            let share = match (inner_y, inner_z) {
                (true, true) => 1.0 / 3.0,
                (false, false) => 0.0,
                _ => 1.0 / 6.0,
            };
            if is_on_end {
                force[(3 * node + axis, 0)] = share;
            }
        }
        let resultant: f64 = force.sum();
        assert!((resultant - 1.0).abs() < 1e-14);
        force
    }
}

/// The displacement that does work with a force.
pub fn work(force: &Mat<f64>, displacement: &Mat<f64>) -> f64 {
    (force.transpose() * displacement)[(0, 0)]
}

/// Closed form: PL³/(3EI) + PL/(κGA).
#[test]
fn a_clamped_bar_bends_under_a_tip_force_as_beam_theory_says() {
    let bar = Bar::new(200.0);
    let (area, young) = (bar.width * bar.height, STEEL.young_modulus);
    for (axis, thickness) in [(1, bar.width), (2, bar.height)] {
        let force = bar.traction(1.0, axis);
        let answer = bar.body.held(&bar.clamp()).static_response(force.as_ref()).unwrap();
        let second_moment = area * thickness.powi(2) / 12.0;
        // Shear: G = E/2 without Poisson effect, 5/6 of the area.
        let expected =
            bar.length.powi(3) / (3.0 * young * second_moment) + bar.length / (5.0 / 6.0 * 0.5 * young * area);
        let off = work(&force, &answer) / expected - 1.0;
        // −3.7e-4 and −4.0e-4: the mesh, and the clamp that keeps the end from warping.
        assert!(off.abs() < 1e-3, "{off:e}");
    }
}

/// Closed form: u = Fx/(EA).
#[test]
fn a_clamped_bar_stretches_exactly() {
    let bar = Bar::new(200.0);
    let force = bar.traction(1.0, 0);
    let answer = bar.body.held(&bar.clamp()).static_response(force.as_ref()).unwrap();
    for (node, x) in bar.body.positions.iter().enumerate() {
        let expected = (x[0] + 0.5 * bar.length) / (STEEL.young_modulus * bar.width * bar.height);
        let off = (answer[(3 * node, 0)] - expected).abs() / answer.norm_max();
        assert!(off < 1e-9, "{off:e}");
    }
}

/// Closed form: a uniform strain, and the tension of a bar that one end pulls.
#[test]
fn a_free_bar_answers_balanced_and_unbalanced_forces() {
    let bar = Bar::new(200.0);
    let (pull, push) = (bar.traction(1.0, 0), bar.traction(-1.0, 0));
    let forces = Mat::from_fn(pull.nrows(), 2, |i, j| pull[(i, 0)] - if j == 0 { push[(i, 0)] } else { 0.0 });
    let answers = bar.body.held(&Support::free()).static_response(forces.as_ref()).unwrap();
    let stiffness = STEEL.young_modulus * bar.width * bar.height / bar.length;
    let mut worst: f64 = 0.0;
    for (node, x) in bar.body.positions.iter().enumerate() {
        let s = x[0] / bar.length + 0.5;
        // Pulled at both ends: a uniform strain about the middle. At one end: a tension that rises along the bar,
        // whose body it accelerates; the mean displacement is zero.
        let expected = [s - 0.5, 0.5 * s * s - 1.0 / 6.0];
        for (k, expected) in expected.into_iter().enumerate() {
            worst = worst.max((answers[(3 * node, k)] * stiffness - expected).abs());
            let across = answers[(3 * node + 1, k)].abs().max(answers[(3 * node + 2, k)].abs());
            worst = worst.max(across * stiffness);
        }
    }
    // 1.5e-12.
    assert!(worst < 1e-9, "{worst:e}");
}

/// Conserved: the same response with and without the modes.
#[test]
fn from_the_modes_on_the_answers_are_the_same_and_take_fewer_solutions() {
    let body = body();
    let n = 3 * body.positions.len();
    let forces = Mat::from_fn(n, 6, |i, j| ((7 + 2 * j) as f64 * i as f64).sin());
    for (support, _) in supports(&body.positions) {
        let solver = body.held(&support);
        let modes = solver.modes(10, |_| ()).unwrap();
        let solved = |answer: &dyn Fn() -> Mat<f64>| {
            let [_, before] = solver.solved();
            let answer = answer();
            (answer, solver.solved()[1] - before)
        };
        let (without, many) = solved(&|| solver.static_response(forces.as_ref()).unwrap());
        let from = |accuracy| solver.static_response_from(&modes, forces.as_ref(), accuracy).unwrap();
        let (with, few) = solved(&|| from(StaticAccuracy::Full));
        let (rough, fewer) = solved(&|| from(StaticAccuracy::Shapes));
        let off = (&with - &without).norm_max() / without.norm_max();
        println!("{:?}: {many} columns, {few} from the modes on, {off:e} apart", support.motion);
        assert!(off < 1e-9, "{:?}: {off:e}", support.motion);
        assert!(fewer < few && few < many, "{:?}: {many}, {few}, {fewer}", support.motion);
        // In the norm of the energy, of the part that the modes do not have.
        let k = body.matrices.stiffness();
        for (answer, error) in without.col_iter().zip((&rough - &without).col_iter()) {
            let carried: f64 = modes
                .shapes
                .col_iter()
                .zip(&modes.eigenvalues)
                .map(|(shape, lambda)| (shape.transpose() * k * answer).powi(2) / lambda)
                .sum();
            let (whole, off) = (answer.transpose() * k * answer - carried, error.transpose() * k * error);
            assert!(off < 1e-10 * whole, "{:?}: {off:e} of {whole:e}", support.motion);
        }
    }
}

/// Conserved: the forces on each node are in balance.
#[test]
fn any_force_is_balanced_by_stress_reactions_and_inertia() {
    let body = body();
    let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
    let n = 3 * body.positions.len();
    // More than one block, with a zero among them.
    let forces = Mat::from_fn(n, 11, |i, j| if j == 4 { 0.0 } else { ((7 + 2 * j) as f64 * i as f64).sin() });
    for (support, _) in supports(&body.positions) {
        let solver = body.held(&support);
        let answers = solver.static_response(forces.as_ref()).unwrap();
        let rigid = &solver.rigid().shapes;
        let size = (answers.transpose() * (m * &answers)).norm_max().sqrt();
        let motion = (rigid.transpose() * (m * &answers)).norm_max() / size;
        assert!(motion < 1e-12, "{motion:e}");

        let t = allowed(&support, &body.positions);
        let inertia = m * (rigid * (rigid.transpose() * &forces));
        let left = t.transpose() * (k * &answers + inertia - &forces);
        // 1.0e-12 at most, of forces of magnitude 1.
        assert!(left.norm_max() < 1e-10, "{:?}: {:e}", support.motion, left.norm_max());
        assert_eq!(answers.col(4).norm_max(), 0.0);
        let held: Vec<usize> = support.nodes.iter().map(|node| *node as usize).collect();
        if support.motion.count() == 0 {
            assert!(held.iter().all(|node| (0..3).all(|axis| answers.row(3 * node + axis).norm_max() == 0.0)));
        }
    }
}

#[test]
fn forces_of_another_size_or_without_a_number_are_refused() {
    let body = body();
    let solver = body.held(&Support::free());
    let error = solver.static_response(Mat::zeros(7, 1).as_ref()).unwrap_err();
    assert!(matches!(error, ModalError::Size { what: "forces", found: 7, .. }), "{error}");
    let mut forces = Mat::zeros(3 * body.positions.len(), 2);
    forces[(5, 1)] = f64::NAN;
    let error = solver.static_response(forces.as_ref()).unwrap_err();
    assert!(matches!(error, ModalError::NotFinite { what: "forces", index: 1, .. }), "{error}");
    let modes = solver.modes(1, |_| ()).unwrap();
    let error = solver.with_static_shapes(modes, forces.as_ref()).unwrap_err();
    assert!(matches!(error, ModalError::NotFinite { what: "static responses", index: 1, .. }), "{error}");
}

/// Answers for shapes end where the steps so far promise enough. Where a step gains less, they go on.
/// Conserved: the response to full accuracy.
#[test]
fn forces_of_second_order_of_a_ring_are_answered() {
    let mesh = mesh_file("ring.msh");
    let body = Body::new(&mesh, STEEL);
    let solver = body.held(&Support::free());
    let modes = solver.modes(4, |_| ()).unwrap();
    let large = modes.shapes.get(.., ..2);
    let forces = second_order_forces(&mesh, &Materials::Uniform(STEEL), large, &[[0, 0], [0, 1], [1, 1]]).unwrap();
    let answer = |accuracy| solver.static_response_from(&modes, forces.as_ref(), accuracy).unwrap();
    let (shapes, full) = (answer(StaticAccuracy::Shapes), answer(StaticAccuracy::Full));
    for (found, expected) in shapes.col_iter().zip(full.col_iter()) {
        let off = (found - expected).norm_l2() / expected.norm_l2();
        assert!(off < 1e-4, "{off:e}");
    }
}
