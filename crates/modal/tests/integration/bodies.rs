//! Bodies that the tests work on.

use faer::sparse::SparseColMatRef;
use fem_tet10::{Material, Materials, Matrices, Mesh, MeshParts, assemble, read_msh};
use modal::{ModalError, Modes, Solver, Support};

pub struct Body {
    pub positions: Vec<[f64; 3]>,
    pub matrices: Matrices,
}

impl Body {
    pub fn new(mesh: &Mesh, material: Material) -> Self {
        let matrices = assemble(mesh, &Materials::Uniform(material), &[]).unwrap();
        Self { positions: mesh.positions().to_vec(), matrices }
    }

    pub fn try_modes(&self, flexible: usize) -> Result<Modes, ModalError> {
        free_modes(self.matrices.stiffness(), self.matrices.mass(), &self.positions, flexible)
    }

    pub fn modes(&self, flexible: usize) -> Modes {
        self.try_modes(flexible).unwrap()
    }

    pub fn held(&self, support: &Support) -> Solver<'_> {
        Solver::new(self.matrices.stiffness(), self.matrices.mass(), &self.positions, support).unwrap()
    }
}

/// Modes of a body that nothing holds.
pub fn free_modes(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    positions: &[[f64; 3]],
    flexible: usize,
) -> Result<Modes, ModalError> {
    Solver::new(stiffness, mass, positions, &Support::free())?.modes(flexible, |_| ())
}

pub const STEEL: Material = Material { young_modulus: 2.1e5, poisson_ratio: 0.3, density: 7.85e-9 };

/// A mesh of the repository's `meshes` folder.
pub fn mesh_file(name: &str) -> Mesh {
    read_msh(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes").join(name)).unwrap()
}

/// A mesh of one material, with node indices for tags.
pub fn mesh(positions: Vec<[f64; 3]>, elements: Vec<[u64; 10]>) -> Mesh {
    Mesh::new(MeshParts {
        source: "made by a test".to_owned(),
        node_tags: (0..positions.len() as u64).collect(),
        positions,
        element_tags: (1..=elements.len() as u64).collect(),
        groups: vec![],
        regions: vec![vec![]],
        element_regions: vec![0; elements.len()],
        elements,
        ..MeshParts::default()
    })
    .unwrap()
}

/// A block of `cells` cells, each cut into six tetrahedra. The cut is mirrored from cell to cell, so that a block
/// with an even number of cells on each axis has all symmetries of its shape.
pub fn block_mesh(size: [f64; 3], cells: [usize; 3]) -> Mesh {
    let points = cells.map(|c| 2 * c + 1);
    let tag = |g: [usize; 3]| (g[0] + points[0] * (g[1] + points[1] * g[2])) as u64;
    let (mut positions, mut elements) = (vec![], vec![]);
    for z in 0..points[2] {
        for y in 0..points[1] {
            for x in 0..points[0] {
                let at = [x, y, z];
                positions.push(std::array::from_fn(|a| size[a] * (at[a] as f64 / (2 * cells[a]) as f64 - 0.5)));
            }
        }
    }
    const PATHS: [([usize; 3], bool); 6] = [
        ([0, 1, 2], false),
        ([1, 2, 0], false),
        ([2, 0, 1], false),
        ([0, 2, 1], true),
        ([1, 0, 2], true),
        ([2, 1, 0], true),
    ];
    for cell in (0..cells.iter().product::<usize>())
        .map(|i| [i % cells[0], (i / cells[0]) % cells[1], i / (cells[0] * cells[1])])
    {
        for (path, odd) in PATHS {
            // From one corner of the cell to the opposite one, an axis at a time.
            let mut corner = [0, 0, 0];
            let mut corners = vec![corner];
            for axis in path {
                corner[axis] = 2;
                corners.push(corner);
            }
            let mirrored = cell.map(|c| c % 2 == 1);
            if odd != (mirrored.iter().filter(|m| **m).count() % 2 == 1) {
                corners.swap(1, 2);
            }
            let on_grid = |c: [usize; 3]| -> [usize; 3] {
                std::array::from_fn(|a| 2 * cell[a] + if mirrored[a] { 2 - c[a] } else { c[a] })
            };
            let c: Vec<[usize; 3]> = corners.into_iter().map(on_grid).collect();
            let mid = |i: usize, j: usize| tag(std::array::from_fn(|a| (c[i][a] + c[j][a]) / 2));
            let mid_edges = [mid(0, 1), mid(1, 2), mid(0, 2), mid(0, 3), mid(2, 3), mid(1, 3)];
            let nodes: Vec<u64> = c.iter().map(|g| tag(*g)).chain(mid_edges).collect();
            elements.push(nodes.try_into().unwrap());
        }
    }
    mesh(positions, elements)
}

pub fn block(size: [f64; 3], cells: [usize; 3]) -> Body {
    Body::new(&block_mesh(size, cells), STEEL)
}

/// Straight tetrahedra from their corners; corners at one place are one node.
pub fn tetrahedra(corners: &[[[f64; 3]; 4]]) -> Body {
    let (mut positions, mut elements): (Vec<[f64; 3]>, _) = (vec![], vec![]);
    for c in corners {
        let mid = |i: usize, j: usize| std::array::from_fn(|a| 0.5 * (c[i][a] + c[j][a]));
        let all = [c[0], c[1], c[2], c[3], mid(0, 1), mid(1, 2), mid(0, 2), mid(0, 3), mid(2, 3), mid(1, 3)];
        let nodes = all.map(|x| {
            let found = positions.iter().position(|p| *p == x).unwrap_or_else(|| {
                positions.push(x);
                positions.len() - 1
            });
            found as u64
        });
        elements.push(nodes);
    }
    Body::new(&mesh(positions, elements), STEEL)
}

pub const CORNER: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
