//! Bodies from matrices of other programs: six degrees of freedom a node, and masses that are not a scalar for each pair of nodes.

use faer::sparse::{SparseColMat, Triplet};
use modal::{
    MassMatrix, ModalError, NodalMass, NodalStiffness, Solver, Support, TiedPoint, acceleration_fields,
    centrifugal_fields, mass_with_points,
};
use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};
use reduced_body::{BodyError, ReducedBody, RigidMotion};

use crate::beam::{Beam, Sparse, order};
use crate::held::supports;

/// Closed form: roots of cosh x cos x = 1: a beam with free ends.
const FREE: [f64; 3] = [4.730_040_744_862_704, 7.853_204_624_095_838, 10.995_607_838_001_671];

/// ω of bending for a root.
fn bending(beam: &Beam, root: f64) -> f64 {
    (root / beam.length).powi(2) * (beam.stiffness[2] / beam.mass[0]).sqrt()
}

/// Closed form: Euler–Bernoulli, free at both ends; mass and inertia of a rod.
#[test]
fn a_free_beam_has_the_mass_and_the_frequencies_of_theory() {
    let beam = Beam::default();
    let model = beam.model();
    let modes = model.modes(&Support::free(), 6);
    let rigid = &modes.rigid;
    let mass = beam.mass[0] * beam.length;
    assert!((rigid.mass / mass - 1.0).abs() < 1e-12);
    let middle = Vector3::from(model.positions[0]) + beam.turn * Vector3::x() * (0.5 * beam.length);
    assert!((rigid.center_of_mass - middle).norm() < 1e-12);
    let across = mass * beam.length.powi(2) / 12.0;
    let about = Matrix3::from_diagonal(&Vector3::new(beam.mass[1] * beam.length, across, across));
    let inertia = beam.turn * about * beam.turn.transpose();
    assert!((rigid.inertia - inertia).norm() < 1e-12 * across, "{}", rigid.inertia - inertia);

    let omega: Vec<f64> = modes.eigenvalues.iter().map(|lambda| lambda.sqrt()).collect();
    for (found, root) in omega.iter().zip([FREE[0], FREE[0], FREE[1], FREE[1], FREE[2], FREE[2]]) {
        let off = found / bending(&beam, root) - 1.0;
        // 4.6e-4 of the third pair
        assert!((0.0..6e-4).contains(&off), "{found}: {off:e}");
    }
    let mut all = rigid.shapes.clone();
    all.resize_with(all.nrows(), 12, |i, j| modes.shapes[(i, j - 6)]);
    let gram = all.transpose() * (model.mass.as_ref() * &all);
    assert!((gram - faer::Mat::<f64>::identity(12, 12)).norm_max() < 1e-11);
    assert!((model.stiffness.as_ref() * &rigid.shapes).norm_max() < 1e-9 * beam.stiffness[0]);
}

/// Conserved: order 4 of the Hermite beam, against Euler–Bernoulli.
#[test]
fn frequencies_of_a_beam_converge_with_the_fourth_power_of_its_elements() {
    let elements = [6, 8, 12, 16];
    let errors: Vec<f64> = elements
        .iter()
        .map(|n| {
            let beam = Beam { elements: *n, ..Beam::default() };
            beam.model().modes(&Support::free(), 2).eigenvalues[0].sqrt() / bending(&beam, FREE[0]) - 1.0
        })
        .collect();
    let order = order(&elements, &errors);
    assert!((order - 4.0).abs() < 0.1, "{order}: {errors:?}");
}

/// Closed form: G of a pair of modes is a turn by 90°, N is 1.
#[test]
fn a_turn_about_its_own_axis_is_exact_for_a_beam() {
    // It commutes with the mass of a beam: both modes of a pair turn into each other.
    let beam = Beam { turn: Matrix3::identity(), ..Beam::default() };
    let model = beam.model();
    let modes = model.modes(&Support::free(), 4);
    let reduced = modes.reduced(model.mass.as_ref(), &model.positions).unwrap();
    for first in [0, 2] {
        let pair = reduced.gyroscopic[0].submatrix(first, first, 2, 2);
        assert!((pair[(0, 1)].abs() - 1.0).abs() < 1e-9 && pair[(0, 0)].abs() < 1e-9, "{pair:?}");
        let second = reduced.inertia_second[0].submatrix(first, first, 2, 2);
        assert!((second.to_owned() - faer::Mat::<f64>::identity(2, 2)).norm_max() < 1e-9, "{second:?}");
    }
}

