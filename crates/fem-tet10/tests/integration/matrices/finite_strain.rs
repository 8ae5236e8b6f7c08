use std::sync::Arc;

use faer::MatRef;
use fem_tet10::{FiniteStrain, Matrices, Mesh, assemble, reduced_geometric_stiffness};
use nalgebra::{Matrix3, Vector3};

use crate::fixtures::{ALUMINIUM, aluminium, data_mesh, workspace_mesh};

/// A mesh of straight elements and one of curved ones.
fn meshes() -> [Mesh; 2] {
    [data_mesh("cube.msh"), workspace_mesh("ring.msh")]
}

fn size(mesh: &Mesh) -> f64 {
    mesh.positions().iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()))
}

/// A field that is not small and not linear in the positions.
fn field(mesh: &Mesh, scale: f64, phase: f64) -> Vec<f64> {
    let size = size(mesh);
    let at = |x: &[f64; 3]| {
        let [x, y, z] = x.map(|x| x / size);
        [(2.0 * y + phase).sin() + 0.3 * x * z, (1.5 * z - phase).cos() * x, 0.5 * x * y + (x + phase).sin()]
    };
    mesh.positions().iter().flat_map(at).map(|u| scale * size * u).collect()
}

fn of_gradient(mesh: &Mesh, gradient: &Matrix3<f64>) -> Vec<f64> {
    mesh.positions().iter().flat_map(|x| <[f64; 3]>::from(gradient * Vector3::from(*x))).collect()
}

fn body(mesh: &Mesh) -> (FiniteStrain, Matrices) {
    let matrices = assemble(mesh, &aluminium(), &[]).unwrap();
    (FiniteStrain::new(Arc::new(mesh.clone()), &aluminium()).unwrap(), matrices)
}

