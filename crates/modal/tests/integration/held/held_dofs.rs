//! Supports that hold single degrees of freedom: what they leave, and the modes of bodies so held.

use std::f64::consts::PI;

use modal::{ModalError, Support};
use nalgebra::{Matrix3, Vector3};
use reduced_body::RigidMotion;

use crate::beam::Beam;
use crate::held::supports::{body, nodes};
use crate::modes::oracles::dense_eigenvalues_of;

/// The motion that these degrees of freedom leave of the block, counted from 0.
fn left(dofs: &[(u32, usize)]) -> RigidMotion {
    Support::of_dofs(&body().positions, dofs).unwrap().motion
}

/// Nodes at corners of the block.
fn corner(x: f64, y: f64, z: f64) -> u32 {
    let at = Vector3::new(15.0 * x, 7.0 * y, 4.5 * z);
    nodes(&body().positions, |position| (position - at).norm() < 1e-9)[0]
}

fn all_of(node: u32) -> [(u32, usize); 3] {
    [0, 1, 2].map(|axis| (node, axis))
}

/// Closed form: the points and axes that the held corners leave.
#[test]
fn what_is_left_is_a_pin_a_hinge_a_slider_a_clamp_or_neither() {
    assert_eq!(left(&[]), RigidMotion::free());
    let (a, b, c) = (corner(-1.0, -1.0, -1.0), corner(1.0, -1.0, -1.0), corner(-1.0, 1.0, -1.0));
    let close = |found: RigidMotion, point: Vector3<f64>| (found.fixed_point().unwrap() - point).norm() < 1e-9;
    let at = |node: u32| Vector3::from(body().positions[node as usize]);

    let pin = left(&all_of(a));
    assert!(pin.rotations().len() == 3 && pin.translations().is_empty() && close(pin, at(a)));
    let hinge = left(&[all_of(a), all_of(b)].concat());
    assert!(hinge.translations().is_empty() && hinge.count() == 1);
    assert!((hinge.rotations()[0] - Vector3::x()).norm() < 1e-12);
    assert!((hinge.fixed_point().unwrap() - at(a)).cross(&Vector3::x()).norm() < 1e-9);
    // x and y of one corner, y of another, z of four: nothing; without the x, a slide along it.
    let plane: Vec<_> = [a, b, c, corner(1.0, 1.0, -1.0)].map(|node| (node, 2)).into();
    let clamp = left(&[&plane[..], &[(a, 0), (a, 1), (b, 1)]].concat());
    assert_eq!((clamp.count(), clamp.others().len(), clamp.to_string().as_str()), (0, 0, "no rigid motion"));
    let slider = left(&[&plane[..], &[(a, 1), (b, 1)]].concat());
    assert_eq!((slider.count(), slider.to_string().as_str()), (1, "1 translation"));
    assert!((slider.translations()[0] - Vector3::x()).norm() < 1e-12);
    // A hinge along y, through two corners.
    let along_y = left(&[&all_of(a)[..], &[(b, 0), (b, 1)], &all_of(c)].concat());
    assert!((along_y.rotations()[0] - Vector3::y()).norm() < 1e-12, "{along_y:?}");

    // A plane: two translations and a rotation; a table and a wall; a cylinder.
    for (dofs, words, translations) in [
        (plane.clone(), "2 translations and 1 rotation", 2),
        ([&plane[..], &[(a, 1)]].concat(), "1 translation and 1 rotation", 1),
        (vec![(a, 1), (a, 2), (b, 1), (b, 2)], "1 translation and 1 rotation", 1),
        (vec![(a, 0)], "2 translations and 3 rotations", 2),
        (vec![(a, 0), (a, 1)], "1 translation and 3 rotations", 1),
    ] {
        let motion = left(&dofs);
        assert_eq!(motion.to_string(), words, "{dofs:?}");
        let unturned = motion.others().iter().filter(|twist| twist.rotation == Vector3::zeros());
        assert_eq!((unturned.count(), motion.is_free()), (translations, false));
        assert!(motion.translations().is_empty() && motion.rotations().is_empty());
        assert_eq!(motion.count(), motion.others().len());
    }
}

