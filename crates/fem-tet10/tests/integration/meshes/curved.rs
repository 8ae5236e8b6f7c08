//! Curved elements: a ball made in code, and the ring that gmsh made.

use std::collections::HashMap;

use fem_tet10::{Material, Materials, Mesh, assemble, shape_functions, shape_gradients};
use nalgebra::Vector3;

use crate::ball::ball;
use crate::fixtures::{ALUMINIUM, aluminium, assert_close, form, moments, workspace_mesh, worst_rigid_force};

fn unit_density() -> Materials {
    Materials::Uniform(Material { density: 1.0, ..ALUMINIUM })
}

/// Conserved: order 4, against 4π/3 and 4π/15.
#[test]
fn the_ball_is_approached_with_fourth_order() {
    let (mut volumes, mut inertias) = (Vec::new(), Vec::new());
    for refinements in 0..4 {
        let mesh = ball(refinements);
        let matrices = assemble(&mesh, &unit_density(), &[]).unwrap();
        let m = moments(&mesh, matrices.mass(), 1);
        volumes.push((m.zeroth / (4.0 * std::f64::consts::PI / 3.0) - 1.0).abs());
        inertias.push((m.second[2][2] / (4.0 * std::f64::consts::PI / 15.0) - 1.0).abs());
    }
    for (what, errors) in [("volume", volumes), ("second moment", inertias)] {
        let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
        // Measured: 3.5, 3.4, 3.9 and 8.4e-5 for the volume, 3.4, 3.4, 3.9 and 1.4e-4 for the second moment.
        assert!(
            orders.iter().sum::<f64>() / 3.0 > 3.5 && orders[2] > 3.8,
            "{what}: errors {errors:?}, orders {orders:.2?}"
        );
        assert!(errors[3] < 2e-4, "{what}: errors {errors:?}, orders {orders:.2?}");
    }
}

/// Conserved: K r = 0 of rigid motions.
#[test]
fn rigid_motions_of_the_ball_cause_no_forces() {
    let mesh = ball(2);
    let matrices = assemble(&mesh, &unit_density(), &[]).unwrap();
    let worst = worst_rigid_force(&mesh, matrices.stiffness());
    // Measured: 1.4e-16.
    assert!(worst < 5e-15, "|K r| is {worst:e} of |K||r|");
}

/// ⅓ ∮ x·n dA over the faces that belong to one element only.
fn volume_by_divergence(mesh: &Mesh) -> f64 {
    // Corners and mid-edges of the faces, seen from outside, with the reference coordinates of the corners.
    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from);
    let mut owners: HashMap<[u32; 3], Vec<(usize, [usize; 3])>> = HashMap::new();
    for (e, nodes) in mesh.elements().iter().enumerate() {
        for face in FACES {
            let mut key = face.map(|a| nodes[a]);
            key.sort_unstable();
            owners.entry(key).or_default().push((e, face));
        }
    }
    // Gauss–Legendre with three points, collapsed onto the triangle: exact to degree 4, as the integrand is.
    let gauss = [(0.5 - 0.15_f64.sqrt(), 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0)];
    let mut volume = 0.0;
    for sides in owners.into_values().filter(|sides| sides.len() == 1) {
        let (e, [a, b, c]) = sides[0];
        let positions = mesh.elements()[e].map(|n| Vector3::from(mesh.positions()[n as usize]));
        let (along_b, along_c) = (corner[b] - corner[a], corner[c] - corner[a]);
        for (s, ws) in gauss {
            for (t, wt) in gauss {
                let at: [f64; 3] = (corner[a] + along_b * s + along_c * (t * (1.0 - s))).into();
                let x: Vector3<f64> = positions.iter().zip(shape_functions(at)).map(|(x, n)| x * n).sum();
                let tangent = |direction: Vector3<f64>| -> Vector3<f64> {
                    let slopes = shape_gradients(at).map(|g| Vector3::from(g).dot(&direction));
                    positions.iter().zip(slopes).map(|(x, d)| x * d).sum()
                };
                volume += ws * wt * (1.0 - s) * x.dot(&tangent(along_b).cross(&tangent(along_c))) / 3.0;
            }
        }
    }
    volume
}

/// Closed form: the tube less its notch; the volume by the divergence theorem.
#[test]
fn the_ring_has_the_volume_inside_its_surface() {
    let mesh = workspace_mesh("ring.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let ones = vec![1.0; 3 * mesh.positions().len()];
    let volume = form(&ones, matrices.mass(), &ones) / 3.0 / ALUMINIUM.density;
    // Measured: 2.0e-15.
    assert_close("volume, by divergence", volume, volume_by_divergence(&mesh), 1e-13);

    // The true ring: a tube less the notch, |y| ≤ 10 between the radii, half its height; ∫√(R² − y²) dy in closed form.
    let strip = |r: f64| 10.0 * (r * r - 100.0).sqrt() + r * r * (10.0 / r).asin();
    let exact = std::f64::consts::PI * (100.0 * 100.0 - 80.0 * 80.0) * 20.0 - 10.0 * (strip(100.0) - strip(80.0));
    // What is left is the ring's surface, which quadratic elements of 12 mm follow to about h⁴: measured 4.5e-7.
    assert_close("volume, of the geometry", volume, exact, 2e-6);
}

/// Conserved: symmetry of the ring.
#[test]
fn the_ring_has_no_first_moment_across_its_plane_of_symmetry() {
    let mesh = workspace_mesh("ring.msh");
    let matrices = assemble(&mesh, &aluminium(), &[]).unwrap();
    let m = moments(&mesh, matrices.mass(), 2);
    assert!((m.first[1] / m.zeroth).abs() < 1e-3, "{:?}", m.first[1] / m.zeroth);
    // The notch takes mass from the side of +x, top.
    assert!(m.first[0] / m.zeroth < -0.1);
    assert!(m.first[2] / m.zeroth < 10.0 - 0.01);
}
