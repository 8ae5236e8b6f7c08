//! Modes that static shapes complete.

use faer::Mat;
use modal::{Modes, Solver, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::Body;
use crate::held::supports::{body, supports};
use crate::statics::responses::{Bar, work};

/// The static displacement at a force, in its direction, as the modes give it: Σ (φᵀf)²/λ.
fn modal_flexibility(modes: &Modes, force: &Mat<f64>) -> f64 {
    let on_modes = modes.shapes.transpose() * force;
    modes.eigenvalues.iter().enumerate().map(|(k, lambda)| on_modes[(k, 0)].powi(2) / lambda).sum()
}

#[track_caller]
fn assert_orthogonal(body: &Body, modes: &Modes, what: RigidMotion) {
    let count = 6 + modes.shapes.ncols();
    let mut all = modes.rigid.shapes.clone();
    all.resize_with(all.nrows(), count, |i, j| modes.shapes[(i, j - 6)]);
    let gram = all.transpose() * (body.matrices.mass() * &all);
    let energy = all.transpose() * (body.matrices.stiffness() * &all);
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let is_there = all.col(i).norm_max() > 0.0;
        let m_off = (gram[(i, j)] - f64::from(i == j && is_there)).abs();
        let lambda = |i: usize| if i < 6 { modes.eigenvalues[0] } else { modes.eigenvalues[i - 6] };
        let diagonal = if i == j && i >= 6 { lambda(i) } else { 0.0 };
        let k_off = (energy[(i, j)] - diagonal).abs() / (lambda(i) * lambda(j)).sqrt();
        // 1.2e-14 and 7.5e-11 at most.
        assert!(m_off < 1e-12 && k_off < 1e-8, "{what:?}: {i} {j}: {m_off:e} {k_off:e}");
    }
}

fn completed(solver: &Solver<'_>, natural: usize, forces: &Mat<f64>) -> (Modes, Modes) {
    let modes = solver.modes(natural, |_| ()).unwrap();
    let answers = solver.static_response(forces.as_ref()).unwrap();
    let completed = solver.with_static_shapes(modes.clone(), answers.as_ref()).unwrap();
    (modes, completed)
}

/// Conserved: the static response itself.
#[test]
fn three_modes_and_a_static_shape_give_the_exact_tip_deflection() {
    let bar = Bar::new(100.0);
    for (support, axis) in [(bar.clamp(), 1), (bar.clamp(), 0), (Support::free(), 2)] {
        let solver = bar.body.held(&support);
        let force = bar.traction(1.0, axis);
        let answer = solver.static_response(force.as_ref()).unwrap();
        let exact = work(&force, &answer);
        let (modes, completed) = completed(&solver, 3, &force);
        assert_eq!((modes.natural(), completed.natural(), completed.shapes.ncols()), (3, 3, 4));
        let before = modal_flexibility(&modes, &force) / exact - 1.0;
        let after = modal_flexibility(&completed, &force) / exact - 1.0;
        assert!(before < -1e-3, "{before:e}: three modes are enough by themselves");
        // 3.2e-11 at most; −4.6e-3, −1 (none of the three stretches) and −0.16 before.
        assert!(after.abs() < 1e-9, "{after:e}");
        let whole = &completed.shapes
            * Mat::from_fn(4, 1, |k, _| {
                let on_mode: f64 = (0..force.nrows()).map(|i| completed.shapes[(i, k)] * force[(i, 0)]).sum();
                on_mode / completed.eigenvalues[k]
            });
        let off = (&whole - &answer).norm_max() / answer.norm_max();
        // 5.9e-10 at most.
        assert!(off < 1e-8, "{off:e}");
        assert_orthogonal(&bar.body, &completed, support.motion);
    }
}

