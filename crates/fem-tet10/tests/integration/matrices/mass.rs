//! The mass matrix against closed forms of the box.

use fem_tet10::{assemble, centroid_lumped_inertia};
use nalgebra::{DMatrix, Matrix3, SymmetricEigen};

use crate::fixtures::{
    PLATE_MASS, Random, aluminium, assert_close, corner_masses, data_mesh, entries, field, form, moments,
    workspace_mesh,
};

/// Closed form: the mass of the box and of its corner masses.
#[test]
fn the_plate_weighs_what_its_parts_weigh() {
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &corner_masses()).unwrap();
    let ones = vec![1.0; 3 * mesh.positions().len()];
    // Measured: 2.2e-16.
    assert_close("total mass", form(&ones, matrices.mass(), &ones) / 3.0, PLATE_MASS + 0.008, 1e-13);
}

/// Closed form: moments of a box and of eight point masses.
#[test]
fn moments_of_the_plate_are_those_of_the_box_and_its_corners() {
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &corner_masses()).unwrap();
    let sides = [1000.0, 50.0, 10.0];
    // Measured: 2e-16 at worst.
    for axis in 0..3 {
        let found = moments(&mesh, matrices.mass(), axis);
        let total = PLATE_MASS + 0.008;
        assert_close("mass", found.zeroth, total, 1e-13);
        for j in 0..3 {
            let center = [0.0, 0.0, 5.0][j];
            let off = (found.first[j] - total * center).abs() / (total * sides[j]);
            assert!(off < 1e-13, "first moment {j} off by {off:e} of mass × side");
            for k in 0..3 {
                let central = if j == k { sides[j] * sides[j] * (PLATE_MASS / 12.0 + 0.008 / 4.0) } else { 0.0 };
                let exact = central + total * center * [0.0, 0.0, 5.0][k];
                let off = (found.second[j][k] - exact).abs() / (total * sides[j] * sides[k]);
                assert!(off < 1e-13, "second moment {j}{k} off by {off:e} of mass × sides");
            }
        }
    }
}

/// Closed form: moments of inertia of a box and of eight point masses.
#[test]
fn principal_inertia_of_the_plate() {
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &corner_masses()).unwrap();
    let m = moments(&mesh, matrices.mass(), 0);
    let center = m.first.map(|s| s / m.zeroth);
    let second = Matrix3::from_fn(|j, k| m.second[j][k] - m.zeroth * center[j] * center[k]);
    let inertia = Matrix3::identity() * second.trace() - second;
    let mut principal: Vec<f64> = SymmetricEigen::new(inertia).eigenvalues.iter().copied().collect();
    principal.sort_by(f64::total_cmp);
    assert_close("mass", m.zeroth, 0.00935, 1e-12);
    // Measured: 3.0e-14 at worst.
    for (found, exact) in principal.iter().zip([5.4925, 2112.71125, 2117.78125]) {
        assert_close("principal moment", *found, exact, 1e-12);
    }
}

/// Independent reference: figures given with the project for this mesh; the paper prints 5.4839, 2112.7024 and
/// 2117.7732 for its own.
#[test]
fn mass_lumped_at_centroids_gives_what_the_paper_prints() {
    let mesh = workspace_mesh("plate.msh");
    let lumped = centroid_lumped_inertia(&mesh, &aluminium(), &corner_masses()).unwrap();
    assert_close("mass", lumped.mass, 0.00935, 1e-12);
    for (found, known) in lumped.principal_moments.iter().zip([5.48373, 2112.70238, 2117.77332]) {
        // Measured: 1.7e-7 at worst, the digits that the reference has.
        assert_close("principal moment", *found, known, 1e-6);
    }
}

/// Closed form: integrals of polynomials over the box.
#[test]
fn quadratic_fields_have_their_exact_kinetic_energy() {
    // u = (x², x y, y z + x) with z from the middle; over the box E[x²] = L²/12, E[x⁴] = L⁴/80.
    let mesh = workspace_mesh("plate.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let u = field(&mesh, |[x, y, z]| {
        let z = z - 5.0;
        [x * x, x * y, y * z + x]
    });
    let [x2, y2, z2] = [1000.0_f64, 50.0, 10.0].map(|l| l * l / 12.0);
    let x4 = 1000.0_f64.powi(4) / 80.0;
    // (y z + x)² = y² z² + 2 x y z + x², and the middle term is odd.
    let exact = PLATE_MASS * (x4 + x2 * y2 + y2 * z2 + x2);
    // Measured: 6.7e-16, both.
    assert_close("uᵀMu", form(&u, matrices.mass(), &u), exact, 1e-13);
    // The small parts apart, so that x⁴ does not hide them.
    let v = field(&mesh, |[_, y, z]| [y * (z - 5.0), y * y, (z - 5.0) * (z - 5.0)]);
    let exact = PLATE_MASS * (y2 * z2 + 50.0_f64.powi(4) / 80.0 + 10.0_f64.powi(4) / 80.0);
    assert_close("vᵀMv", form(&v, matrices.mass(), &v), exact, 1e-13);
}

/// Conserved: M is one scalar matrix along each axis.
#[test]
fn mass_is_the_same_along_each_axis_and_couples_none() {
    let mesh = data_mesh("two_materials.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let n = mesh.positions().len();
    let mut scalar = DMatrix::zeros(n, n);
    for (i, j, value) in entries(matrices.mass()).filter(|(i, j, _)| i % 3 == 0 && j % 3 == 0) {
        scalar[(i / 3, j / 3)] = value;
    }
    for (i, j, value) in entries(matrices.mass()) {
        assert_eq!(value, if i % 3 == j % 3 { scalar[(i / 3, j / 3)] } else { 0.0 });
    }
    let eigenvalues = scalar.symmetric_eigenvalues();
    let (least, greatest) = (eigenvalues.min(), eigenvalues.max());
    assert!(least > 1e-3 * greatest, "M must be positive definite: {least:e} to {greatest:e}");
}

/// Conserved: energies are positive.
#[test]
fn kinetic_energy_of_random_motions_is_positive() {
    let mesh = workspace_mesh("ring.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let mut random = Random(3);
    for _ in 0..20 {
        let v: Vec<f64> = (0..3 * mesh.positions().len()).map(|_| random.unit() - 0.5).collect();
        assert!(form(&v, matrices.mass(), &v) > 0.0);
        assert!(form(&v, matrices.stiffness(), &v) > 0.0);
    }
}
