//! The stiffness matrix against rigid motions, patch tests and closed forms, and the pattern that it shares with M.

use fem_tet10::assemble;
use nalgebra::{DMatrix, Matrix3};

use crate::fixtures::{
    ALUMINIUM, absolute_product, aluminium, assert_close, data_mesh, entries, field, form, product, workspace_mesh,
    worst_rigid_force,
};

/// ½ ε : D : ε, energy per volume.
fn energy_density(strain: Matrix3<f64>) -> f64 {
    let (lambda, mu) = ALUMINIUM.lame();
    0.5 * lambda * strain.trace().powi(2) + mu * strain.norm_squared()
}

/// Conserved: K r = 0 of rigid motions.
#[test]
fn rigid_motions_cause_no_forces() {
    for name in ["plate.msh", "ring.msh"] {
        let mesh = workspace_mesh(name);
        let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
        let worst = worst_rigid_force(&mesh, matrices.stiffness());
        // Measured: 1.7e-16 at worst.
        assert!(worst < 5e-15, "{name}: |K r| is {worst:e} of |K||r|");
    }
}

/// Conserved: symmetry, to the bit.
#[test]
fn both_matrices_are_symmetric_to_the_last_bit() {
    let mesh = workspace_mesh("ring.msh");
    let spread = fem_tet10::PointMass { at: [-90.0, 0.0, 10.0], mass: 1e-4, spread: Some(20.0) };
    let matrices = assemble(&mesh, &aluminium(), &[spread]).unwrap();
    for matrix in [matrices.stiffness(), matrices.mass()] {
        let by_place: std::collections::HashMap<(usize, usize), f64> =
            entries(matrix).map(|(i, j, value)| ((i, j), value)).collect();
        assert!(by_place.iter().all(|((i, j), value)| by_place[&(*j, *i)] == *value));
    }
}

