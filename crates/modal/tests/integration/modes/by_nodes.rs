//! Matrices over pairs of nodes against the same ones in compressed columns.

use faer::sparse::{SparseColMat, Triplet};
use modal::{ModalError, Modes, NodalMass, NodalStiffness, Solver, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::{Body, block};

fn small() -> Body {
    block([10.0, 8.0, 6.0], [3, 2, 2])
}

/// Modes of the block with other values of K and M.
fn modes(body: &Body, stiffness: &[f64], mass: &[f64], support: &Support) -> Result<Modes, ModalError> {
    let (start, nodes) = (body.matrices.start(), body.matrices.nodes());
    let stiffness = NodalStiffness::new(start, nodes, stiffness)?;
    let mass = NodalMass::of_nodes(start, nodes, mass)?;
    Solver::of_nodes(stiffness, mass, &body.positions, support)?.modes(6, |_| ())
}

/// The block's stiffness with one entry changed.
fn with_entry(body: &Body, entry: usize, change: impl Fn(f64) -> f64) -> Result<Modes, ModalError> {
    let mut stiffness = body.matrices.stiffness_by_nodes().to_vec();
    stiffness[entry] = change(stiffness[entry]);
    modes(body, &stiffness, body.matrices.mass_by_nodes(), &Support::free())
}

/// Conserved: both storages of the matrices give the same modes.
#[test]
fn they_give_the_same_modes_from_the_same_shift() {
    let body = small();
    let corner = body.positions[0];
    // The nodes that share this number of coordinates with the first.
    let sharing = |axes: &[usize]| -> Vec<u32> {
        (0..).zip(&body.positions).filter(|(_, x)| axes.iter().all(|a| x[*a] == corner[*a])).map(|(i, _)| i).collect()
    };
    let clamp = Support::new(RigidMotion::clamp(corner.into()), sharing(&[0]));
    let hinge = Support::new(RigidMotion::hinge(corner.into(), Vector3::z()), sharing(&[0, 1]));
    for support in [Support::free(), clamp, hinge] {
        let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
        let expected = Solver::new(k, m, &body.positions, &support).unwrap().modes(6, |_| ()).unwrap();
        let (k, m) = (body.matrices.stiffness_by_nodes(), body.matrices.mass_by_nodes());
        let found = modes(&body, k, m, &support).unwrap();
        // Two ways to the same estimate: fields on all nodes, and sums over monomials.
        assert!(
            (found.stats.shift / expected.stats.shift - 1.0).abs() < 1e-12,
            "{} {}",
            found.stats.shift,
            expected.stats.shift
        );
        assert_eq!(found.stats.factor_entries, expected.stats.factor_entries);
        for (a, b) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
            assert!((a / b - 1.0).abs() < 1e-11, "{a} {b}");
        }
        assert!((&found.shapes - &expected.shapes).norm_max() < 1e-8 * expected.shapes.norm_max());
        assert!(found.stats.peak_bytes < expected.stats.peak_bytes);
    }
}

/// Conserved: the same modes with and without the zeros of K stored.
#[test]
fn mass_may_couple_nodes_that_stiffness_does_not() {
    let body = block([10.0, 8.0, 6.0], [6, 5, 4]);
    let count = body.positions.len();
    let heavy = body.matrices.mass_by_nodes().iter().copied().fold(0.0, f64::max);
    // The first node with some that are far from it, as a mass that moves with the mean of them.
    let far: Vec<usize> = (0..count).filter(|node| node % 97 == 0).collect();
    let added: Vec<_> = far.iter().flat_map(|i| far.iter().map(|j| (*i, *j, 20.0 * heavy))).collect();
    let csc = |size: usize, entries: Vec<Triplet<usize, usize, f64>>| {
        SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries).unwrap()
    };
    let (start, nodes) = (body.matrices.start(), body.matrices.nodes());
    let own = body.matrices.mass_by_nodes();
    let of_column = |j: usize| (start[j]..start[j + 1]).map(move |k| Triplet::new(nodes[k] as usize, j, own[k]));
    let scalar = (0..count).flat_map(of_column).chain(added.iter().map(|(i, j, m)| Triplet::new(*i, *j, *m)));
    let scalar = csc(count, scalar.collect());
    let along = |i, j, m: f64| (0..3).map(move |axis| Triplet::new(3 * i + axis, 3 * j + axis, m));
    let mass = csc(3 * count, scalar.triplet_iter().flat_map(|e| along(e.row, e.col, *e.val)).collect());
    let stiffness = body.matrices.stiffness();
    // Zeros where M has more: one pattern, as an assembly has it.
    let zeros = added.iter().flat_map(|(i, j, _)| along(*i, *j, 0.0));
    let entries = stiffness.triplet_iter().map(|e| Triplet::new(e.row, e.col, *e.val)).chain(zeros);
    let with_zeros = csc(3 * count, entries.collect());
    assert!(with_zeros.row_idx().len() > stiffness.row_idx().len());

    let of_nodes = scalar.row_idx().iter().map(|node| *node as u32).collect::<Vec<_>>();
    let of_nodes = NodalMass::of_nodes(scalar.col_ptr(), &of_nodes, scalar.val()).unwrap();
    let by_nodes = NodalStiffness::new(start, nodes, body.matrices.stiffness_by_nodes()).unwrap();
    let free = Support::free();
    let expected = Solver::new(with_zeros.as_ref(), mass.as_ref(), &body.positions, &free).unwrap();
    let expected = expected.modes(6, |_| ()).unwrap();
    let lowest = body.modes(1).eigenvalues[0];
    assert!(expected.eigenvalues[0] < 0.9 * lowest, "{} {lowest}", expected.eigenvalues[0]);
    let by_columns = Solver::new(stiffness, mass.as_ref(), &body.positions, &free).unwrap();
    let by_nodes = Solver::of_nodes(by_nodes, of_nodes, &body.positions, &free).unwrap();
    for solver in [by_columns, by_nodes] {
        let found = solver.modes(6, |_| ()).unwrap();
        for (a, b) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
            assert!((a / b - 1.0).abs() < 1e-10, "{a} {b}");
        }
        assert!((&found.shapes - &expected.shapes).norm_max() < 1e-7 * expected.shapes.norm_max());
    }
}

