//! Meshes and small tools that the tests share.

use std::path::PathBuf;

use faer::sparse::SparseColMatRef;
use fem_tet10::{Material, Materials, Mesh, MeshParts, PointMass, read_msh};

/// A mesh of `tests/data`; the .geo beside it says how it was made.
pub fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

pub fn data_mesh(name: &str) -> Mesh {
    read_msh(data(name)).unwrap()
}

/// A mesh of the workspace: `plate.msh` (straight elements), `ring.msh` (curved elements).
pub fn workspace_mesh(name: &str) -> Mesh {
    read_msh(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../meshes").join(name)).unwrap()
}

pub const ALUMINIUM: Material = Material { young_modulus: 70e3, poisson_ratio: 0.33, density: 2.7e-9 };

pub const PLATE_MASS: f64 = 2.7e-9 * 1000.0 * 50.0 * 10.0;

pub fn aluminium() -> Materials {
    Materials::Uniform(ALUMINIUM)
}

/// The eight masses of the paper's plate, at its corners.
pub fn corner_masses() -> Vec<PointMass> {
    let mut masses = Vec::new();
    for x in [-500.0, 500.0] {
        for y in [-25.0, 25.0] {
            for z in [0.0, 10.0] {
                masses.push(PointMass { at: [x, y, z], mass: 0.001, spread: None });
            }
        }
    }
    masses
}

/// The parts that a mesh was made of, to be spoiled and put together again.
pub fn parts(mesh: &Mesh) -> MeshParts {
    let tags = mesh.node_tags();
    MeshParts {
        source: mesh.source().to_owned(),
        node_tags: tags.to_vec(),
        positions: mesh.positions().to_vec(),
        element_tags: mesh.element_tags().to_vec(),
        elements: mesh.elements().iter().map(|nodes| nodes.map(|node| tags[node as usize])).collect(),
        groups: mesh.groups().to_vec(),
        regions: (0..mesh.elements().len()).map(|e| mesh.element_groups(e).to_vec()).collect(),
        element_regions: (0..mesh.elements().len()).collect(),
        ..MeshParts::default()
    }
}

/// One straight element with tag 5 and nodes 1 to 10.
pub fn single(corners: [[f64; 3]; 4]) -> MeshParts {
    let edges = [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)];
    let mut positions = corners.to_vec();
    positions.extend(edges.map(|(a, b)| [0, 1, 2].map(|axis| 0.5 * (corners[a][axis] + corners[b][axis]))));
    MeshParts {
        source: "single".to_owned(),
        node_tags: (1..=10).collect(),
        positions,
        element_tags: vec![5],
        elements: vec![[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]],
        groups: vec![],
        regions: vec![vec![]],
        element_regions: vec![0],
        ..MeshParts::default()
    }
}

/// The vector of a displacement field, `3·node + axis`.
pub fn field(mesh: &Mesh, displacement: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    mesh.positions().iter().flat_map(|x| displacement(*x)).collect()
}

/// The six rigid motions about the origin.
pub fn rigid_motions(mesh: &Mesh) -> Vec<Vec<f64>> {
    vec![
        field(mesh, |_| [1.0, 0.0, 0.0]),
        field(mesh, |_| [0.0, 1.0, 0.0]),
        field(mesh, |_| [0.0, 0.0, 1.0]),
        field(mesh, |[_, y, z]| [0.0, -z, y]),
        field(mesh, |[x, _, z]| [z, 0.0, -x]),
        field(mesh, |[x, y, _]| [-y, x, 0.0]),
    ]
}

/// (row, column, value) of all that is stored.
pub fn entries<'a>(matrix: SparseColMatRef<'a, usize, f64>) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
    let (columns, rows, values) = (matrix.symbolic().col_ptr(), matrix.symbolic().row_idx(), matrix.val());
    (0..columns.len() - 1).flat_map(move |j| (columns[j]..columns[j + 1]).map(move |k| (rows[k], j, values[k])))
}

/// A u.
pub fn product(matrix: SparseColMatRef<'_, usize, f64>, u: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; u.len()];
    for (i, j, value) in entries(matrix) {
        result[i] += value * u[j];
    }
    result
}

/// |A| |u|: the scale that rounding in A u is measured against.
pub fn absolute_product(matrix: SparseColMatRef<'_, usize, f64>, u: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; u.len()];
    for (i, j, value) in entries(matrix) {
        result[i] += (value * u[j]).abs();
    }
    result
}

/// Summed in pairs, so that the sum's own rounding does not hide that of the matrices.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    if a.len() <= 8 {
        return a.iter().zip(b).map(|(a, b)| a * b).sum();
    }
    let ((a, more_a), (b, more_b)) = (a.split_at(a.len() / 2), b.split_at(a.len() / 2));
    dot(a, b) + dot(more_a, more_b)
}

/// uᵀ A v.
pub fn form(u: &[f64], matrix: SparseColMatRef<'_, usize, f64>, v: &[f64]) -> f64 {
    dot(u, &product(matrix, v))
}

/// Largest relative size of A r over the rigid motions r.
pub fn worst_rigid_force(mesh: &Mesh, matrix: SparseColMatRef<'_, usize, f64>) -> f64 {
    let largest = |v: Vec<f64>| v.into_iter().fold(0.0, |m: f64, x| if m >= x.abs() { m } else { x.abs() });
    rigid_motions(mesh)
        .iter()
        .map(|r| largest(product(matrix, r)) / largest(absolute_product(matrix, r)))
        .fold(0.0, f64::max)
}

/// Mass, first and second moments that M gives to the body: ∫ρ, ∫ρ x_j, ∫ρ x_j x_k, from fields along `axis`.
pub struct Moments {
    pub zeroth: f64,
    pub first: [f64; 3],
    pub second: [[f64; 3]; 3],
}

pub fn moments(mesh: &Mesh, mass: SparseColMatRef<'_, usize, f64>, axis: usize) -> Moments {
    let along = |value: &dyn Fn([f64; 3]) -> f64| {
        field(mesh, |x| {
            let mut u = [0.0; 3];
            u[axis] = value(x);
            u
        })
    };
    let one = along(&|_| 1.0);
    let linear: Vec<_> = (0..3).map(|j| along(&move |x| x[j])).collect();
    let m_one = product(mass, &one);
    let mut second = [[0.0; 3]; 3];
    for (j, row) in second.iter_mut().enumerate() {
        let m_linear = product(mass, &linear[j]);
        for (k, value) in row.iter_mut().enumerate() {
            *value = dot(&m_linear, &linear[k]);
        }
    }
    Moments { zeroth: dot(&one, &m_one), first: [0, 1, 2].map(|j| dot(&linear[j], &m_one)), second }
}

/// |found/expected − 1| must stay below `tolerance`; the message says what it was.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= tolerance, "{what}: {found:e} is off {expected:e} by {off:.2e} (allowed {tolerance:e})");
}

/// Pseudo-random numbers, the same every time (Knuth's MMIX linear congruential generator).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// Below `bound`.
    pub fn index(&mut self, bound: usize) -> usize {
        self.bits() as usize % bound
    }

    /// In (0, 1).
    pub fn unit(&mut self) -> f64 {
        (f64::from(self.bits()) + 0.5) / 4_294_967_296.0
    }

    /// Reference coordinates inside the reference tetrahedron.
    pub fn inside_tetrahedron(&mut self) -> [f64; 3] {
        let weights = [0; 4].map(|_| -self.unit().ln());
        let sum: f64 = weights.iter().sum();
        [weights[1] / sum, weights[2] / sum, weights[3] / sum]
    }
}