#[test]
fn both_matrices_share_one_sorted_pattern() {
    let mesh = workspace_mesh("ring.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let (k, m) = (matrices.stiffness().symbolic(), matrices.mass().symbolic());
    assert_eq!(k.row_idx().as_ptr(), m.row_idx().as_ptr());
    assert_eq!(k.col_ptr().as_ptr(), m.col_ptr().as_ptr());
    for column in k.col_ptr().windows(2) {
        assert!(k.row_idx()[column[0]..column[1]].is_sorted_by(|a, b| a < b));
    }
    // Exactly the pairs of nodes with an element in common, in blocks of 3×3.
    let mut pairs = std::collections::HashSet::new();
    for nodes in mesh.elements() {
        for a in nodes {
            pairs.extend(nodes.iter().map(|b| (*a, *b)));
        }
    }
    assert_eq!(k.row_idx().len(), 9 * pairs.len());
    assert_eq!(matrices.bytes(), 84 * pairs.len() + 8 * (mesh.positions().len() + 1));
}

/// Closed form: ½ ε : D : ε V, and no force inside.
#[test]
fn a_linear_displacement_has_the_energy_of_its_strain() {
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let gradient = Matrix3::new(1.1, 0.4, -0.3, 0.2, -0.7, 0.5, 0.6, -0.9, 0.8) * 1e-3;
    let u = field(&mesh, |x| (gradient * nalgebra::Vector3::from(x)).into());
    let exact = energy_density(0.5 * (gradient + gradient.transpose())) * 500_000.0;
    // Measured: 2.2e-14.
    assert_close("½uᵀKu", 0.5 * form(&u, matrices.stiffness(), &u), exact, 1e-12);

    // Constant stress is in equilibrium at every node that is not on the surface.
    let forces = product(matrices.stiffness(), &u);
    let scale = absolute_product(matrices.stiffness(), &u).into_iter().fold(0.0, f64::max);
    let inner: Vec<usize> = (0..mesh.positions().len())
        .filter(|n| {
            let [x, y, z] = mesh.positions()[*n];
            x.abs() < 499.9 && y.abs() < 24.9 && z > 0.1 && z < 9.9
        })
        .collect();
    assert!(inner.len() > 1000, "{} nodes inside", inner.len());
    let worst = inner.iter().flat_map(|n| &forces[3 * n..3 * n + 3]).fold(0.0, |m: f64, f| m.max(f.abs())) / scale;
    // Measured: 9.3e-17.
    assert!(worst < 5e-15, "forces inside are {worst:e} of |K||u|");
    // On the surface they are not zero: the test can fail.
    let outside = forces.iter().fold(0.0, |m: f64, f| m.max(f.abs())) / scale;
    assert!(outside > 1e10 * worst, "forces on the surface are {outside:e} of |K||u|");
}

/// Closed form: Σ e(A_k) V L_k²/12.
#[test]
fn quadratic_displacements_have_the_energy_of_their_strain() {
    // u = x_j x_k e_i (and sums): strain is ε = Σ A_k x_k with x from the middle, so the energy is Σ e(A_k) V L_k²/12.
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let coefficients: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.5, -2.0], [0.5, 30.0, 4.0], [-2.0, 4.0, 200.0]],
        [[-0.7, 2.0, 1.5], [2.0, 10.0, -6.0], [1.5, -6.0, 90.0]],
        [[0.3, -1.0, 3.0], [-1.0, -20.0, 8.0], [3.0, 8.0, -150.0]],
    ];
    let u = field(&mesh, |[x, y, z]| {
        let x = [x, y, z - 5.0];
        coefficients.map(|c| (0..3).flat_map(|j| (0..3).map(move |k| (j, k))).map(|(j, k)| c[j][k] * x[j] * x[k]).sum())
    });
    let exact: f64 = (0..3)
        .map(|k| {
            // ∂u_i/∂x_j = 2 Σ_k c_ijk x_k, as c is symmetric in jk.
            let gradient = Matrix3::from_fn(|i, j| 2.0 * coefficients[i][j][k]);
            let side: f64 = [1000.0, 50.0, 10.0][k];
            energy_density(0.5 * (gradient + gradient.transpose())) * 500_000.0 * side * side / 12.0
        })
        .sum();
    // Measured: 2.2e-16.
    assert_close("½uᵀKu", 0.5 * form(&u, matrices.stiffness(), &u), exact, 1e-13);
}

/// Conserved: six zero eigenvalues, and no negative one.
#[test]
fn a_free_body_has_six_motions_without_energy_and_no_negative_one() {
    for name in ["cube.msh", "quarter.msh"] {
        let mesh = data_mesh(name);
        let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
        let n = 3 * mesh.positions().len();
        let mut dense = DMatrix::zeros(n, n);
        for (i, j, value) in entries(matrices.stiffness()) {
            dense[(i, j)] = value;
        }
        let mut eigenvalues: Vec<f64> = dense.symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        let greatest = eigenvalues[n - 1];
        assert!(eigenvalues[0] > -1e-14 * greatest, "{name}: {:e} of {greatest:e}", eigenvalues[0]);
        assert!(eigenvalues[5] < 1e-14 * greatest, "{name}: {:e} of {greatest:e}", eigenvalues[5]);
        assert!(eigenvalues[6] > 1e-6 * greatest, "{name}: {:e} of {greatest:e}", eigenvalues[6]);
    }
}

/// Conserved: the same bits on one, two and three threads.
#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let mesh = workspace_mesh("ring.msh");
    let spread = fem_tet10::PointMass { at: [-90.0, 0.0, 10.0], mass: 1e-4, spread: Some(20.0) };
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| assemble(&mesh, &aluminium(), &[spread]).unwrap())
    };
    let one = with_threads(1);
    for threads in [2, 3] {
        let more = with_threads(threads);
        assert_eq!(one.stiffness().symbolic().row_idx(), more.stiffness().symbolic().row_idx());
        assert_eq!(one.stiffness().val(), more.stiffness().val());
        assert_eq!(one.mass().val(), more.mass().val());
    }
}