/// Conserved: ΨᵀMΨ = 1, and ΨᵀKΨ is diagonal.
#[test]
fn modes_and_several_static_shapes_are_orthogonal_whatever_holds_the_body() {
    let body = body();
    let n = 3 * body.positions.len();
    let forces = Mat::from_fn(n, 4, |i, j| ((5 + 2 * j) as f64 * i as f64).sin());
    for (support, _) in supports(&body.positions) {
        let (modes, completed) = completed(&body.held(&support), 5, &forces);
        assert_eq!(completed.shapes.ncols(), 9);
        assert_eq!(completed.shapes.get(.., ..5), modes.shapes.as_ref());
        assert!(completed.eigenvalues[5..].is_sorted());
        // Static shapes are stiffer than the modes that are there.
        assert!(completed.eigenvalues[5] > completed.eigenvalues[4]);
        assert_orthogonal(&body, &completed, support.motion);
    }
}

/// Conserved: the same in one go and in two.
#[test]
fn shapes_that_come_in_two_goes_are_those_that_come_in_one() {
    let body = body();
    let n = 3 * body.positions.len();
    let forces = Mat::from_fn(n, 4, |i, j| ((5 + 2 * j) as f64 * i as f64).sin());
    for (support, _) in supports(&body.positions) {
        let solver = body.held(&support);
        let (modes, at_once) = completed(&solver, 5, &forces);
        let answers = solver.static_response(forces.as_ref()).unwrap();
        let first = solver.with_static_shapes(modes, answers.subcols(0, 2)).unwrap();
        let both = solver.with_static_shapes(first, answers.subcols(2, 2)).unwrap();
        assert_eq!(both.shapes.ncols(), 9);
        assert_orthogonal(&body, &both, support.motion);
        for (a, b) in both.eigenvalues.iter().zip(&at_once.eigenvalues) {
            // 1e-12 at most.
            assert!((a / b - 1.0).abs() < 1e-9, "{:?}: {a} {b}", support.motion);
        }
    }
}

#[test]
fn answers_that_add_nothing_are_left_out() {
    let bar = Bar::new(200.0);
    let solver = bar.body.held(&bar.clamp());
    let modes = solver.modes(3, |_| ()).unwrap();
    let (bent, pulled) = (bar.traction(1.0, 1), bar.traction(1.0, 0));
    let forces = Mat::from_fn(bent.nrows(), 4, |i, j| match j {
        0 => bent[(i, 0)],
        1 => -3.0 * bent[(i, 0)],
        2 => 1e6 * pulled[(i, 0)] + 1e3 * bent[(i, 0)],
        _ => pulled[(i, 0)],
    });
    let answers = solver.static_response(forces.as_ref()).unwrap();
    assert_eq!(solver.with_static_shapes(modes.clone(), answers.as_ref()).unwrap().shapes.ncols(), 5);

    let none = Mat::from_fn(bent.nrows(), 4, |i, j| if j < 3 { 2.5 * modes.shapes[(i, j)] } else { 0.0 });
    for nothing in [none, Mat::zeros(bent.nrows(), 0)] {
        let same = solver.with_static_shapes(modes.clone(), nothing.as_ref()).unwrap();
        assert_eq!(same.eigenvalues, modes.eigenvalues);
        assert_eq!(same.shapes, modes.shapes);
    }
}

/// Closed form: gravity on a body that is free to fall is balanced by the fall: no answer, and so no shape.
#[test]
fn what_falls_is_not_strained() {
    let body = body();
    let down = Vector3::y();
    for (support, _) in supports(&body.positions) {
        let solver = body.held(&support);
        let nodal = solver.mass().row_sums();
        let gravity = Mat::from_fn(3 * nodal.len(), 1, |i, _| nodal[i / 3] * down[i % 3]);
        let answer = solver.static_response(gravity.as_ref()).unwrap();
        let modes = solver.with_static_shapes(solver.modes(3, |_| ()).unwrap(), answer.as_ref()).unwrap();
        let falls = support.motion.is_free() || support.motion == RigidMotion::slider(down);
        assert_eq!((answer.norm_max() == 0.0, modes.shapes.ncols()), (falls, 4 - usize::from(falls)), "{support:?}");
    }
}
