//! The constants of the reduced body against their definitions, evaluated node by node in physical space.

use faer::Mat;
use modal::{Modes, Support};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{Constants, ReducedBody};

use crate::bodies::Body;
use crate::held::supports;

const NF: usize = 7;
/// The order in which pairs ij are stored.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

struct Case {
    body: Body,
    modes: Modes,
    reduced: ReducedBody,
    /// Ψ, rigid modes first.
    psi: Mat<f64>,
    /// X from the origin.
    x: Mat<f64>,
}

fn case() -> Case {
    held_case(&Support::free())
}

fn held_case(support: &Support) -> Case {
    let body = supports::body();
    let modes = body.held(support).modes(NF, |_| ()).unwrap();
    let reduced = modes.reduced(body.matrices.mass(), &body.positions).unwrap();
    let psi = Mat::from_fn(modes.shapes.nrows(), 6 + NF, |i, j| {
        if j < 6 { modes.rigid.shapes[(i, j)] } else { modes.shapes[(i, j - 6)] }
    });
    let origin = support.motion.fixed_point().unwrap_or(modes.rigid.center_of_mass);
    let x = Mat::from_fn(3 * body.positions.len(), 1, |i, _| body.positions[i / 3][i % 3] - origin[i % 3]);
    Case { body, modes, reduced, psi, x }
}

/// `Lᵀ M (I⊗A) R`, literally.
fn product(case: &Case, left: &Mat<f64>, a: Matrix3<f64>, right: &Mat<f64>) -> Mat<f64> {
    let turned = Mat::from_fn(right.nrows(), right.ncols(), |i, j| {
        (0..3).map(|axis| a[(i % 3, axis)] * right[(i - i % 3 + axis, j)]).sum::<f64>()
    });
    left.transpose() * (case.body.matrices.mass() * turned)
}

fn unit(i: usize) -> Vector3<f64> {
    Vector3::ith(i, 1.0)
}

/// Half the sum of `[e_i×]ᵀ[e_j×]` and its mirror image.
fn double_cross(i: usize, j: usize) -> Matrix3<f64> {
    let (a, b) = (unit(i).cross_matrix(), unit(j).cross_matrix());
    0.5 * (a.transpose() * b + b.transpose() * a)
}

fn assert_close(found: &Mat<f64>, expected: &Mat<f64>, what: &str) {
    let scale = expected.norm_max().max(1.0);
    assert!((found - expected).norm_max() < 1e-11 * scale, "{what}: {:e}", (found - expected).norm_max() / scale);
}

fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}

/// Independent reference: the definitions, node by node.
#[test]
fn constants_equal_their_definitions() {
    for (support, _) in supports::supports(&supports::body().positions) {
        assert_definitions(&held_case(&support));
    }
}

fn assert_definitions(case: &Case) {
    let flexible = case.modes.shapes.clone();
    let ones = |axis: usize| Mat::from_fn(case.x.nrows(), 1, |i, _| f64::from(i % 3 == axis));
    for a in 0..3 {
        for b in 0..3 {
            let dyad = unit(a) * unit(b).transpose();
            assert_close(&case.reduced.rotation_products[a][b], &product(case, &case.psi, dyad, &case.psi), "E");
            let expected = product(case, &case.psi, dyad, &case.x);
            assert_close(&column(&case.reduced.position_products[a][b]), &expected, "E^X");
        }
        let expected = product(case, &flexible, unit(a).cross_matrix(), &flexible);
        assert_close(&case.reduced.gyroscopic[a], &expected, "G");
        let expected = product(case, &flexible, Matrix3::identity(), &ones(a));
        assert_close(&column(&case.reduced.translation_first[a]), &expected, "t");
        let expected = product(case, &flexible, unit(a).cross_matrix(), &case.x);
        assert_close(&column(&case.reduced.rotation_first[a]), &expected, "b");
    }
    for (p, (i, j)) in PAIRS.into_iter().enumerate() {
        let a = double_cross(i, j);
        assert_close(&column(&case.reduced.inertia_first[p]), &product(case, &flexible, a, &case.x), "c");
        assert_close(&case.reduced.inertia_second[p], &product(case, &flexible, a, &flexible), "N");
    }
}

/// Conserved: the symmetries of the constants.
#[test]
fn symmetries_hold() {
    let Constants { rotation_products, inertia_second, gyroscopic, rotation_basis, inertia, .. } =
        (*case().reduced).clone();
    let trace = &rotation_products[0][0] + &rotation_products[1][1] + &rotation_products[2][2];
    assert!((trace - Mat::<f64>::identity(6 + NF, 6 + NF)).norm_max() < 1e-12);
    for n in &inertia_second {
        assert!((n - n.transpose()).norm_max() < 1e-13);
    }
    for g in &gyroscopic {
        assert!((g + g.transpose()).norm_max() < 1e-13);
        assert!(g.norm_max() > 1e-3);
    }
    let product = rotation_basis * rotation_basis.transpose() * inertia;
    assert!((product - Matrix3::identity()).norm() < 1e-12);
}

