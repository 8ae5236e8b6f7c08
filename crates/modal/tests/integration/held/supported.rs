//! Modes of bodies that are held.

use nalgebra::Vector3;

use crate::held::supports::{allowed, body, supports};
use crate::modes::oracles::dense_eigenvalues_of;

const NF: usize = 10;

/// Independent reference: the dense problem of the allowed displacements, by faer.
#[test]
fn eigenvalues_and_rigid_modes_are_those_of_the_reduced_dense_problem() {
    let body = body();
    for (support, rigid) in supports(&body.positions) {
        let modes = body.held(&support).modes(NF, |_| ()).unwrap();
        let present = modes.rigid.shapes.col_iter().filter(|shape| shape.norm_max() > 0.0).count();
        assert_eq!((support.motion.count(), present), (rigid, rigid), "{:?}", support.motion);

        let t = allowed(&support, &body.positions);
        let reduced = |matrix| t.transpose() * (matrix * &t);
        let expected = dense_eigenvalues_of(reduced(body.matrices.stiffness()), reduced(body.matrices.mass()));
        let zeros = expected.iter().filter(|lambda| lambda.abs() < 1e-6 * modes.eigenvalues[0]).count();
        assert_eq!(zeros, rigid, "{:?}", &expected[..8]);
        for (found, expected) in modes.eigenvalues.iter().zip(&expected[rigid..]) {
            let off = found / expected - 1.0;
            // 1.4e-11 at most.
            assert!(off.abs() < 1e-9, "{:?}: {found:e} instead of {expected:e}: {off:e}", support.motion);
        }
    }
}

/// Conserved: ΦᵀMΦ = 1 and Kφ = λMφ.
#[test]
fn modes_are_m_orthonormal_and_in_balance_without_reactions() {
    let body = body();
    let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
    for (support, _) in supports(&body.positions) {
        let modes = body.held(&support).modes(NF, |_| ()).unwrap();
        let mut all = modes.rigid.shapes.clone();
        all.resize_with(all.nrows(), 6 + NF, |i, j| modes.shapes[(i, j - 6)]);
        let gram = all.transpose() * (m * &all);
        for (i, j) in (0..6 + NF).flat_map(|i| (0..6 + NF).map(move |j| (i, j))) {
            let is_there = all.col(i).norm_max() > 0.0;
            let expected = f64::from(i == j && is_there);
            assert!((gram[(i, j)] - expected).abs() < 1e-12, "{:?}: {i} {j} {:e}", support.motion, gram[(i, j)]);
        }
        let t = allowed(&support, &body.positions);
        let k_rigid = k * &modes.rigid.shapes;
        assert!(k_rigid.norm_max() < 1e-9 * (k * &modes.shapes).norm_max());
        for (mode, lambda) in modes.eigenvalues.iter().enumerate() {
            let (force, inertia) = (k * modes.shapes.col(mode), m * modes.shapes.col(mode));
            let force = t.transpose() * force;
            let residual = (&force - (t.transpose() * inertia) * faer::Scale(*lambda)).norm_l2() / force.norm_l2();
            // 2.3e-9 at most.
            assert!(modes.force_residuals[mode] < 1e-7, "{:?}: {:e}", support.motion, modes.force_residuals[mode]);
            assert!(residual < 1e-7, "{:?}: mode {mode} leaves {residual:e}", support.motion);
        }
    }
}

/// Conserved: no displacement that the support forbids.
#[test]
fn held_nodes_move_with_the_support_only() {
    let body = body();
    for (support, _) in supports(&body.positions) {
        let modes = body.held(&support).modes(NF, |_| ()).unwrap();
        for mode in 0..NF {
            let shape = modes.shapes.col(mode);
            let u = |node: &u32| Vector3::from_fn(|axis, _| shape[3 * *node as usize + axis]);
            let x = |node: &u32| Vector3::from(body.positions[*node as usize]);
            let point = support.motion.fixed_point().unwrap_or_default();
            let other_than_allowed: f64 = match (support.motion.translations(), support.motion.rotations()) {
                ([_, _, _], _) => 0.0,
                ([], []) => support.nodes.iter().map(|node| u(node).norm()).fold(0.0, f64::max),
                ([direction], _) => {
                    let along = u(&support.nodes[0]).dot(direction);
                    support.nodes.iter().map(|node| (u(node) - direction * along).norm()).fold(0.0, f64::max)
                }
                (_, [axis]) => {
                    let turned = |node: &u32| axis.cross(&(x(node) - point));
                    let (mut along, mut squared) = (0.0, 0.0);
                    for node in &support.nodes {
                        along += u(node).dot(&turned(node));
                        squared += turned(node).norm_squared();
                    }
                    let angle = if squared > 0.0 { along / squared } else { 0.0 };
                    support.nodes.iter().map(|node| (u(node) - turned(node) * angle).norm()).fold(0.0, f64::max)
                }
                _ => {
                    // Rigid about the point: no velocity along the arm, nor towards each other.
                    let pairs = support.nodes.iter().flat_map(|a| support.nodes.iter().map(move |b| (a, b)));
                    let stretch = pairs.map(|(a, b)| (x(a) - x(b)).dot(&(u(a) - u(b))).abs());
                    let radial = support.nodes.iter().map(|a| (x(a) - point).dot(&u(a)).abs());
                    let at_point = support.nodes.iter().filter(|a| x(a) == point).map(|a| u(a).norm());
                    stretch.chain(radial).chain(at_point).fold(0.0, f64::max) / 8.0
                }
            };
            let off = other_than_allowed / shape.norm_max();
            // 7.1e-16 at most.
            assert!(off < 1e-12, "{:?}: mode {mode}: {off:e}", support.motion);
        }
    }
}