/// Conserved: order 2, against ∫x sin(πx/L) dx and ∫ρv² dx.
#[test]
fn what_the_deformed_inertia_leaves_out_vanishes_with_the_square_of_the_elements() {
    // About an axis across: N of the first bending modes, of which ∫ρ v² counts where the axis is across to v, and c of the
    // first stretching mode, √(2m/L)∫ x sin(πx/L) dx, where that is not stretched by bending modes.
    let elements = [6, 8, 12, 16];
    let (mut second, mut first) = (Vec::new(), Vec::new());
    for n in elements {
        let beam = Beam { elements: n, turn: Matrix3::identity(), stiffness: [90.0, 9e4, 9e4, 9e4], ..Beam::default() };
        let model = beam.model();
        let modes = model.modes(&Support::free(), 1);
        let reduced = modes.reduced(model.mass.as_ref(), &model.positions).unwrap();
        let exact = (2.0 * beam.mass[0] / beam.length).sqrt() * 2.0 * (beam.length / std::f64::consts::PI).powi(2);
        first.push(reduced.inertia_first[1][0].abs() / exact - 1.0);

        // Hardly any rotary inertia about the line, which turns with the nodes in second order.
        let (stiffness, mass) = ([3e5, 4e-2, 90.0, 90.0], [1.5, 1e-7]);
        let beam = Beam { elements: n, turn: Matrix3::identity(), stiffness, mass, ..Beam::default() };
        let model = beam.model();
        let modes = model.modes(&Support::free(), 2);
        let reduced = modes.reduced(model.mass.as_ref(), &model.positions).unwrap();
        // The pair has some direction in the plane across; the sum over y and z does not depend on it.
        let trace = |p: usize| reduced.inertia_second[p][(0, 0)] + reduced.inertia_second[p][(1, 1)];
        second.push((trace(1) + trace(2)) / 2.0 - 1.0);
    }
    for (what, errors) in [("c", first), ("N", second)] {
        let order = order(&elements, &errors);
        assert!((order - 2.0).abs() < 0.15 && errors[3].abs() < 0.02, "{what}: {order} {errors:?}");
    }
}

/// Masses and rotary inertias on the nodes of the beam.
fn lumped(nodes: usize) -> (Vec<f64>, Vec<Matrix3<f64>>) {
    let inertia = |i: usize| {
        let turn = Rotation3::from_euler_angles(i as f64, 2.0 * i as f64, 0.3).into_inner();
        turn * Matrix3::from_diagonal(&Vector3::new(0.02, 0.05, 0.04 + 0.001 * i as f64)) * turn.transpose()
    };
    ((0..nodes).map(|i| 0.2 + 0.03 * i as f64).collect(), (0..nodes).map(inertia).collect())
}

fn lumped_mass(masses: &[f64], inertias: &[Matrix3<f64>]) -> Sparse {
    let mut entries = Vec::new();
    for (node, (mass, inertia)) in masses.iter().zip(inertias).enumerate() {
        for i in 0..3 {
            entries.push(Triplet::new(6 * node + i, 6 * node + i, *mass));
            for j in 0..3 {
                let value = 0.5 * (inertia[(i, j)] + inertia[(j, i)]);
                entries.push(Triplet::new(6 * node + 3 + i, 6 * node + 3 + j, value));
            }
        }
    }
    SparseColMat::try_new_from_triplets(6 * masses.len(), 6 * masses.len(), &entries).unwrap()
}

