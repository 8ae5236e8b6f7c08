//! Meshes made in code.

use std::collections::{BTreeMap, HashMap};

use fem_tet10::MeshParts;
use nalgebra::Vector3;

/// Ends of the mid-edge nodes of an element.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// A box of tetrahedra with one corner at the origin: `cells` cells along its edges, six elements in each.
pub fn box_mesh(size: [f64; 3], cells: [usize; 3]) -> MeshParts {
    // Corner nodes have even places; the middle of an edge lies between.
    let mut tags: HashMap<[usize; 3], u64> = HashMap::new();
    let mut parts = MeshParts { source: "box".to_owned(), regions: vec![vec![]], ..MeshParts::default() };
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    for cell in 0..cells.iter().product() {
        let at = [cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])];
        for (turn, order) in orders.iter().enumerate() {
            // Along the three edges of the cell, in one of their orders, from its first corner to its last.
            let mut corners = [at.map(|k| 2 * k); 4];
            for (k, axis) in order.iter().enumerate() {
                corners[k + 1..].iter_mut().for_each(|corner| corner[*axis] += 2);
            }
            // The odd orders are left-handed.
            if turn >= 3 {
                corners.swap(2, 3);
            }
            let middles = EDGES.map(|[a, b]| [0, 1, 2].map(|axis| (corners[a][axis] + corners[b][axis]) / 2));
            let mut nodes = [0; 10];
            for (tag, place) in nodes.iter_mut().zip(corners.iter().chain(&middles)) {
                *tag = *tags.entry(*place).or_insert_with(|| {
                    let along = |axis: usize| size[axis] * place[axis] as f64 / (2 * cells[axis]) as f64;
                    parts.positions.push([along(0), along(1), along(2)]);
                    parts.positions.len() as u64
                });
            }
            parts.elements.push(nodes);
        }
    }
    numbered(parts)
}

/// Tags of the nodes and elements, one after the other.
pub fn numbered(mut parts: MeshParts) -> MeshParts {
    parts.node_tags = (1..=parts.positions.len() as u64).collect();
    parts.element_tags = (1..=parts.elements.len() as u64).collect();
    parts.element_regions = vec![0; parts.elements.len()];
    parts
}

/// The elements of a box of `cells` that are in cells which `keep` wants, with their nodes.
pub fn cells_of(size: [f64; 3], cells: [usize; 3], keep: impl Fn([usize; 3]) -> bool) -> MeshParts {
    let mut parts = box_mesh(size, cells);
    let place = |cell: usize| [cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])];
    parts.elements = (0..).zip(&parts.elements).filter(|(k, _)| keep(place(k / 6))).map(|(_, nodes)| *nodes).collect();
    let mut used: Vec<u64> = parts.elements.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for tag in parts.elements.iter_mut().flatten() {
        *tag = used.partition_point(|other| other < tag) as u64 + 1;
    }
    parts.positions = used.iter().map(|tag| parts.positions[*tag as usize - 1]).collect();
    numbered(parts)
}

/// The mesh with a crack: nodes at `is_cracked` become two, of which the elements beyond the plane x = `plane` have the
/// second.
pub fn cracked(mut parts: MeshParts, plane: f64, is_cracked: impl Fn([f64; 3]) -> bool) -> MeshParts {
    let mut twins = HashMap::new();
    for nodes in &mut parts.elements {
        let middle = nodes[..4].iter().map(|tag| parts.positions[*tag as usize - 1][0]).sum::<f64>() / 4.0;
        for tag in nodes.iter_mut().filter(|_| middle > plane) {
            let at = parts.positions[*tag as usize - 1];
            if is_cracked(at) {
                *tag = *twins.entry(*tag).or_insert_with(|| {
                    parts.positions.push(at);
                    parts.positions.len() as u64
                });
            }
        }
    }
    numbered(parts)
}

/// The mesh with its crack opened by so much: the later ones of nodes in one place are moved along x.
pub fn opened(mut parts: MeshParts, by: f64) -> MeshParts {
    for later in (1..parts.positions.len()).rev() {
        let at = parts.positions[later];
        if parts.positions[..later].contains(&at) {
            parts.positions[later][0] += by;
        }
    }
    parts
}