/// Conserved: no velocity of the held degrees of freedom.
#[test]
fn motions_left_move_none_of_what_is_held() {
    // Also where they are screws, which five degrees of freedom at odd places leave.
    let positions = &body().positions;
    let odd = [(0, 0), (11, 1), (23, 2), (37, 0), (52, 1)];
    for count in 0..=odd.len() {
        let motion = Support::of_dofs(positions, &odd[..count]).unwrap().motion;
        assert_eq!(motion.count(), 6 - count, "{motion}");
        let point = motion.fixed_point().unwrap_or_default();
        for twist in motion.others() {
            for (node, axis) in &odd[..count] {
                let x = Vector3::from(positions[*node as usize]) - point;
                let moved = (twist.velocity + twist.rotation.cross(&x))[*axis];
                assert!(moved.abs() < 1e-12, "{moved:e}");
            }
        }
    }
    let screw = Support::of_dofs(positions, &odd).unwrap().motion;
    let [twist] = screw.others() else { panic!("{screw:?}") };
    assert!(twist.velocity.dot(&twist.rotation).abs() > 1e-6);
}

/// Independent reference: the dense problem without the held rows, by faer.
#[test]
fn modes_are_those_of_the_rows_that_are_free() {
    let body = body();
    let (a, b) = (corner(-1.0, -1.0, -1.0), corner(1.0, -1.0, -1.0));
    let bottom: Vec<(u32, usize)> = nodes(&body.positions, |x| x.z < -4.4).into_iter().map(|node| (node, 2)).collect();
    let cases = [
        vec![],
        bottom.clone(),
        [&bottom[..], &[(a, 0), (a, 1)]].concat(),
        [&bottom[..], &[(a, 0), (a, 1), (b, 1)]].concat(),
        vec![(a, 1), (a, 2), (b, 1), (b, 2)],
        vec![(0, 0), (11, 1), (23, 2), (37, 0), (52, 1)],
        all_of(a).to_vec(),
    ];
    for dofs in cases {
        let support = Support::of_dofs(&body.positions, &dofs).unwrap();
        let modes = body.held(&support).modes(8, |_| ()).unwrap();
        let held: Vec<usize> = dofs.iter().map(|(node, axis)| 3 * *node as usize + axis).collect();
        let free: Vec<usize> = (0..3 * body.positions.len()).filter(|row| !held.contains(row)).collect();
        let reduced = |matrix: faer::sparse::SparseColMatRef<'_, usize, f64>| {
            faer::Mat::from_fn(free.len(), free.len(), |i, j| matrix.get(free[i], free[j]).copied().unwrap_or(0.0))
        };
        let expected = dense_eigenvalues_of(reduced(body.matrices.stiffness()), reduced(body.matrices.mass()));
        let rigid = support.motion.count();
        assert!(expected[..rigid].iter().all(|lambda| lambda.abs() < 1e-6 * modes.eigenvalues[0]));
        for (found, expected) in modes.eigenvalues.iter().zip(&expected[rigid..]) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{}: {found:e} {expected:e}", support.motion);
        }
        assert!(held.iter().all(|row| (0..8).all(|k| modes.shapes[(*row, k)].abs() < 1e-12)));
        // Rigid and flexible modes are M-orthonormal.
        let mut all = modes.rigid.shapes.clone();
        all.resize_with(all.nrows(), 14, |i, j| modes.shapes[(i, j - 6)]);
        let gram = all.transpose() * (body.matrices.mass() * &all);
        for (i, j) in (0..14).flat_map(|i| (0..14).map(move |j| (i, j))) {
            let expected = f64::from(i == j && all.col(i).norm_max() > 0.0);
            assert!((gram[(i, j)] - expected).abs() < 1e-11, "{}: {i} {j} {}", support.motion, gram[(i, j)]);
        }
        assert_eq!(all.col_iter().filter(|column| column.norm_max() > 0.0).count(), rigid + 8);
    }
}