/// Independent reference: central differences of the inertia, node by node.
#[test]
fn rotary_inertias_turn_with_their_nodes() {
    // The inertia of the deformed body, node by node with R J Rᵀ, changes as 2 c·q says.
    let mut model = Beam { elements: 5, ..Beam::default() }.model();
    let (masses, inertias) = lumped(6);
    model.mass = lumped_mass(&masses, &inertias);
    let modes = model.modes(&Support::free(), 8);
    let reduced = modes.reduced(model.mass.as_ref(), &model.positions).unwrap();
    let inertia = |mode: usize, q: f64| -> Matrix3<f64> {
        let of_node = |node: usize| {
            let part = |first: usize| Vector3::from_fn(|i, _| q * modes.shapes[(6 * node + first + i, mode)]);
            let x = Vector3::from(model.positions[node]) - reduced.origin + part(0);
            let turn = Rotation3::from_scaled_axis(part(3)).into_inner();
            masses[node] * (Matrix3::identity() * x.norm_squared() - x * x.transpose())
                + turn * inertias[node] * turn.transpose()
        };
        (0..masses.len()).map(of_node).sum()
    };
    assert!((inertia(0, 0.0) - reduced.inertia).norm() < 1e-12 * reduced.inertia.norm());
    let q = 1e-5;
    let mut largest = 0.0_f64;
    for mode in 0..8 {
        let rate = (inertia(mode, q) - inertia(mode, -q)) / (2.0 * q);
        for (pair, (i, j)) in ReducedBody::PAIRS.into_iter().enumerate() {
            let found = 2.0 * reduced.inertia_first[pair][mode];
            assert!((found - rate[(i, j)]).abs() < 1e-8, "mode {mode}, {i}{j}: {found} {}", rate[(i, j)]);
            largest = largest.max(found.abs());
        }
    }
    assert!(largest > 0.1, "{largest}");
    assert!(reduced.gyroscopic.iter().all(|g| (g + g.transpose()).norm_max() == 0.0 && g.norm_max() > 1e-3));
}

/// Conserved: Kφ = λMφ.
#[test]
fn nodes_without_rotary_inertia_have_modes_too() {
    let mut model = Beam::default().model();
    let masses = vec![0.25; 13];
    model.mass = lumped_mass(&masses, &[Matrix3::zeros(); 13]);
    // One end is clamped: a chain of masses in line has no inertia against a turn about the line.
    let support = Support::new(RigidMotion::clamp(model.positions[0].into()), vec![0]);
    let modes = model.modes(&support, 36);
    assert_eq!(modes.eigenvalues.len(), 36);
    let error = model.solver(&support).unwrap().modes(37, |_| ()).unwrap_err();
    assert!(matches!(error, ModalError::TooManyModes { available: 36, .. }), "{error}");
    let k = model.stiffness.as_ref() * &modes.shapes;
    let m = model.mass.as_ref() * &modes.shapes;
    for (mode, lambda) in modes.eigenvalues.iter().enumerate() {
        let rest: f64 = (6..78).map(|i| (k[(i, mode)] - lambda * m[(i, mode)]).powi(2)).sum::<f64>().sqrt();
        let whole: f64 = (6..78).map(|i| (lambda * m[(i, mode)]).powi(2)).sum::<f64>().sqrt();
        assert!(rest < 1e-7 * whole, "mode {mode}: {:e}", rest / whole);
    }
    let error = model.solver(&Support::free()).err().unwrap();
    assert!(matches!(error, ModalError::Body(BodyError::NoInertia { .. })), "{error}");
}

