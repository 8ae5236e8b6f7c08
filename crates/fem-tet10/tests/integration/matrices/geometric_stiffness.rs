//! The reduced geometric stiffness against closed forms, rotated forces, and an assembly written out in plain loops.

use faer::Mat;
use fem_tet10::{AssemblyError, AssemblyFault, Mesh, assemble, reduced_geometric_stiffness, shape_gradients};
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::fixtures::{
    ALUMINIUM, Random, absolute_product, aluminium, assert_close, data_mesh, field, product, workspace_mesh,
};

fn columns(fields: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(fields[0].len(), fields.len(), |i, j| fields[j][i])
}

fn reduced(mesh: &Mesh, displacements: &[Vec<f64>], shapes: &[Vec<f64>]) -> Vec<Mat<f64>> {
    reduced_geometric_stiffness(mesh, &aluminium(), columns(displacements).as_ref(), columns(shapes).as_ref()).unwrap()
}

/// Displacements with no symmetry and no order, of about the size given.
fn random_field(mesh: &Mesh, size: f64, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    (0..3 * mesh.positions().len()).map(|_| size * (2.0 * random.unit() - 1.0)).collect()
}

/// The linear field of a tension of one along x: u = (x, −νy, −νz)/E.
fn tension(mesh: &Mesh) -> Vec<f64> {
    let (e, nu) = (ALUMINIUM.young_modulus, ALUMINIUM.poisson_ratio);
    field(mesh, |[x, y, z]| [x / e, -nu * y / e, -nu * z / e])
}

/// Conserved: no stiffness against translations.
#[test]
fn translations_are_free_to_the_last_bit() {
    let mesh = workspace_mesh("ring.msh");
    let mut shapes: Vec<_> =
        (0..3).map(|axis| field(&mesh, |_| std::array::from_fn(|i| if i == axis { 1.7 } else { 0.0 }))).collect();
    shapes.push(random_field(&mesh, 1.0, 3));
    let k = &reduced(&mesh, &[random_field(&mesh, 1e-3, 4)], &shapes)[0];
    for i in 0..4 {
        for j in 0..4 {
            assert!((k[(i, j)] == 0.0) == (i < 3 || j < 3), "{i} {j}: {:e}", k[(i, j)]);
        }
    }
}

/// Closed form: ∫ σ w'² dV.
#[test]
fn a_bar_under_tension_has_the_energy_of_a_string() {
    // The plate, 1000 × 50 × 10, under a stress of one, whatever way it is displaced.
    let mesh = workspace_mesh("plate.msh");
    let w: [fn(f64) -> f64; 2] = [|x| x, |x| x * x];
    let shapes: Vec<_> = (0..3)
        .flat_map(|axis| w.map(|w| field(&mesh, |[x, ..]| std::array::from_fn(|i| if i == axis { w(x) } else { 0.0 }))))
        .collect();
    let k = &reduced(&mesh, &[tension(&mesh)], &shapes)[0];
    let volume = 1000.0 * 50.0 * 10.0;
    // ∫ 1 dV, and ∫ (2x)² dV about the middle.
    let squares = [volume, volume * 4.0 * 1000.0_f64.powi(2) / 12.0];
    for i in 0..6 {
        // Measured: 2e-15 at worst.
        assert_close("the energy of a shape", k[(i, i)], squares[i % 2], 2e-14);
        for j in (0..6).filter(|j| *j != i) {
            let scale = (squares[i % 2] * squares[j % 2]).sqrt();
            assert!(k[(i, j)].abs() < 2e-14 * scale, "{i} {j}: {:e} of {scale:e}", k[(i, j)]);
        }
    }
}

/// Closed form: ∫ −y² dV.
#[test]
fn bending_stress_is_integrated_exactly_on_straight_elements() {
    // The plate is bent about z, with a stress of −y along x and no other. The shapes w₁ = x and w₂ = x y have
    // slopes 1 and y along x, so together they have ∫ −y · y dV of the stress.
    let mesh = workspace_mesh("plate.msh");
    let (e, nu) = (ALUMINIUM.young_modulus, ALUMINIUM.poisson_ratio);
    let bending = field(&mesh, |[x, y, z]| {
        let z = z - 5.0;
        [-x * y / e, (x * x + nu * (y * y - z * z)) / (2.0 * e), nu * y * z / e]
    });
    let shapes = [field(&mesh, |[x, ..]| [0.0, 0.0, x]), field(&mesh, |[x, y, _]| [0.0, 0.0, x * y])];
    let k = &reduced(&mesh, &[bending], &shapes)[0];
    // Measured: 1.4e-14.
    let exact = -500_000.0 * 50.0 * 50.0 / 12.0;
    assert_close("∫ −y² dV", k[(1, 0)], exact, 2e-13);
}