/// Closed form: Euler–Bernoulli, ω = (nπ/L)² √(EI/m).
#[test]
fn a_beam_on_a_pin_and_a_roller_bends_in_half_waves() {
    let beam = Beam { turn: Matrix3::identity(), ..Beam::default() };
    let model = beam.model();
    let end = model.positions.len() as u32 - 1;
    let dofs = [(0, 0), (0, 1), (0, 2), (0, 3), (end, 1), (end, 2)];
    let support = Support::of_dofs(&model.positions, &dofs).unwrap();
    assert_eq!(support.motion.count(), 0);
    let modes = model.modes(&support, 6);
    for (k, lambda) in modes.eigenvalues.iter().enumerate() {
        let wave = PI * (k / 2 + 1) as f64 / beam.length;
        let expected = wave.powi(2) * (beam.stiffness[2] / beam.mass[0]).sqrt();
        // 2.6e-4 of the third pair
        assert!((0.0..4e-4).contains(&(lambda.sqrt() / expected - 1.0)), "{k}: {} {expected}", lambda.sqrt());
    }
}

/// Closed form: Euler–Bernoulli, clamped and pinned, each free at the other end.
#[test]
fn one_node_with_rotations_clamps_pins_or_hinges_a_beam() {
    let beam = Beam { turn: Matrix3::identity(), ..Beam::default() };
    let model = beam.model();
    let point = Vector3::from(model.positions[0]);
    let by_dofs = |dofs: &[usize]| {
        let pairs: Vec<(u32, usize)> = dofs.iter().map(|dof| (0, *dof)).collect();
        model.modes(&Support::of_dofs(&model.positions, &pairs).unwrap(), 4)
    };
    let cases = [
        (RigidMotion::clamp(point), vec![0, 1, 2, 3, 4, 5], 1.875_104_068_711_961),
        (RigidMotion::pin(point), vec![0, 1, 2], 3.926_602_312_047_919),
        (RigidMotion::hinge(point, Vector3::z()), vec![0, 1, 2, 3, 4], 1.875_104_068_711_961),
    ];
    for (motion, dofs, root) in cases {
        let by_node = model.modes(&Support::new(motion, vec![0]), 4);
        let by_dofs = by_dofs(&dofs);
        let found = by_dofs.rigid.motion;
        assert_eq!((found.count(), found.others().len()), (motion.count(), 0), "{found:?}");
        for (a, b) in by_node.eigenvalues.iter().zip(&by_dofs.eigenvalues) {
            assert!((a / b - 1.0).abs() < 1e-9, "{motion:?}: {a} {b}");
        }
        let expected = (root / beam.length).powi(2) * (beam.stiffness[2] / beam.mass[0]).sqrt();
        let off = by_node.eigenvalues[0].sqrt() / expected - 1.0;
        assert!(off.abs() < 1e-5, "{motion:?}: {off:e}");
    }
}

#[test]
fn degrees_of_freedom_that_are_not_there_are_refused() {
    let positions = &body().positions;
    let error = Support::of_dofs(positions, &[(1000, 0)]).unwrap_err();
    assert!(matches!(error, ModalError::HeldNode { node: 1000, .. }), "{error}");
    let error = Support::of_dofs(positions, &[(1, 6)]).unwrap_err();
    assert!(matches!(error, ModalError::HeldFreedom { node: 1, dof: 6, count: 6 }), "{error}");
    // A rotation of a node that has none.
    let support = Support::of_dofs(positions, &[(1, 4)]).unwrap();
    let body = body();
    let error = modal::Solver::new(body.matrices.stiffness(), body.matrices.mass(), positions, &support).err().unwrap();
    assert!(matches!(error, ModalError::HeldFreedom { node: 1, dof: 4, count: 3 }), "{error}");
    assert!(error.to_string().contains("translations along x, y and z"));
}
