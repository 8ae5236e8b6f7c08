//! Forces and energies of second order against rotated forces and closed forms.

use faer::Mat;
use fem_tet10::{
    Material, Materials, Mesh, assemble, quadrature, reduced_geometric_stiffness, second_order_energies,
    second_order_forces, shape_gradients,
};
use nalgebra::{Matrix3, Vector3};

use crate::fixtures::{
    ALUMINIUM, PLATE_MASS, absolute_product, aluminium, assert_close, data_mesh, field, product, workspace_mesh,
};

fn columns(fields: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(fields[0].len(), fields.len(), |i, j| fields[j][i])
}

fn forces(mesh: &Mesh, fields: &[Vec<f64>], pairs: &[[usize; 2]]) -> Vec<Vec<f64>> {
    let forces = second_order_forces(mesh, &aluminium(), columns(fields).as_ref(), pairs).unwrap();
    forces.col_iter().map(|column| column.iter().copied().collect()).collect()
}

fn smooth(mesh: &Mesh) -> Vec<f64> {
    field(mesh, |[x, y, z]| [1e-5 * x * y, 1e-4 * z - 1e-5 * y * y, 2e-5 * x * z])
}

fn turned(w: &Vector3<f64>, u: &[f64]) -> Vec<f64> {
    u.chunks_exact(3).flat_map(|u| <[f64; 3]>::from(w.cross(&Vector3::new(u[0], u[1], u[2])))).collect()
}

/// Conserved: a body that is turned, its displacement too, meets turned forces: to first order in the turn θ this is
/// `K (θ × u) + g(θ × X, u) = θ × K u`, to second order in θ alone `g(θ × X, θ × X) = −K (θ × (θ × X))`.
#[test]
fn a_turned_body_meets_turned_forces() {
    let w = Vector3::new(0.3, -0.7, 0.5);
    for name in ["plate.msh", "ring.msh"] {
        let mesh = workspace_mesh(name);
        let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
        let k = matrices.stiffness();
        let turn = field(&mesh, |x| w.cross(&Vector3::from(x)).into());
        let u = smooth(&mesh);
        let found = forces(&mesh, &[turn.clone(), u.clone()], &[[0, 1], [0, 0]]);
        let of_u: Vec<f64> =
            turned(&w, &product(k, &u)).iter().zip(product(k, &turned(&w, &u))).map(|(a, b)| a - b).collect();
        let of_turn: Vec<f64> = product(k, &turned(&w, &turn)).iter().map(|f| -f).collect();
        for (found, expected, scale) in [
            (&found[0], &of_u, absolute_product(k, &u)),
            (&found[1], &of_turn, absolute_product(k, &turned(&w, &turn))),
        ] {
            let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let off: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
            assert!(largest(&off) < 1e-13 * largest(&scale), "{name}: {:e} of {:e}", largest(&off), largest(&scale));
            assert!(largest(expected) > 1e-5 * largest(&scale), "{name}: the test can fail");
        }
    }
}

/// Closed form: fields u = A x have one gradient everywhere.
#[test]
fn of_homogeneous_fields_they_are_what_the_formulas_say() {
    let mesh = workspace_mesh("plate.msh");
    let volume = PLATE_MASS / ALUMINIUM.density;
    let gradients = [
        Matrix3::new(1e-3, 2e-3, 0.0, -1e-3, 5e-4, 3e-3, 7e-4, 0.0, -2e-3),
        Matrix3::new(0.0, 1e-3, 4e-4, 6e-4, -1e-3, 0.0, 2e-3, 1e-3, 3e-4),
        Matrix3::new(5e-4, 0.0, -1e-3, 2e-3, 0.0, 1e-3, 0.0, -3e-3, 1e-3),
    ];
    let fields: Vec<_> = gradients.iter().map(|g| field(&mesh, |x| (g * Vector3::from(x)).into())).collect();
    let symmetric = |g: Matrix3<f64>| 0.5 * (g + g.transpose());
    let (lambda, mu) = ALUMINIUM.lame();
    let product_of = |a: Matrix3<f64>, b: Matrix3<f64>| lambda * a.trace() * b.trace() + 2.0 * mu * a.dot(&b);
    let first = |a: usize| symmetric(gradients[a]);
    let second = |a: usize, b: usize| symmetric(gradients[a].transpose() * gradients[b]);
    let g = forces(&mesh, &fields, &[[0, 1], [1, 2], [2, 0]]);
    let work = |u: &[f64], f: &[f64]| u.iter().zip(f).map(|(u, f)| u * f).sum::<f64>();
    let expected = volume
        * (product_of(first(2), second(0, 1))
            + product_of(first(0), second(2, 1))
            + product_of(first(1), second(2, 0)));
    for (u, f) in [(2, 0), (0, 1), (1, 2)] {
        assert_close("u·g", work(&fields[u], &g[f]), expected, 1e-11);
    }
    let energies = second_order_energies(&mesh, &aluminium(), columns(&fields).as_ref(), &[[0, 1, 2, 2], [0, 0, 0, 0]]);
    let energies = energies.unwrap();
    assert_close("ε₂:C:ε₂", energies[0], volume * product_of(second(0, 1), second(2, 2)), 1e-11);
    assert_close("ε₂:C:ε₂", energies[1], volume * product_of(second(0, 0), second(0, 0)), 1e-11);
}