/// Conserved: K(u) (θ × X) = θ × K u.
#[test]
fn a_rotation_turns_the_forces_in_the_body() {
    // At every node: seen through shapes, the same times Ψᵀ.
    for name in ["plate.msh", "ring.msh"] {
        let mesh = workspace_mesh(name);
        let stiffness = assemble(&mesh, &aluminium(), &[]).unwrap();
        // A smooth field, and one without any order.
        let smooth = field(&mesh, |[x, y, z]| [1e-6 * x * y, 2e-7 * x * x - 1e-6 * z * y, 3e-6 * x * z]);
        for u in [smooth, random_field(&mesh, 1e-3, 11)] {
            let theta = Vector3::new(0.3, -0.8, 0.5);
            let turn = |x: [f64; 3]| -> [f64; 3] { theta.cross(&Vector3::from(x)).into() };
            let shapes =
                [field(&mesh, turn), random_field(&mesh, 1.0, 12), field(&mesh, |[x, y, z]| [y * z, x * x, x * y])];
            let k = &reduced(&mesh, std::slice::from_ref(&u), &shapes)[0];
            let turned =
                |field: &[f64]| -> Vec<f64> { field.chunks_exact(3).flat_map(|f| turn([f[0], f[1], f[2]])).collect() };
            let turned = turned(&product(stiffness.stiffness(), &u));
            let size = absolute_product(stiffness.stiffness(), &u);
            for (i, shape) in shapes.iter().enumerate() {
                let expected: f64 = shape.iter().zip(&turned).map(|(s, f)| s * f).sum();
                let scale: f64 = shape.iter().zip(&size).map(|(s, f)| (s * f).abs()).sum();
                let off = (k[(i, 0)] - expected).abs() / scale;
                // Measured: 3.2e-16 at worst.
                assert!(off < 5e-15, "{name}, shape {i}: {:e} against {expected:e}, off by {off:e}", k[(i, 0)]);
                assert!(expected.abs() > 1e-9 * scale, "{name}, shape {i}: the test can fail");
            }
        }
    }
}

/// K(u) (N×N, dense) in plain loops, element by element. The rule is another one: Gauss–Legendre points in a cube
/// that is collapsed onto the tetrahedron.
fn written_out(mesh: &Mesh, u: &[f64], gauss: &[(f64, f64)]) -> DMatrix<f64> {
    let n = 3 * mesh.positions().len();
    let (e, nu) = (ALUMINIUM.young_modulus, ALUMINIUM.poisson_ratio);
    let mut k = DMatrix::zeros(n, n);
    for nodes in mesh.elements() {
        let nodes = nodes.map(|node| node as usize);
        for (r, wr) in gauss {
            for (s, ws) in gauss {
                for (t, wt) in gauss {
                    let (xi, eta, zeta) = (*r, s * (1.0 - r), t * (1.0 - r) * (1.0 - s));
                    let reference = shape_gradients([xi, eta, zeta]);
                    let mut jacobian = Matrix3::<f64>::zeros();
                    for (a, node) in nodes.iter().enumerate() {
                        for i in 0..3 {
                            for j in 0..3 {
                                jacobian[(i, j)] += mesh.positions()[*node][i] * reference[a][j];
                            }
                        }
                    }
                    let inverse = jacobian.try_inverse().unwrap();
                    let volume = wr * ws * wt * (1.0 - r).powi(2) * (1.0 - s) * jacobian.determinant();
                    let mut gradient = [[0.0_f64; 3]; 10];
                    for a in 0..10 {
                        for i in 0..3 {
                            gradient[a][i] = (0..3).map(|j| reference[a][j] * inverse[(j, i)]).sum();
                        }
                    }
                    let mut slopes = [[0.0_f64; 3]; 3];
                    for a in 0..10 {
                        for i in 0..3 {
                            for j in 0..3 {
                                slopes[i][j] += gradient[a][j] * u[3 * nodes[a] + i];
                            }
                        }
                    }
                    // Hooke's law by E and ν, not by Lamé's constants.
                    let hooke = |slopes: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
                        let trace = slopes[0][0] + slopes[1][1] + slopes[2][2];
                        std::array::from_fn(|i| {
                            std::array::from_fn(|j| {
                                let spherical = if i == j { nu / (1.0 - 2.0 * nu) * trace } else { 0.0 };
                                e / (1.0 + nu) * (0.5 * (slopes[i][j] + slopes[j][i]) + spherical)
                            })
                        })
                    };
                    let stress = hooke(slopes);
                    for a in 0..10 {
                        for b in 0..10 {
                            let mut value = 0.0;
                            for i in 0..3 {
                                for j in 0..3 {
                                    value += volume * stress[i][j] * gradient[a][i] * gradient[b][j];
                                }
                            }
                            for axis in 0..3 {
                                k[(3 * nodes[a] + axis, 3 * nodes[b] + axis)] += value;
                            }
                        }
                    }
                }
            }
        }
    }
    k
}

