//! No eigenvalue is missed and none is doubled: against dense solutions and counts of negative pivots.

use crate::bodies::{Body, CORNER, STEEL, block, mesh_file, tetrahedra};
use crate::modes::oracles::{count_below, dense_eigenvalues};

fn assert_equals_dense(body: &Body, flexible: usize, tolerance: f64) {
    let (k, m) = (body.matrices.stiffness(), body.matrices.mass());
    let modes = body.modes(flexible);
    let dense = dense_eigenvalues(k, m);
    assert_eq!(modes.eigenvalues.len(), flexible);
    for (i, (found, expected)) in modes.eigenvalues.iter().zip(&dense[6..]).enumerate() {
        assert!((found / expected - 1.0).abs() < tolerance, "mode {i}: {found:e} instead of {expected:e}");
    }
}

/// Modes whose neighbour has the same eigenvalue, as a list of the sizes of equal groups.
fn multiplicities(eigenvalues: &[f64]) -> Vec<usize> {
    eigenvalues.chunk_by(|a, b| (b / a - 1.0).abs() < 1e-9).map(<[f64]>::len).collect()
}

/// Independent reference: the dense eigenvalues by faer.
#[test]
fn a_coarse_block_has_the_eigenvalues_of_the_dense_problem() {
    assert_equals_dense(&block([30.0, 20.0, 12.0], [3, 2, 2]), 20, 1e-9);
}

/// Independent reference: the dense eigenvalues by faer.
#[test]
fn one_element_gives_all_of_its_24_flexible_modes() {
    for flexible in [1, 5, 8, 9, 17, 23, 24] {
        assert_equals_dense(&tetrahedra(&[CORNER]), flexible, 1e-9);
    }
}

/// Independent reference: the dense eigenvalues by faer; the multiplicities of the cubic group.
#[test]
fn a_cube_has_its_repeated_eigenvalues_in_full() {
    let cube = block([10.0; 3], [2, 2, 2]);
    assert_equals_dense(&cube, 40, 1e-9);
    // The cubic group has representations of one, two and three dimensions; all three kinds turn up.
    let groups = multiplicities(&cube.modes(30).eigenvalues);
    assert!(groups.iter().all(|size| *size <= 3), "{groups:?}");
    assert!([1, 2, 3].iter().all(|size| groups[..groups.len() - 1].contains(size)), "{groups:?}");
}

/// Independent reference: the dense eigenvalues by faer.
#[test]
fn a_square_bar_bends_in_pairs() {
    let bar = block([60.0, 5.0, 5.0], [8, 2, 2]);
    let modes = bar.modes(12);
    assert_equals_dense(&bar, 12, 1e-9);
    let groups = multiplicities(&modes.eigenvalues);
    assert_eq!(groups[..2], [2, 2], "{groups:?}");
}

/// Independent reference: the negative pivots of K − σM, by faer.
#[test]
fn the_notched_ring_has_no_eigenvalue_between_those_found() {
    let ring = Body::new(&mesh_file("ring.msh"), STEEL);
    let modes = ring.modes(12);
    let (k, m) = (ring.matrices.stiffness(), ring.matrices.mass());
    let lambda = &modes.eigenvalues;
    for kept in (1..12).filter(|i| lambda[*i] / lambda[i - 1] > 1.0 + 1e-6) {
        let between = 0.5 * (lambda[kept - 1] + lambda[kept]);
        assert_eq!(count_below(k, m, between), 6 + kept);
    }
    // Each is an eigenvalue on its own account: the count steps across it.
    assert_eq!(count_below(k, m, lambda[0] * (1.0 - 1e-7)), 6);
    assert_eq!(
        count_below(k, m, lambda[11] * (1.0 - 1e-7)),
        6 + lambda.iter().filter(|l| **l < lambda[11] * (1.0 - 1e-7)).count()
    );
}