/// Conserved: modes have no momentum along the motions that the support allows.
#[test]
fn first_moments_are_those_of_the_motions_that_the_support_prevents() {
    for (support, _) in supports::supports(&supports::body().positions) {
        let Case { reduced, .. } = held_case(&support);
        let largest = |moments: &[Vec<f64>; 3]| moments.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
        let (translation, rotation) = (largest(&reduced.translation_first), largest(&reduced.rotation_first));
        let mass = reduced.mass.sqrt();
        let inertia = reduced.inertia.norm().sqrt();
        let along = |moments: &[Vec<f64>; 3], direction: Vector3<f64>| -> f64 {
            let of = |k: usize| (0..3).map(|i| direction[i] * moments[i][k]).sum::<f64>();
            (0..NF).map(|k| of(k).abs()).fold(0.0, f64::max)
        };
        match (support.motion.translations(), support.motion.rotations()) {
            ([_, _, _], _) => assert_eq!((translation, rotation), (0.0, 0.0)),
            (_, [_, _, _]) => {
                assert_eq!(rotation, 0.0);
                assert!(translation > 0.1 * mass);
            }
            (_, [axis]) => {
                assert!(along(&reduced.rotation_first, *axis) < 1e-12 * inertia);
                assert!(translation > 0.1 * mass && rotation > 0.1 * inertia);
            }
            ([direction], _) => {
                assert!(along(&reduced.translation_first, *direction) < 1e-12 * mass);
                assert!(translation > 0.1 * mass && rotation > 0.1 * inertia);
            }
            _ => assert!(translation > 0.1 * mass && rotation > 0.1 * inertia),
        }
    }
}

/// Independent reference: the inertia of the deformed body, node by node.
#[test]
fn inertia_of_the_deformed_body_is_quadratic_in_the_modes() {
    let case = case();
    let q: Vec<f64> = (0..NF).map(|k| 0.02 * ((3 * k + 1) as f64).sin()).collect();
    let deformed = &case.x + &case.modes.shapes * column(&q);
    let largest = (&deformed - &case.x).norm_max();
    for (p, (i, j)) in PAIRS.into_iter().enumerate() {
        let expected = product(&case, &deformed, double_cross(i, j), &deformed)[(0, 0)];
        let first: f64 = case.reduced.inertia_first[p].iter().zip(&q).map(|(c, q)| c * q).sum();
        let second = (column(&q).transpose() * &case.reduced.inertia_second[p] * column(&q))[(0, 0)];
        let found = case.reduced.inertia[(i, j)] + 2.0 * first + second;
        assert!((found - expected).abs() < 1e-11 * case.reduced.inertia.norm(), "{found} {expected}");
    }
    assert!(largest > 0.1, "deformed by {largest} only");
}

/// Conserved: the rows of the modes.
#[test]
fn points_and_rigid_shapes_are_rows_of_the_modes() {
    let case = case();
    for node in [0, 17, 60] {
        let point = case.modes.point(&case.body.positions, &[node as u32], &[1.0]).unwrap();
        let rigid = case.reduced.rigid_shapes(&point.position_body);
        for axis in 0..3 {
            assert!((0..6).all(|k| (rigid[(axis, k)] - case.psi[(3 * node + axis, k)]).abs() < 1e-12));
            assert!((0..NF).all(|k| point.shapes[(axis, k)] == case.modes.shapes[(3 * node + axis, k)]));
        }
    }
    let middle = case.modes.point(&case.body.positions, &[3, 40], &[0.25, 0.75]).unwrap();
    let mean = |i: usize, k: usize| 0.25 * case.modes.shapes[(9 + i, k)] + 0.75 * case.modes.shapes[(120 + i, k)];
    assert!((0..NF).all(|k| (0..3).all(|i| (middle.shapes[(i, k)] - mean(i, k)).abs() < 1e-14)));
    let place = 0.25 * Vector3::from(case.body.positions[3]) + 0.75 * Vector3::from(case.body.positions[40]);
    assert!((middle.position_body + case.modes.rigid.center_of_mass - place).norm() < 1e-12);
}

/// Conserved: the body of the truncated modes.
#[test]
fn a_truncated_body_is_the_body_of_the_truncated_modes() {
    let case = case();
    let modes = case.modes.truncated(3);
    let expected = modes.reduced(case.body.matrices.mass(), &case.body.positions).unwrap();
    let found = case.reduced.truncated(3);
    assert_eq!(found.circular_frequencies, expected.circular_frequencies);
    let close = |a: &Mat<f64>, b: &Mat<f64>| a.shape() == b.shape() && (a - b).norm_max() < 1e-11 * b.norm_max();
    let pairs = found.rotation_products.iter().flatten().zip(expected.rotation_products.iter().flatten());
    let matrices = found.inertia_second.iter().zip(&expected.inertia_second);
    let gyroscopic = found.gyroscopic.iter().zip(&expected.gyroscopic);
    assert!(pairs.chain(matrices).chain(gyroscopic).all(|(a, b)| close(a, b)));
    let products = found.position_products.iter().flatten().zip(expected.position_products.iter().flatten());
    for (a, b) in products.chain(found.inertia_first.iter().zip(&expected.inertia_first)) {
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    assert_eq!(case.reduced.truncated(100).flexible(), NF);
}
