//! Forces and energies of displacements that are polynomials of coordinates.

use faer::Mat;
use fem_tet10::Expansion;
use nalgebra::{Matrix3, Vector3};

use crate::fixtures::{ALUMINIUM, PLATE_MASS, aluminium, assert_close, field, workspace_mesh};

const GRADIENTS: [[f64; 9]; 4] = [
    [0.2, 0.4, 0.0, -0.2, 0.1, 0.6, 0.14, 0.0, -0.4],
    [0.0, 0.2, 0.08, 0.12, -0.2, 0.0, 0.4, 0.2, 0.06],
    [0.1, 0.0, -0.2, 0.4, 0.0, 0.2, 0.0, -0.6, 0.2],
    [0.05, 0.1, 0.2, 0.0, 0.3, -0.1, 0.2, 0.1, 0.0],
];
const REFERENCE: [f64; 9] = [0.05, 0.3, -0.1, -0.25, 0.02, 0.1, 0.08, -0.12, 0.04];

/// All products of two coordinates with `least` to `most` factors.
fn products(least: usize, most: usize) -> Vec<Vec<usize>> {
    (least..=most).flat_map(|n| (0..=n).map(move |ones| [vec![0; n - ones], vec![1; ones]].concat())).collect()
}

fn value(product: &[usize], q: [f64; 2]) -> f64 {
    product.iter().map(|k| q[*k]).product()
}

/// Closed form: fields u = A x have one gradient everywhere, and energy and forces are those of the whole strain, of which
/// the polynomial has all terms.
#[test]
fn of_homogeneous_fields_they_are_those_of_the_whole_strain() {
    let mesh = workspace_mesh("plate.msh");
    let volume = PLATE_MASS / ALUMINIUM.density;
    let (lambda, mu) = ALUMINIUM.lame();
    let gradients = GRADIENTS.map(|g| Matrix3::from_row_slice(&g));
    let of_products = [vec![0], vec![1], vec![0, 0], vec![0, 1]];
    let linear = |g: &Matrix3<f64>| field(&mesh, |x| (g * Vector3::from(x)).into());
    let columns: Vec<_> = gradients.iter().map(linear).collect();
    let fields = Mat::from_fn(columns[0].len(), 4, |i, j| columns[j][i]);
    let stress = |e: &Matrix3<f64>| lambda * e.trace() * Matrix3::identity() + 2.0 * mu * e;
    let strain = |f: &Matrix3<f64>| 0.5 * (f.transpose() * f - Matrix3::identity());
    let v = Matrix3::new(0.3, -0.1, 0.2, 0.5, 0.1, -0.4, 0.2, 0.6, 0.3);
    let of_v = linear(&v);
    for bent in [false, true] {
        let g0 = if bent { Matrix3::from_row_slice(&REFERENCE) } else { Matrix3::zeros() };
        let of_reference = linear(&g0);
        let reference = Mat::from_fn(of_reference.len(), 1, |i, _| of_reference[i]);
        let expansion =
            Expansion { products: &of_products, fields: fields.as_ref(), reference: bent.then(|| reference.as_ref()) };
        let f0 = Matrix3::identity() + g0;
        let s0 = stress(&strain(&f0));
        let all = products(2, 8);
        let energies = expansion.energies(&mesh, &aluminium(), &all).unwrap();
        let wanted = products(1, 6);
        let forces = expansion.forces(&mesh, &aluminium(), &wanted).unwrap();
        for q in [[0.7, -0.4], [-0.3, 0.9]] {
            let mut f = f0;
            of_products.iter().zip(&gradients).for_each(|(product, g)| f += g * value(product, q));
            let e = strain(&f);
            let whole = volume * 0.5 * e.dot(&stress(&e));
            let at_reference = volume * 0.5 * strain(&f0).dot(&s0);
            let work: f64 = volume * (f - f0).dot(&(f0 * s0));
            let found: f64 = all.iter().zip(&energies).map(|(product, energy)| energy * value(product, q)).sum();
            assert_close("energy", found + at_reference + work, whole, 1e-11);

            let tangent = |g: &Matrix3<f64>| {
                let e = f0.transpose() * g;
                f0 * stress(&(0.5 * (e + e.transpose()))) + g * s0
            };
            let mut expected = f * stress(&e) - f0 * s0;
            of_products.iter().zip(&gradients).for_each(|(product, g)| expected -= tangent(g) * value(product, q));
            let power = |column: usize| of_v.iter().enumerate().map(|(i, v)| v * forces[(i, column)]).sum::<f64>();
            let found: f64 = wanted.iter().enumerate().map(|(k, product)| power(k) * value(product, q)).sum();
            assert_close("work of the forces", found, volume * v.dot(&expected), 1e-10);
        }
    }
}
