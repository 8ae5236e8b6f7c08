//! Curved elements: a sphere made in code, and the ring that gmsh made.

use std::collections::HashMap;

use fem_tet10::{Material, Materials, Mesh, MeshParts, assemble, shape_functions, shape_gradients};
use nalgebra::Vector3;

use crate::fixtures::{ALUMINIUM, aluminium, assert_close, form, moments, workspace_mesh, worst_rigid_force};

/// Mid-edges in gmsh's order.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// The unit ball: the octahedron |x| + |y| + |z| ≤ 1 cut into 8·8ⁿ tetrahedra, then every node moved out along its
/// ray by |x|₁/|x|₂. All elements come out curved, and they still fit together.
fn ball(refinements: usize) -> Mesh {
    let mut tetrahedra: Vec<[[f64; 3]; 4]> = Vec::new();
    for sx in [1.0, -1.0] {
        for sy in [1.0, -1.0] {
            for sz in [1.0, -1.0] {
                let [x, y, z] = [[sx, 0.0, 0.0], [0.0, sy, 0.0], [0.0, 0.0, sz]];
                tetrahedra.push(if sx * sy * sz > 0.0 { [[0.0; 3], x, y, z] } else { [[0.0; 3], y, x, z] });
            }
        }
    }
    for _ in 0..refinements {
        tetrahedra = tetrahedra.into_iter().flat_map(eighths).collect();
    }
    // Coordinates are small multiples of a power of two, so equal nodes are equal to the last bit.
    let mut tags: HashMap<[u64; 3], u64> = HashMap::new();
    let mut positions = Vec::new();
    let elements: Vec<[u64; 10]> = tetrahedra
        .iter()
        .map(|corners| {
            let mids = EDGES.map(|[a, b]| middle(corners[a], corners[b]));
            let mut nodes = [0; 10];
            for (tag, x) in nodes.iter_mut().zip(corners.iter().chain(&mids)) {
                *tag = *tags.entry(x.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    let v = Vector3::from(*x);
                    let norm = v.norm();
                    positions.push(if norm > 0.0 { (v * (v.lp_norm(1) / norm)).into() } else { *x });
                    positions.len() as u64
                });
            }
            nodes
        })
        .collect();
    Mesh::new(MeshParts {
        source: "ball".to_owned(),
        node_tags: (1..=positions.len() as u64).collect(),
        positions,
        element_tags: (1..=elements.len() as u64).collect(),
        regions: vec![vec![]],
        element_regions: vec![0; elements.len()],
        elements,
        groups: vec![],
    })
    .unwrap()
}

fn middle(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis]))
}

/// A tetrahedron cut into four at its corners and four of the octahedron between, all the right way round.
fn eighths(x: [[f64; 3]; 4]) -> Vec<[[f64; 3]; 4]> {
    let m = EDGES.map(|[a, b]| middle(x[a], x[b]));
    let [m01, m12, m02, m03, m23, m13] = m;
    let mut parts = vec![
        [x[0], m01, m02, m03],
        [m01, x[1], m12, m13],
        [m02, m12, x[2], m23],
        [m03, m13, m23, x[3]],
        [m01, m23, m02, m12],
        [m01, m23, m12, m13],
        [m01, m23, m13, m03],
        [m01, m23, m03, m02],
    ];
    for corners in &mut parts {
        let [a, b, c, d] = corners.map(Vector3::from);
        if (b - a).cross(&(c - a)).dot(&(d - a)) < 0.0 {
            corners.swap(2, 3);
        }
    }
    parts
}

fn unit_density() -> Materials {
    Materials::Uniform(Material { density: 1.0, ..ALUMINIUM })
}

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
