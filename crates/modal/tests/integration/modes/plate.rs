//! The paper's plate with its eight corner masses, mesh size 10.

use std::sync::LazyLock;

use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use fem_tet10::{Material, Materials, Matrices, Mesh, PointMass, assemble};
use modal::Modes;

use crate::bodies::{free_modes, mesh_file};

/// Independent reference: a finite-element code (C3D10) and ARPACK on this mesh, given with the project: four
/// decimals.
const REFERENCE: [f64; 10] =
    [24.5284, 86.1726, 93.2686, 117.3730, 206.1779, 359.9787, 387.9791, 536.7789, 545.4214, 582.0931];
/// Independent reference: Table 1 of the paper, modes 7 to 16; its mesh is not given.
const TABLE_1: [f64; 10] =
    [24.5282, 85.8433, 93.2656, 117.3671, 206.1601, 359.8918, 387.63, 534.3499, 544.946, 579.7381];

struct Plate {
    mesh: Mesh,
    matrices: Matrices,
    modes: Modes,
}

static PLATE: LazyLock<Plate> = LazyLock::new(|| {
    let mesh = mesh_file("plate.msh");
    let material = Material { young_modulus: 70000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    let corner = |i: usize| [[-500.0, 500.0][i & 1], [-25.0, 25.0][(i >> 1) & 1], [0.0, 10.0][i >> 2]];
    let masses: Vec<_> = (0..8).map(|i| PointMass { at: corner(i), mass: 0.001, spread: None }).collect();
    let matrices = assemble(&mesh, &Materials::Uniform(material), &masses).unwrap();
    let modes = free_modes(matrices.stiffness(), matrices.mass(), mesh.positions(), 10).unwrap();
    Plate { mesh, matrices, modes }
});

#[test]
fn frequencies_equal_the_reference_to_its_print_precision() {
    for (found, expected) in PLATE.modes.natural_frequencies().iter().zip(REFERENCE) {
        // Half a unit of the last digit printed is more than 1e-6 of the lowest frequencies.
        let allowed = f64::max(1e-6 * expected, 0.51e-4);
        assert!((found - expected).abs() < allowed, "{found} instead of {expected}");
    }
}

#[test]
fn frequencies_are_near_table_1() {
    let off: Vec<f64> =
        PLATE.modes.natural_frequencies().iter().zip(TABLE_1).map(|(f, paper)| (f / paper - 1.0).abs()).collect();
    assert!(off.iter().all(|o| *o <= 0.0046), "{off:?}");
    // Modes 7, 9, 10 and 11 hardly depend on the mesh.
    assert!([0, 2, 3, 4].iter().all(|i| off[*i] < 1e-4), "{off:?}");
}

/// Closed form: a box and eight point masses.
#[test]
fn mass_and_inertia_are_those_of_the_box_with_point_masses() {
    let rigid = &PLATE.modes.rigid;
    assert!((rigid.mass / 0.00935 - 1.0).abs() < 1e-9);
    let scale = 2117.78125;
    for (i, expected) in [5.4925, 2112.71125, 2117.78125].into_iter().enumerate() {
        assert!((rigid.inertia[(i, i)] / expected - 1.0).abs() < 1e-9);
        assert!((0..3).filter(|j| *j != i).all(|j| rigid.inertia[(i, j)].abs() < 1e-9 * scale));
    }
    let center = rigid.center_of_mass;
    assert!(center.x.abs() < 1e-8 && center.y.abs() < 1e-8 && (center.z - 5.0).abs() < 1e-8, "{center}");
}

/// Conserved: ΨᵀKΨ = 0 of rigid modes, ΨᵀMΨ = 1 of all.
#[test]
fn rigid_modes_have_no_energy_and_all_modes_are_orthonormal() {
    let Plate { matrices, modes, .. } = &*PLATE;
    let k_rigid = matrices.stiffness() * &modes.rigid.shapes;
    let energy = modes.rigid.shapes.transpose() * k_rigid;
    assert!(energy.norm_max() < 1e-8 * modes.eigenvalues[0], "{:e}", energy.norm_max() / modes.eigenvalues[0]);

    let mut all = modes.rigid.shapes.clone();
    all.resize_with(all.nrows(), 16, |i, j| modes.shapes[(i, j - 6)]);
    let gram = all.transpose() * (matrices.mass() * &all);
    let off = (gram - faer::Mat::<f64>::identity(16, 16)).norm_max();
    assert!(off < 1e-12, "{off:e}");
}

/// Conserved: Kφ = λMφ.
#[test]
fn residuals_are_small_and_true() {
    let Plate { matrices, modes, mesh } = &*PLATE;
    assert_eq!(modes.stats.unknowns, 3 * mesh.positions().len());
    assert!(modes.residuals.iter().all(|r| *r < 1e-10), "{:?}", modes.residuals);
    for (k, lambda) in modes.eigenvalues.iter().enumerate() {
        let shape = modes.shapes.col(k);
        let force = matrices.stiffness() * shape;
        let residual = (&force - (matrices.mass() * shape) * faer::Scale(*lambda)).norm_l2() / force.norm_l2();
        assert!(residual < 1e-6 && (residual - modes.force_residuals[k]).abs() < 1e-7, "{residual:e}");
    }
}

/// Conserved: the same body from matrices without stored zeros.
#[test]
fn plain_matrices_give_the_same_reduced_body() {
    let Plate { matrices, modes, mesh } = &*PLATE;
    // Entry by entry, without the zeros that the assembly stores: another pattern, and none of the mesh's types.
    let plain = |matrix: SparseColMatRef<'_, usize, f64>| -> SparseColMat<usize, f64> {
        let entries = matrix.triplet_iter().filter(|entry| *entry.val != 0.0);
        let entries: Vec<_> = entries.map(|entry| Triplet::new(entry.row, entry.col, *entry.val)).collect();
        SparseColMat::try_new_from_triplets(matrix.nrows(), matrix.ncols(), &entries).unwrap()
    };
    let (k, m) = (plain(matrices.stiffness()), plain(matrices.mass()));
    assert!(m.compute_nnz() < matrices.mass().compute_nnz());
    let of_plain = free_modes(k.as_ref(), m.as_ref(), mesh.positions(), 10).unwrap();
    for (found, expected) in of_plain.eigenvalues.iter().zip(&modes.eigenvalues) {
        // 1.3e-9 of the lowest, of which K has cancelled as many digits.
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
    let expected = modes.reduced(matrices.mass(), mesh.positions()).unwrap();
    let found = of_plain.reduced(m.as_ref(), mesh.positions()).unwrap();
    assert_eq!((found.mass, found.inertia), (expected.mass, expected.inertia));
    let pairs = found.inertia_second.iter().zip(&expected.inertia_second);
    let pairs = pairs.chain(found.gyroscopic.iter().zip(&expected.gyroscopic));
    let rotation = found.rotation_products.iter().flatten().zip(expected.rotation_products.iter().flatten());
    for (found, expected) in pairs.chain(rotation) {
        let off = (found - expected).norm_max();
        assert!(off < 1e-8, "{off:e}");
    }
    let scale = expected.inertia.norm().sqrt();
    for (found, expected) in found.inertia_first.iter().flatten().zip(expected.inertia_first.iter().flatten()) {
        assert!((found - expected).abs() < 1e-8 * scale, "{found} {expected}");
    }
}