/// Conserved: both storages of the mass give the same.
#[test]
fn solid_elements_are_the_same_with_any_storage_of_their_mass() {
    for (support, _) in supports::supports(&supports::body().positions) {
        let body = supports::body();
        let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
        // Off by more than rounding in one place, so that it is no scalar for each pair of nodes any more.
        let entries: Vec<_> = m
            .triplet_iter()
            .map(|t| Triplet::new(t.row, t.col, t.val * if (t.row, t.col) == (4, 4) { 1.0 + 1e-11 } else { 1.0 }))
            .collect();
        let general: Sparse = SparseColMat::try_new_from_triplets(m.nrows(), m.ncols(), &entries).unwrap();
        assert!(matches!(MassMatrix::new(general.as_ref(), body.positions.len()), Ok(MassMatrix::General(_))));
        let nodal = body.held(&support);
        let solver = Solver::new(k, general.as_ref(), &body.positions, &support).unwrap();
        for (a, b) in nodal.mass().row_sums().iter().zip(solver.mass().row_sums()) {
            assert!((a - b).abs() < 1e-10 * a.abs().max(1e-9));
        }
        let origin = nodal.rigid().origin;
        let close = |a: &faer::Mat<f64>, b: &faer::Mat<f64>| (a - b).norm_max() <= 1e-9 * a.norm_max();
        assert!(close(&acceleration_fields(nodal.mass()), &acceleration_fields(solver.mass())));
        let fields = |mass| centrifugal_fields(mass, &body.positions, &origin).unwrap();
        assert!(close(&fields(nodal.mass()), &fields(solver.mass())));

        let modes = nodal.modes(6, |_| ()).unwrap();
        for (a, b) in modes.eigenvalues.iter().zip(&solver.modes(6, |_| ()).unwrap().eigenvalues) {
            assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
        }
        // The same shapes, so that no sign or turn of a pair stands between.
        let expected = modes.reduced(m, &body.positions).unwrap();
        let found = modes.reduced(general.as_ref(), &body.positions).unwrap();
        let matrices = |body: &ReducedBody| -> Vec<faer::Mat<f64>> {
            let vectors = [&body.inertia_first[..], &body.translation_first, &body.rotation_first].concat();
            let products = body.position_products.iter().flatten().chain(&vectors);
            let columns = products.map(|v| faer::Mat::from_fn(v.len(), 1, |i, _| v[i]));
            let all = body.rotation_products.iter().flatten().chain(&body.inertia_second).chain(&body.gyroscopic);
            all.cloned().chain(columns).collect()
        };
        for (a, b) in matrices(&expected).iter().zip(&matrices(&found)) {
            assert!((a - b).norm_max() <= 1e-10 * a.norm_max().max(1.0), "{:e}", (a - b).norm_max());
        }
    }
}