/// A ball of radius 1 of curved elements: the tetrahedra between its centre and the faces of an icosahedron, each
/// halved `halvings` times into eight, and bent so that what is level with a face lies on a sphere.
pub fn ball(halvings: u32) -> MeshParts {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = vec![Vector3::zeros()];
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        vertices.extend([Vector3::new(0.0, a, b), Vector3::new(a, b, 0.0), Vector3::new(b, 0.0, a)]);
    }
    vertices.iter_mut().skip(1).for_each(|v| *v = v.normalize());
    // Neighbours are 1.05 apart, the others 1.7 and more.
    let near = |a: usize, b: usize| (vertices[a] - vertices[b]).norm() < 1.2;
    let pairs = (1..13).flat_map(|a| (a + 1..13).map(move |b| (a, b))).filter(|(a, b)| near(*a, *b));
    let faces =
        pairs.flat_map(|(a, b)| (b + 1..13).filter(move |c| near(a, *c) && near(b, *c)).map(move |c| [a, b, c]));

    // Places are weights of the vertices, in parts of `whole`: two of them have their middle exactly.
    let whole = 2 << halvings;
    let mut parts = MeshParts { source: "ball".to_owned(), regions: vec![vec![]], ..MeshParts::default() };
    let mut tags: HashMap<Barycentric, u64> = HashMap::new();
    for [a, b, c] in faces {
        let mut pieces = vec![[0, a, b, c].map(|vertex| Barycentric::from([(vertex, whole)]))];
        for _ in 0..halvings {
            pieces = pieces.iter().flat_map(eighths).collect();
        }
        for mut corners in pieces {
            let x = corners.each_ref().map(|place| position(&vertices, place, whole));
            if (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[3] - x[0])) < 0.0 {
                corners.swap(2, 3);
            }
            let middles = EDGES.map(|[a, b]| middle(&corners[a], &corners[b]));
            let mut nodes = [0; 10];
            for (tag, place) in nodes.iter_mut().zip(corners.iter().chain(&middles)) {
                *tag = *tags.entry(place.clone()).or_insert_with(|| {
                    parts.positions.push(position(&vertices, place, whole).into());
                    parts.positions.len() as u64
                });
            }
            parts.elements.push(nodes);
        }
    }
    numbered(parts)
}

/// Weights of vertices.
type Barycentric = BTreeMap<usize, u32>;

fn middle(a: &Barycentric, b: &Barycentric) -> Barycentric {
    let mut sum = a.clone();
    for (vertex, weight) in b {
        *sum.entry(*vertex).or_default() += weight;
    }
    sum.into_iter().map(|(vertex, weight)| (vertex, weight / 2)).collect()
}

/// A tetrahedron's four corners and its octahedron in four.
fn eighths(corners: &[Barycentric; 4]) -> [[Barycentric; 4]; 8] {
    let [m01, m12, m02, m03, m23, m13] = &EDGES.map(|[a, b]| middle(&corners[a], &corners[b]));
    let [c0, c1, c2, c3] = corners;
    [
        [c0, m01, m02, m03],
        [m01, c1, m12, m13],
        [m02, m12, c2, m23],
        [m03, m13, m23, c3],
        [m01, m02, m03, m13],
        [m01, m02, m12, m13],
        [m02, m03, m13, m23],
        [m02, m12, m13, m23],
    ]
    .map(|piece| piece.map(Barycentric::clone))
}

/// Where a place is in the ball: in its direction, as far out as the weights of the vertices on the sphere say.
fn position(vertices: &[Vector3<f64>], place: &Barycentric, whole: u32) -> Vector3<f64> {
    let part = |weight: u32| f64::from(weight) / f64::from(whole);
    let direction: Vector3<f64> = place.iter().map(|(vertex, weight)| vertices[*vertex] * part(*weight)).sum();
    let radius: f64 = place.iter().filter(|(vertex, _)| **vertex > 0).map(|(_, weight)| part(*weight)).sum();
    if radius == 0.0 { direction } else { direction.normalize() * radius }
}