/// Independent reference: the sum in plain loops, with Hooke's law by E and ν and another rule.
#[test]
fn the_sum_in_plain_loops_is_the_same() {
    // Gauss–Legendre with four points, on (0, 1).
    let (a, b) = ((3.0 / 7.0 - 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt(), (3.0 / 7.0 + 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt());
    let (wa, wb) = ((18.0 + 30.0_f64.sqrt()) / 72.0, (18.0 - 30.0_f64.sqrt()) / 72.0);
    let gauss = [(0.5 - b / 2.0, wb), (0.5 - a / 2.0, wa), (0.5 + a / 2.0, wa), (0.5 + b / 2.0, wb)];
    // Straight: both exact. Curved: the integrand is a quotient, and the two rules differ by their own errors.
    // Measured: 1.8e-15 and 1.7e-6.
    for (name, tolerance) in [("cube.msh", 5e-14), ("quarter.msh", 1e-5)] {
        let mesh = data_mesh(name);
        let fields = [
            field(&mesh, |[x, y, z]| [1e-5 * x * y, 1e-4 * z - 1e-5 * y * y, 2e-5 * x * z]),
            random_field(&mesh, 1e-3, 21),
        ];
        let shapes: Vec<_> = (0..5).map(|k| random_field(&mesh, 1.0, 30 + k)).collect();
        let found = reduced(&mesh, &fields, &shapes);
        for (u, found) in fields.iter().zip(&found) {
            let full = written_out(&mesh, u, &gauss);
            let psi = DMatrix::from_fn(full.nrows(), shapes.len(), |i, j| shapes[j][i]);
            let expected = psi.transpose() * &full * &psi;
            let scale = expected.amax();
            for i in 0..shapes.len() {
                for j in 0..shapes.len() {
                    let off = (found[(i, j)] - expected[(i, j)]).abs() / scale;
                    assert!(off < tolerance, "{name} ({i}, {j}): {:e}, off by {off:e}", found[(i, j)]);
                    assert_eq!(found[(i, j)], found[(j, i)], "{name}");
                }
            }
        }
    }
}

/// Conserved: the same bits on one, two and three threads.
#[test]
fn the_number_of_threads_does_not_change_a_bit_of_it() {
    let mesh = workspace_mesh("ring.msh");
    let displacements = columns(&[random_field(&mesh, 1e-3, 1), random_field(&mesh, 1e-3, 2)]);
    let shapes = columns(&(0..7).map(|k| random_field(&mesh, 1.0, 40 + k)).collect::<Vec<_>>());
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            reduced_geometric_stiffness(&mesh, &aluminium(), displacements.as_ref(), shapes.as_ref()).unwrap()
        })
    };
    let one = with_threads(1);
    assert!(one.iter().all(|k| k.nrows() == 7 && k.ncols() == 7 && k.norm_max() > 0.0));
    for threads in [2, 3] {
        assert_eq!(one, with_threads(threads));
    }
}

#[test]
fn no_shapes_and_no_fields_cost_no_error() {
    let mesh = data_mesh("cube.msh");
    let n = 3 * mesh.positions().len();
    let of = |fields, shapes| {
        reduced_geometric_stiffness(
            &mesh,
            &aluminium(),
            Mat::<f64>::zeros(n, fields).as_ref(),
            Mat::<f64>::zeros(n, shapes).as_ref(),
        )
        .unwrap()
    };
    assert!(of(0, 3).is_empty());
    assert_eq!(of(2, 0).len(), 2);
    assert_eq!(of(2, 3), vec![Mat::<f64>::zeros(3, 3); 2]);
}

#[test]
fn fields_that_do_not_fit_the_mesh_are_refused() {
    let mesh = data_mesh("cube.msh");
    let n = 3 * mesh.positions().len();
    let good = Mat::<f64>::zeros(n, 2);
    let of = |u: &Mat<f64>, shapes: &Mat<f64>| {
        reduced_geometric_stiffness(&mesh, &aluminium(), u.as_ref(), shapes.as_ref()).unwrap_err()
    };
    let error = of(&Mat::zeros(n - 1, 2), &good);
    assert!(
        matches!(error, AssemblyError { fault: AssemblyFault::FieldRows { what: "displacements", .. }, .. }),
        "{error}"
    );
    let error = of(&good, &Mat::zeros(n + 3, 2));
    assert!(error.to_string().contains(&format!("{} rows; expected {n}", n + 3)), "{error}");
    let mut bad = good.clone();
    bad[(4, 1)] = f64::NAN;
    let error = of(&good, &bad);
    assert!(
        matches!(
            error,
            AssemblyError { fault: AssemblyFault::FieldNotFinite { what: "shapes", row: 4, column: 1, .. }, .. }
        ),
        "{error}"
    );
}