/// `∫ ε₂(a,b) : C : ε₂(c,d) dV` in plain loops, element by element, by the rule of degree 5.
fn energy_written_out(mesh: &Mesh, [a, b, c, d]: [&[f64]; 4]) -> f64 {
    let (lambda, mu) = ALUMINIUM.lame();
    let mut energy = 0.0;
    for nodes in mesh.elements() {
        for point in quadrature::degree_5() {
            let reference = shape_gradients(point.at);
            let sum = |of_node: &dyn Fn(usize) -> Vector3<f64>| -> Matrix3<f64> {
                (0..10).map(|k| of_node(nodes[k] as usize) * Vector3::from(reference[k]).transpose()).sum()
            };
            let jacobian = sum(&|node| Vector3::from(mesh.positions()[node]));
            let inverse = jacobian.try_inverse().unwrap();
            let slopes = |u: &[f64]| sum(&|node| Vector3::new(u[3 * node], u[3 * node + 1], u[3 * node + 2])) * inverse;
            let strain = |a: &[f64], b: &[f64]| {
                let product = slopes(a).transpose() * slopes(b);
                0.5 * (product + product.transpose())
            };
            let (first, second) = (strain(a, b), strain(c, d));
            let product = lambda * first.trace() * second.trace() + 2.0 * mu * first.dot(&second);
            energy += point.weight * jacobian.determinant() * product;
        }
    }
    energy
}

/// Independent reference: the sums in plain loops.
#[test]
fn energies_are_the_sums_in_plain_loops() {
    // The quarter of a cylinder has curved elements at its surface.
    for name in ["cube.msh", "quarter.msh"] {
        let mesh = data_mesh(name);
        let fields = [
            smooth(&mesh),
            field(&mesh, |[x, y, z]| [1e-3 * y * z, -1e-3 * x * x, 2e-3 * x * y]),
            field(&mesh, |[x, y, z]| [(1e-2 * x).sin(), 1e-3 * z * z, (2e-2 * y).cos()]),
        ];
        let quadruples = [[0, 1, 2, 2], [2, 1, 0, 0], [1, 1, 1, 1], [2, 0, 1, 2], [0, 2, 2, 1]];
        let found = second_order_energies(&mesh, &aluminium(), columns(&fields).as_ref(), &quadruples).unwrap();
        for (quadruple, found) in quadruples.iter().zip(&found) {
            let expected = energy_written_out(&mesh, quadruple.map(|k| &fields[k][..]));
            assert_close("ε₂:C:ε₂", *found, expected, 1e-12);
        }
    }
}

/// Conserved: all are sums over the elements, each with its own material.
#[test]
fn each_element_has_its_own_material() {
    let mesh = data_mesh("two_materials.msh");
    let fields = columns(&[smooth(&mesh), field(&mesh, |[x, y, z]| [y * z, x * x, x * y])]);
    let found = |factors: [f64; 2]| -> Vec<f64> {
        let scaled = |factor: f64| Material { young_modulus: factor * ALUMINIUM.young_modulus, ..ALUMINIUM };
        let by_group = mesh.groups().iter().cloned().zip(factors.map(scaled)).collect();
        let materials = Materials::ByGroup(by_group);
        let u = fields.subcols(0, 1);
        let k = reduced_geometric_stiffness(&mesh, &materials, u, fields.as_ref()).unwrap();
        let forces = second_order_forces(&mesh, &materials, fields.as_ref(), &[[0, 1]]).unwrap();
        let energies = second_order_energies(&mesh, &materials, fields.as_ref(), &[[0, 0, 1, 1]]).unwrap();
        vec![k[0][(0, 1)], (fields.col(0).transpose() * forces.col(0)), energies[0]]
    };
    let (one, other, both) = (found([2.0, 1.0]), found([1.0, 2.0]), found([1.0, 1.0]));
    for ((one, other), both) in one.iter().zip(&other).zip(&both) {
        assert_close("the sum of both", one + other, 3.0 * both, 1e-12);
        assert!((one - 1.5 * both).abs() > 1e-3 * both.abs(), "the test can fail");
    }
}