#[test]
fn what_is_wrong_with_them_is_named() {
    let body = small();
    let (start, nodes) = (body.matrices.start(), body.matrices.nodes());
    // The first column of node 1, the row along y of the last node that it is coupled to.
    let count = start[2] - start[1];
    let (entry, row) = (9 * start[1] + 3 * (count - 1) + 1, 3 * nodes[start[2] - 1] as usize + 1);
    match with_entry(&body, entry, |_| f64::NAN) {
        Err(ModalError::NotFinite { what: "stiffness", place: "column", index: 3, value }) => assert!(value.is_nan()),
        other => panic!("{other:?}"),
    }
    // Much less than the largest entry on the diagonal, and still no rounding.
    let scale = body.matrices.stiffness_by_nodes().iter().copied().fold(0.0, f64::max);
    match with_entry(&body, entry, |k| k + 1e-7 * scale) {
        Err(ModalError::NotSymmetric { what: "stiffness", row: found, column, .. }) => {
            // The one or the other of the two is the first to be met.
            assert!([found, column] == [row, 3] || [found, column] == [3, row], "({found}, {column})");
        }
        other => panic!("{other:?}"),
    }
    // A spring to the ground on the diagonal of node 0.
    let place = nodes[..start[1]].iter().position(|node| *node == 0).unwrap();
    match with_entry(&body, 3 * place, |k| 2.0 * k) {
        Err(ModalError::NotFree { .. }) => {}
        other => panic!("{other:?}"),
    }
    let mut mass = body.matrices.mass_by_nodes().to_vec();
    mass[1] *= 1.001;
    match modes(&body, body.matrices.stiffness_by_nodes(), &mass, &Support::free()) {
        Err(ModalError::NotSymmetric { what: "mass", .. }) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn lists_that_do_not_fit_together_are_refused() {
    let body = small();
    let (start, nodes) = (body.matrices.start(), body.matrices.nodes());
    let values = body.matrices.stiffness_by_nodes();
    let refused =
        |start: &[usize], nodes: &[u32], values: &[f64]| NodalStiffness::new(start, nodes, values).unwrap_err();
    assert!(matches!(refused(&start[1..], nodes, values), ModalError::Length { .. }));
    assert!(matches!(refused(&[], nodes, values), ModalError::Length { .. }));
    assert!(matches!(refused(start, nodes, &values[1..]), ModalError::Length { .. }));
    let mut swapped = nodes.to_vec();
    swapped.swap(0, 1);
    assert!(matches!(refused(start, &swapped, values), ModalError::Unsorted { node: 0 }));
    let mut beyond = nodes.to_vec();
    *beyond.last_mut().unwrap() = start.len() as u32;
    assert!(matches!(refused(start, &beyond, values), ModalError::NoNode { .. }));
    let mass = body.matrices.mass_by_nodes();
    assert!(matches!(NodalMass::of_nodes(start, nodes, &mass[1..]), Err(ModalError::Length { .. })));
    assert!(NodalMass::of_nodes(start, nodes, mass).is_ok());
}