/// Independent reference: the inertia of the deformed body as the sum over pairs of nodes and over the point, which the rigid motion of a flat face by
/// the normal equations moves; Kφ = λMφ of a mass that is held by rows.
#[test]
fn a_mass_beside_a_face_moves_with_its_rigid_motion() {
    let body = supports::body();
    let (matrices, positions) = (&body.matrices, &body.positions);
    let face = supports::nodes(positions, |x| x.x < -14.9);
    let (at, m) = ([-23.0, 4.0, 6.0], 0.7 * matrices.mass().val().iter().sum::<f64>() / 3.0);
    let points = [TiedPoint::new(m, at, face.clone(), positions).unwrap()];
    let nodal = || NodalMass::of_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes()).unwrap();
    let stiffness = NodalStiffness::new(matrices.start(), matrices.nodes(), matrices.stiffness_by_nodes()).unwrap();
    let matrix = mass_with_points(&nodal(), &points).unwrap();
    let mass = MassMatrix::with_points(matrix.as_ref(), nodal(), &points);
    let solver = Solver::of_nodes(stiffness, mass, positions, &Support::free()).unwrap();
    let modes = solver.modes(5, |_| ()).unwrap();
    let reduced = modes.reduced_by(solver.mass(), positions).unwrap();

    // The point in a field, by the rigid motion that fits the face.
    let rigid = |node: &u32| {
        let x = Vector3::from(positions[*node as usize]);
        SMatrix::<f64, 3, 6>::from_fn(
            |i, k| if k < 3 { f64::from(i == k) } else { Vector3::ith(k - 3, 1.0).cross(&x)[i] },
        )
    };
    let normal: SMatrix<f64, 6, 6> = face.iter().map(|node| rigid(node).tr_mul(&rigid(node))).sum();
    let of_point = |u: &dyn Fn(u32) -> Vector3<f64>| {
        let right: SMatrix<f64, 6, 1> = face.iter().map(|node| rigid(node).tr_mul(&u(*node))).sum();
        let motion = normal.try_inverse().unwrap() * right;
        Vector3::new(motion[0], motion[1], motion[2])
            + Vector3::new(motion[3], motion[4], motion[5]).cross(&Vector3::from(at))
    };
    let second = |x: Vector3<f64>, y: Vector3<f64>| Matrix3::identity() * x.dot(&y) - x * y.transpose();
    let inertia = |mode: usize, q: f64| {
        let u = |node: u32| Vector3::from_fn(|axis, _| q * modes.shapes[(3 * node as usize + axis, mode)]);
        let place = |node: usize| Vector3::from(positions[node]) + u(node as u32) - modes.rigid.origin;
        let of_column = |node: usize| {
            let range = matrices.start()[node]..matrices.start()[node + 1];
            let pairs = matrices.nodes()[range.clone()].iter().zip(&matrices.mass_by_nodes()[range]);
            pairs.map(|(other, m)| second(place(*other as usize), place(node)) * *m).sum::<Matrix3<f64>>()
        };
        let p = Vector3::from(at) + of_point(&u) - modes.rigid.origin;
        (0..positions.len()).map(of_column).sum::<Matrix3<f64>>() + second(p, p) * m
    };
    assert!((inertia(0, 0.0) - reduced.inertia).norm() < 1e-12 * reduced.inertia.norm());
    let fields = centrifugal_fields(solver.mass(), positions, &modes.rigid.origin).unwrap();
    let on_modes = modes.shapes.transpose() * &fields;
    for mode in 0..5 {
        let q = 0.1 / modes.shapes.col(mode).norm_max();
        let [plus, minus] = [inertia(mode, q), inertia(mode, -q)];
        for (pair, (i, j)) in ReducedBody::PAIRS.into_iter().enumerate() {
            let first = (plus - minus)[(i, j)] / (4.0 * q);
            assert!(
                (first - reduced.inertia_first[pair][mode]).abs() < 1e-9 * reduced.inertia.norm() / q,
                "{mode} {i}{j}"
            );
            assert!(
                (on_modes[(mode, pair)] - reduced.inertia_first[pair][mode]).abs() < 1e-9 * reduced.inertia.norm() / q
            );
            let curved = ((plus + minus) * 0.5 - inertia(mode, 0.0))[(i, j)] / (q * q);
            let found = reduced.inertia_second[pair][(mode, mode)];
            assert!((curved - found).abs() < 1e-8 * (1.0 + found.abs()), "{mode} {i}{j}: {curved} {found}");
        }
    }
    let (k, momenta) = (matrices.stiffness() * &modes.shapes, solver.mass().product(modes.shapes.as_ref()));
    for (mode, lambda) in modes.eigenvalues.iter().enumerate() {
        let rest: f64 = (0..k.nrows()).map(|i| (k[(i, mode)] - lambda * momenta[(i, mode)]).powi(2)).sum();
        assert!(rest.sqrt() < 1e-7 * lambda * momenta.col(mode).norm_l2(), "mode {mode}");
    }
    // What moves as a line of nodes does not tell a turn about it.
    let line = supports::nodes(positions, |x| x.x < -14.9 && x.y < -6.9);
    assert!(TiedPoint::new(1.0, at, line.clone(), positions).is_none());
    assert!(TiedPoint::new(1.0, [-15.0, -7.0, 30.0], line, positions).is_some());
}

