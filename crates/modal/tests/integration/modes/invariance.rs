//! Units, the place in space and the numbering of the nodes change nothing.

use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use fem_tet10::Material;
use modal::Modes;

use crate::bodies::{self, Body, STEEL, block, block_mesh, free_modes};

const SIZE: [f64; 3] = [37.0, 20.0, 11.0];
const CELLS: [usize; 3] = [4, 3, 2];

fn assert_same_frequencies(a: &Modes, b: &Modes, tolerance: f64) {
    for (a, b) in a.natural_frequencies().iter().zip(b.natural_frequencies()) {
        assert!((a / b - 1.0).abs() < tolerance, "{a} against {b}: {:e}", a / b - 1.0);
    }
}

/// Conserved: frequencies do not depend on the units.
#[test]
fn metres_and_millimetres_give_the_same_frequencies() {
    let in_mm = block(SIZE, CELLS).modes(12);
    // mm, Mg, s: N/mm²; m, kg, s: Pa.
    let si = Material { young_modulus: STEEL.young_modulus * 1e6, density: STEEL.density * 1e12, ..STEEL };
    let in_m = Body::new(&block_mesh(SIZE.map(|l| 1e-3 * l), CELLS), si).modes(12);
    assert_same_frequencies(&in_mm, &in_m, 1e-9);
    assert!((in_m.rigid.mass / (1e3 * in_mm.rigid.mass) - 1.0).abs() < 1e-12);
}

/// Conserved: frequencies and inertia do not depend on the place.
#[test]
fn a_body_far_from_the_origin_has_the_same_frequencies() {
    let mesh = block_mesh(SIZE, CELLS);
    let positions = mesh.positions().iter().map(|x| [x[0] + 1e6, x[1] - 1e6, x[2] + 1e6]).collect();
    let far = bodies::mesh(positions, mesh.elements().iter().map(|nodes| nodes.map(u64::from)).collect());
    let (near, far) = (Body::new(&mesh, STEEL).modes(12), Body::new(&far, STEEL).modes(12));
    assert_same_frequencies(&near, &far, 1e-6);
    assert!(
        (far.rigid.center_of_mass - near.rigid.center_of_mass - nalgebra::Vector3::new(1e6, -1e6, 1e6)).norm() < 1e-8
    );
    assert!((far.rigid.inertia - near.rigid.inertia).norm() < 1e-8 * near.rigid.inertia.norm());
}

/// Conserved: modes do not depend on the numbering.
#[test]
fn the_numbering_of_the_nodes_changes_neither_frequencies_nor_shapes() {
    let body = block(SIZE, CELLS);
    let n = body.positions.len();
    // Node i becomes node place[i]: a shuffle by a linear congruential generator.
    let mut place: Vec<usize> = (0..n).collect();
    let mut seed = 7_u64;
    for i in (1..n).rev() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        place.swap(i, (seed >> 33) as usize % (i + 1));
    }
    let dof = |i: usize| 3 * place[i / 3] + i % 3;
    let moved = |matrix: SparseColMatRef<'_, usize, f64>| {
        let entries: Vec<_> = matrix.triplet_iter().map(|t| Triplet::new(dof(t.row), dof(t.col), *t.val)).collect();
        SparseColMat::try_new_from_triplets(3 * n, 3 * n, &entries).unwrap()
    };
    let mut positions = vec![[0.0; 3]; n];
    for (i, x) in body.positions.iter().enumerate() {
        positions[place[i]] = *x;
    }
    let (k, m) = (moved(body.matrices.stiffness()), moved(body.matrices.mass()));
    let shuffled = free_modes(k.as_ref(), m.as_ref(), &positions, 12).unwrap();
    let modes = body.modes(12);
    assert_same_frequencies(&modes, &shuffled, 1e-10);
    for mode in 0..12 {
        let back = |i: usize| shuffled.shapes[(dof(i), mode)];
        let scale = modes.shapes.col(mode).norm_max();
        let difference = |sign: f64| {
            (0..3 * n).map(|i| (modes.shapes[(i, mode)] - sign * back(i)).abs()).fold(0.0, f64::max) / scale
        };
        // Where equal magnitudes share the largest one, the first node decides, and that depends on the numbering.
        let largest: Vec<f64> =
            modes.shapes.col(mode).iter().copied().filter(|u| u.abs() > (1.0 - 1e-6) * scale).collect();
        let tie = largest.iter().any(|u| *u < 0.0);
        let off = if tie { difference(1.0).min(difference(-1.0)) } else { difference(1.0) };
        assert!(off < 1e-8, "mode {mode}: {off:e}");
    }
}