/// A matrix by nodes times a vector.
fn product(matrices: &Matrices, values: &[f64], x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    let (start, nodes) = (matrices.start(), matrices.nodes());
    for column in 0..start.len() - 1 {
        let rows = &nodes[start[column]..start[column + 1]];
        for axis in 0..3 {
            for (place, row) in rows.iter().enumerate() {
                for i in 0..3 {
                    let value = values[9 * start[column] + 3 * (axis * rows.len() + place) + i];
                    y[3 * *row as usize + i] += value * x[3 * column + axis];
                }
            }
        }
    }
    y
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn plus(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let difference = plus(a, -1.0, b);
    dot(&difference, &difference).sqrt() / dot(b, b).sqrt()
}

/// Conserved: the stiffness at rest, by another function.
#[test]
fn the_stiffness_at_rest_is_that_of_the_matrices() {
    for mesh in meshes() {
        let (body, matrices) = body(&mesh);
        let rest = vec![0.0; 3 * mesh.positions().len()];
        let found = body.stiffness(&rest, &body.stresses(&rest), &matrices);
        assert!(distance(&found, matrices.stiffness_by_nodes()) < 1e-13);
    }
}

/// Closed form: of a uniform F, W = V (½ λ tr²E + μ E:E).
#[test]
fn a_uniform_deformation_has_its_energy_and_a_rotation_has_none() {
    let [mesh, _] = meshes();
    let (body, _) = body(&mesh);
    let f = Matrix3::new(1.2, 0.1, -0.05, 0.02, 0.9, 0.3, -0.1, 0.05, 1.1);
    let e: Matrix3<f64> = 0.5 * (f.transpose() * f - Matrix3::identity());
    let (lambda, mu) = ALUMINIUM.lame();
    let expected = volume(&mesh) * (0.5 * lambda * e.trace().powi(2) + mu * e.dot(&e));
    let unit = body.strain_energy(&of_gradient(&mesh, &(f - Matrix3::identity())));
    assert!((unit / expected - 1.0).abs() < 1e-12, "{unit} {expected}");

    let turn = nalgebra::Rotation3::new(Vector3::new(0.4, -1.1, 0.7)).into_inner() - Matrix3::identity();
    let turned = of_gradient(&mesh, &turn);
    assert!(body.strain_energy(&turned) < 1e-20 * unit);
    let scale = body.internal_forces(&of_gradient(&mesh, &(f - Matrix3::identity())));
    let forces = body.internal_forces(&turned);
    assert!(dot(&forces, &forces) < 1e-24 * dot(&scale, &scale));
}

/// Volume of the cube by its bounding box.
fn volume(mesh: &Mesh) -> f64 {
    (0..3)
        .map(|axis| {
            let along = mesh.positions().iter().map(|x| x[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        })
        .product()
}

/// Conserved: central differences are exact for polynomials of degree 2 in the step but for the fourth degree of the
/// energy, which is of third order in it.
#[test]
fn forces_are_the_slope_of_the_energy_and_the_stiffness_that_of_the_forces() {
    for mesh in meshes() {
        let (body, matrices) = body(&mesh);
        let (u, e) = (field(&mesh, 0.2, 0.3), field(&mesh, 0.2, 1.7));
        let h = 1e-3;
        let (after, before) = (plus(&u, h, &e), plus(&u, -h, &e));
        let forces = body.internal_forces(&u);
        let slope = (body.strain_energy(&after) - body.strain_energy(&before)) / (2.0 * h);
        assert!((dot(&forces, &e) / slope - 1.0).abs() < 1e-5);

        let slope: Vec<f64> = plus(&body.internal_forces(&after), -1.0, &body.internal_forces(&before));
        let slope: Vec<f64> = slope.iter().map(|f| f / (2.0 * h)).collect();
        let stiffness = body.stiffness(&u, &body.stresses(&u), &matrices);
        let found = product(&matrices, &stiffness, &e);
        assert!(distance(&found, &slope) < 1e-5, "{}", distance(&found, &slope));
        let other = field(&mesh, 0.2, 2.9);
        let symmetric = dot(&found, &other) / dot(&product(&matrices, &stiffness, &other), &e);
        assert!((symmetric - 1.0).abs() < 1e-11);
    }
}

/// Conserved: for S linear in e, the forces of S + B(u)e are those of S and `∫ BᵀCB e`.
#[test]
fn the_linearized_stress_is_the_slope_of_the_stress() {
    let [mesh, _] = meshes();
    let (body, matrices) = body(&mesh);
    let (u, e) = (field(&mesh, 0.2, 0.3), field(&mesh, 0.1, 1.7));
    let forces = body.forces(&u, &body.linearized_stresses(&u, &e));
    let rest = vec![0.0; u.len()];
    // Without a stress, K(u, 0) is ∫ BᵀCB alone.
    let elastic = body.stiffness(&u, &body.stresses(&rest), &matrices);
    let expected = plus(&body.internal_forces(&u), 1.0, &product(&matrices, &elastic, &e));
    assert!(distance(&forces, &expected) < 1e-12);
    // At rest the stress of a small displacement is the linear one.
    let linear = body.forces(&rest, &body.linear_stresses(&e));
    assert!(distance(&linear, &product(&matrices, matrices.stiffness_by_nodes(), &e)) < 1e-12);
}

/// Conserved: the stiffness by the initial stress, by another function.
#[test]
fn the_stiffness_of_a_stress_is_the_reduced_geometric_one() {
    for mesh in meshes() {
        let (body, matrices) = body(&mesh);
        let (u, v) = (field(&mesh, 0.2, 0.3), field(&mesh, 0.1, 1.7));
        let rest = vec![0.0; u.len()];
        let stressed = body.stiffness(&rest, &body.linear_stresses(&u), &matrices);
        let found = dot(&v, &product(&matrices, &stressed, &v))
            - dot(&v, &product(&matrices, matrices.stiffness_by_nodes(), &v));
        let column = |v: &'static [f64]| MatRef::from_column_major_slice(v, v.len(), 1);
        let (of_u, of_v) = (column(u.leak()), column(v.leak()));
        let reduced = reduced_geometric_stiffness(&mesh, &aluminium(), of_u, of_v);
        assert!((found / reduced.unwrap()[0][(0, 0)] - 1.0).abs() < 1e-9);
    }
}