#[test]
fn matrices_that_are_of_no_body_are_refused() {
    let model = Beam::default().model();
    let refused = |k: &Sparse, m: &Sparse, support: &Support, words: &str| -> ModalError {
        let solver = Solver::new(k.as_ref(), m.as_ref(), &model.positions, support);
        let error = solver.and_then(|solver| solver.modes(3, |_| ())).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        error
    };
    let changed = |matrix: &Sparse, change: &dyn Fn(usize, usize, f64) -> f64| -> Sparse {
        let entries: Vec<_> =
            matrix.triplet_iter().map(|t| Triplet::new(t.row, t.col, change(t.row, t.col, *t.val))).collect();
        SparseColMat::try_new_from_triplets(matrix.nrows(), matrix.ncols(), &entries).unwrap()
    };
    let (k, m, free) = (&model.stiffness, &model.mass, Support::free());
    let skewed = |i: usize, j: usize, value: f64| if (i, j) == (5, 4) { value + 0.1 } else { value };
    assert!(matches!(refused(k, &changed(m, &skewed), &free, "mirror image"), ModalError::NotSymmetric { .. }));
    assert!(matches!(refused(&changed(k, &skewed), m, &free, "mirror image"), ModalError::NotSymmetric { .. }));
    // A mass on a node that resists along z only, as water beside a hull does.
    let heavier = |i: usize, j: usize, value: f64| if (i, j) == (2, 2) { value + 0.1 } else { value };
    let error = refused(k, &changed(m, &heavier), &free, "mass along the axes");
    assert!(matches!(error, ModalError::NoRigidBodyMass { relative, .. } if relative > 1e-3), "{error}");
    let indefinite = |i: usize, j: usize, value: f64| if (i, j) == (3, 3) { 0.01 * value } else { value };
    assert!(matches!(refused(k, &changed(m, &indefinite), &free, "semi-definite"), ModalError::IndefiniteMass { .. }));
    // A spring that a rotation meets.
    let held = |i: usize, j: usize, value: f64| if (i, j) == (9, 9) { value + 1.0 } else { value };
    assert!(matches!(refused(&changed(k, &held), m, &free, "not free"), ModalError::NotFree { .. }));
    assert!(matches!(refused(&changed(k, &|_, _, v| -v), m, &free, "semi-definite"), ModalError::Indefinite { .. }));

    // Of a clamped body the same masses have modes, but it cannot be moved.
    let clamp = Support::new(RigidMotion::clamp(model.positions[12].into()), vec![12]);
    let heavy = changed(m, &heavier);
    let solver = Solver::new(k.as_ref(), heavy.as_ref(), &model.positions, &clamp).unwrap();
    let (lighter, heavier) = (model.modes(&clamp, 2), solver.modes(2, |_| ()).unwrap());
    assert!(heavier.eigenvalues[0] < 0.99 * lighter.eigenvalues[0]);
    let error = heavier.reduced(heavy.as_ref(), &model.positions).unwrap_err();
    assert!(matches!(error, ModalError::NoRigidBodyMass { .. }), "{error}");
    // Six rows a node where the mass has three.
    let solid = supports::body();
    let error = Solver::new(k.as_ref(), solid.matrices.mass(), &model.positions, &free).err().unwrap();
    assert!(matches!(error, ModalError::Size { what: "mass", expected: 78, .. }), "{error}");
}

/// Closed form: Euler–Bernoulli, clamped and free.
#[test]
fn a_rotation_that_nothing_resists_is_named() {
    // Two bars in line without torsion, of which the rotation about the line has neither stiffness nor mass.
    let beam =
        Beam { stiffness: [3e4, 0.0, 90.0, 90.0], mass: [1.5, 0.0], turn: Matrix3::identity(), ..Beam::default() };
    let model = beam.model();
    let clamp = Support::new(RigidMotion::clamp(model.positions[0].into()), vec![0]);
    let error = model.solver(&clamp).err().unwrap();
    assert!(matches!(error, ModalError::Loose { node: 1, dof: 3 }), "{error}");
    // Held by themselves they are out of the way.
    let dofs: Vec<(u32, usize)> = (0..6).map(|f| (0, f)).chain((1..13).map(|node| (node, 3))).collect();
    let support = Support::of_dofs(&model.positions, &dofs).unwrap();
    let found = model.modes(&support, 2).eigenvalues[0].sqrt();
    assert!((found / bending(&beam, 1.875_104_068_711_961) - 1.0).abs() < 1e-6, "{found}");
}
