//! A ball of curved elements, made in code.

use std::collections::HashMap;

use fem_tet10::{Mesh, MeshParts};
use nalgebra::Vector3;

/// Mid-edges in gmsh's order.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// The unit ball: the octahedron |x| + |y| + |z| ≤ 1 cut into 8·8ⁿ tetrahedra, then every node moved out along its
/// ray by |x|₁/|x|₂. All elements come out curved, and they still fit together.
pub fn ball(refinements: usize) -> Mesh {
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
        ..MeshParts::default()
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
