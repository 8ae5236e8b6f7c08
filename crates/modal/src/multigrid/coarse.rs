//! The problem on the corners of second-order elements.
//!
//! Between two corners the displacement is linear, and the node in the middle of their edge has the mean of theirs, u = P u_c.
//! This is the space of linear elements on the same corners: with an eighth of the unknowns. `K_c = PᵀKP`, `M_c = PᵀMP`.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::matrix::mass::NodalMass;
use crate::matrix::renumbering::rows_at;
use crate::matrix::stiffness::NodalStiffness;

/// Corners that one task makes the columns of.
const PER_TASK: usize = 256;

/// The corners among the nodes.
pub(crate) struct Corners {
    /// The node of each corner.
    pub nodes: Vec<u32>,
    /// The corners at the ends of the edge that each node is in the middle of; a corner is at both of its own.
    ends: Vec<[u32; 2]>,
}

/// K and M over corners, in compressed columns.
pub(crate) struct CoarseMatrices {
    start: Vec<usize>,
    nodes: Vec<u32>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

/// Columns of both, of some corners.
#[derive(Default)]
struct Columns {
    lengths: Vec<usize>,
    nodes: Vec<u32>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

impl Corners {
    /// By the two nodes at the ends of the edge that each node is in the middle of; a corner has itself twice.
    pub(crate) fn new(edge_ends: &[[u32; 2]]) -> Self {
        let is_corner = |(node, ends): (usize, &[u32; 2])| (ends[0] as usize == node).then_some(node as u32);
        let nodes: Vec<u32> = edge_ends.iter().enumerate().filter_map(is_corner).collect();
        let mut number = vec![0; edge_ends.len()];
        nodes.iter().enumerate().for_each(|(corner, node)| number[*node as usize] = corner as u32);
        let ends = edge_ends.iter().map(|ends| ends.map(|node| number[node as usize])).collect();
        Self { nodes, ends }
    }

    /// Number of corners.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of corners with which `vectors` vectors over them can be told from each other.
    pub(crate) fn needed_for(vectors: usize) -> usize {
        (2 * vectors).div_ceil(3)
    }

    /// Number of all nodes.
    pub(crate) fn nodes_in_all(&self) -> usize {
        self.ends.len()
    }

    /// The corners of a node, each with its weight.
    #[inline(always)]
    fn weights(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let [a, b] = self.ends[node];
        let weight = if a == b { 1.0 } else { 0.5 };
        std::iter::once((a as usize, weight)).chain((a != b).then_some((b as usize, weight)))
    }

    /// Y = P·X, where a node has `of_node` numbers.
    pub(crate) fn prolong(&self, of_node: usize, x: &[f32], y: &mut [f32]) {
        let at = |corner: &u32| &x[of_node * *corner as usize..][..of_node];
        y.par_chunks_exact_mut(of_node).zip(&self.ends).with_min_len(PER_TASK).for_each(|(y, [a, b])| {
            y.iter_mut().zip(at(a).iter().zip(at(b))).for_each(|(y, (a, b))| *y = 0.5 * (a + b));
        });
    }

    /// Y = Pᵀ·X, likewise.
    pub(crate) fn restrict(&self, of_node: usize, x: &[f32], y: &mut [f32]) {
        y.fill(0.0);
        for (x, ends) in x.chunks_exact(of_node).zip(&self.ends) {
            for corner in ends {
                let y = &mut y[of_node * *corner as usize..][..of_node];
                y.iter_mut().zip(x).for_each(|(y, x)| *y += 0.5 * x);
            }
        }
    }

    /// P·X (3n×k) of a block over corners.
    pub(crate) fn prolonged(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(3 * self.ends.len(), x.ncols(), |row, k| {
            let [a, b] = self.ends[row / 3].map(|corner| x[(3 * corner as usize + row % 3, k)]);
            0.5 * (a + b)
        })
    }

    /// The rows of a block at the corners.
    pub(crate) fn at_corners(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        rows_at(&self.nodes, x)
    }

    /// PᵀKP and PᵀMP.
    pub(crate) fn matrices(&self, stiffness: NodalStiffness<'_>, mass: &NodalMass<'_>) -> CoarseMatrices {
        // The nodes that take something of each corner.
        let mut takers = vec![Vec::new(); self.count()];
        for node in 0..self.ends.len() {
            self.weights(node).for_each(|(corner, weight)| takers[corner].push((node, weight)));
        }
        let parts: Vec<Columns> = takers
            .par_chunks(PER_TASK)
            .map_init(
                || vec![u32::MAX; self.count()],
                |place, takers| {
                    let mut columns = Columns::default();
                    takers.iter().for_each(|takers| self.add_column(takers, stiffness, mass, place, &mut columns));
                    columns
                },
            )
            .collect();
        let mut all = CoarseMatrices { start: vec![0], nodes: Vec::new(), stiffness: Vec::new(), mass: Vec::new() };
        for part in parts {
            let mut end = all.nodes.len();
            all.start.extend(part.lengths.iter().map(|length| {
                end += length;
                end
            }));
            all.nodes.extend(part.nodes);
            all.stiffness.extend(part.stiffness);
            all.mass.extend(part.mass);
        }
        all
    }

    /// Adds the columns of a corner, which some nodes take of; `place` is scratch.
    fn add_column(
        &self,
        takers: &[(usize, f64)],
        stiffness: NodalStiffness<'_>,
        mass: &NodalMass<'_>,
        place: &mut [u32],
        columns: &mut Columns,
    ) {
        let mut found: Vec<(u32, [[f64; 3]; 3], f64)> = Vec::new();
        let at = |corner: usize, found: &mut Vec<(u32, [[f64; 3]; 3], f64)>, place: &mut [u32]| {
            if place[corner] == u32::MAX {
                place[corner] = found.len() as u32;
                found.push((corner as u32, [[0.0; 3]; 3], 0.0));
            }
            place[corner] as usize
        };
        for (node, of_node) in takers {
            let [x, y, z] = [0, 1, 2].map(|axis| stiffness.column(*node, axis));
            for (k, other) in x.0.iter().enumerate() {
                for (corner, weight) in self.weights(*other as usize) {
                    let entry = at(corner, &mut found, place);
                    for (sums, values) in found[entry].1.iter_mut().zip([x.1[k], y.1[k], z.1[k]]) {
                        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += of_node * weight * value);
                    }
                }
            }
            for (other, value) in mass.column(*node) {
                for (corner, weight) in self.weights(other) {
                    let entry = at(corner, &mut found, place);
                    found[entry].2 += of_node * weight * value;
                }
            }
        }
        found.iter().for_each(|(corner, ..)| place[*corner as usize] = u32::MAX);
        found.sort_unstable_by_key(|(corner, ..)| *corner);
        columns.lengths.push(found.len());
        columns.nodes.extend(found.iter().map(|(corner, ..)| *corner));
        for axis in 0..3 {
            columns.stiffness.extend(found.iter().flat_map(|(_, block, _)| block[axis]));
        }
        columns.mass.extend(found.iter().map(|(.., mass)| mass));
    }
}

impl CoarseMatrices {
    /// K_c.
    pub(crate) fn stiffness(&self) -> NodalStiffness<'_> {
        NodalStiffness::of_checked(&self.start, &self.nodes, &self.stiffness)
    }

    /// M_c.
    pub(crate) fn mass(&self) -> NodalMass<'_> {
        NodalMass::of_checked_nodes(&self.start, &self.nodes, &self.mass)
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        8 * self.start.len() + 84 * self.nodes.len()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use fem_tet10::{Material, Materials, Matrices, Mesh, MeshParts, assemble};
    use nalgebra::Vector3;

    use super::*;
    use crate::eigen::lanczos::random_block;
    use crate::matrix::columns::Columns as _;
    use crate::matrix::stiffness::StiffnessMatrix;
    use crate::matrix::tall;
    use crate::support::rigid_fields::rigid_fields;

    const STEEL: Material = Material { young_modulus: 2.1e5, poisson_ratio: 0.3, density: 7.85e-9 };

    /// A block of cells, each cut into six straight tetrahedra, and its matrices.
    pub(crate) struct Block {
        pub mesh: Mesh,
        pub matrices: Matrices,
        pub corners: Corners,
    }

    impl Block {
        pub(crate) fn new(cells: [usize; 3]) -> Self {
            Self::stretched(cells, [1.0; 3])
        }

        /// The same, stretched along the axes.
        pub(crate) fn stretched(cells: [usize; 3], stretch: [f64; 3]) -> Self {
            let points = cells.map(|cells| 2 * cells + 1);
            let all = |[x, y, z]: [usize; 3]| (0..x * y * z).map(move |i| [i % x, i / x % y, i / (x * y)]);
            let number = |[i, j, k]: [usize; 3]| (i + points[0] * (j + points[1] * k)) as u64;
            // A little off the grid, so that no two elements are alike.
            let corner = |at: [usize; 3]| {
                let at = at.map(|i| i as f64);
                [0, 1, 2].map(|axis| at[axis] + 0.2 * (1.7 * at[(axis + 1) % 3] + 2.3 * at[(axis + 2) % 3] + 1.0).sin())
            };
            // Corners have even places on the grid; at an odd one an edge goes through along the axes where it is odd.
            let position = |at: [usize; 3]| {
                let [a, b] = [corner(at.map(|i| i - i % 2)), corner(at.map(|i| i + i % 2))];
                [0, 1, 2].map(|axis| 0.5 * stretch[axis] * (a[axis] + b[axis]))
            };
            // From one corner of a cell to the opposite one, an axis at a time; every other order is a mirror image.
            let orders = [[0, 1, 2], [0, 2, 1], [1, 2, 0], [1, 0, 2], [2, 0, 1], [2, 1, 0]];
            let element = |cell: [usize; 3], (order, axes): (usize, &[usize; 3])| {
                let mut corners = [cell.map(|i| 2 * i); 4];
                for (step, axis) in axes.iter().enumerate() {
                    corners[step + 1..].iter_mut().for_each(|corner| corner[*axis] += 2);
                }
                if order % 2 == 1 {
                    corners.swap(1, 2);
                }
                let middle = |a: usize, b: usize| [0, 1, 2].map(|axis| (corners[a][axis] + corners[b][axis]) / 2);
                let [a, b, c, d] = corners;
                [a, b, c, d, middle(0, 1), middle(1, 2), middle(0, 2), middle(0, 3), middle(2, 3), middle(1, 3)]
                    .map(number)
            };
            let positions: Vec<[f64; 3]> = all(points).map(position).collect();
            let elements: Vec<[u64; 10]> =
                all(cells).flat_map(|cell| orders.iter().enumerate().map(move |axes| element(cell, axes))).collect();
            let mesh = Mesh::new(MeshParts {
                source: "made by a test".to_owned(),
                node_tags: (0..positions.len() as u64).collect(),
                positions,
                element_tags: (1..=elements.len() as u64).collect(),
                regions: vec![vec![]],
                element_regions: vec![0; elements.len()],
                elements,
                ..MeshParts::default()
            })
            .unwrap();
            let matrices = assemble(&mesh, &Materials::Uniform(STEEL), &[]).unwrap();
            let corners = Corners::new(&mesh.edge_ends().unwrap());
            Self { mesh, matrices, corners }
        }

        pub(crate) fn ends(&self) -> Vec<[u32; 2]> {
            self.mesh.edge_ends().unwrap()
        }

        pub(crate) fn stiffness(&self) -> NodalStiffness<'_> {
            let Self { matrices, .. } = self;
            NodalStiffness::of_checked(matrices.start(), matrices.nodes(), matrices.stiffness_by_nodes())
        }

        pub(crate) fn mass(&self) -> NodalMass<'_> {
            let Self { matrices, .. } = self;
            NodalMass::of_checked_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes())
        }

        /// The positions of the corners.
        pub(crate) fn corner_positions(&self) -> Vec<[f64; 3]> {
            self.corners.nodes.iter().map(|node| self.mesh.positions()[*node as usize]).collect()
        }

        /// P, by the elements: the mean of the corners of each edge.
        fn prolongation(&self) -> Mat<f64> {
            let mut corners: Vec<u32> =
                self.mesh.elements().iter().flat_map(|nodes| [nodes[0], nodes[1], nodes[2], nodes[3]]).collect();
            corners.sort_unstable();
            corners.dedup();
            let mut p = Mat::zeros(3 * self.mesh.positions().len(), 3 * corners.len());
            let mut set = |node: u32, of: u32, weight: f64| {
                let corner = corners.binary_search(&of).unwrap();
                (0..3).for_each(|axis| p[(3 * node as usize + axis, 3 * corner + axis)] = weight);
            };
            for nodes in self.mesh.elements() {
                nodes[..4].iter().for_each(|node| set(*node, *node, 1.0));
                for (node, ends) in nodes[4..].iter().zip([[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]]) {
                    ends.iter().for_each(|end: &usize| set(*node, nodes[*end], 0.5));
                }
            }
            p
        }
    }

    /// Columns that stand side by side in rows.
    const SIDE_BY_SIDE: usize = 4;

    fn rows(x: &Mat<f64>) -> Vec<f32> {
        (0..x.nrows()).flat_map(|i| (0..SIDE_BY_SIDE).map(move |k| x[(i, k)] as f32)).collect()
    }

    fn columns(x: &[f32]) -> Mat<f64> {
        Mat::from_fn(x.len() / SIDE_BY_SIDE, SIDE_BY_SIDE, |i, k| f64::from(x[SIDE_BY_SIDE * i + k]))
    }

    /// P X by rows.
    fn prolong(corners: &Corners, x: &Mat<f64>) -> Mat<f64> {
        // What is there before must not be added to.
        let mut y = vec![7.0; SIDE_BY_SIDE * 3 * corners.ends.len()];
        corners.prolong(3 * SIDE_BY_SIDE, &rows(x), &mut y);
        columns(&y)
    }

    /// Pᵀ X by rows.
    fn restrict(corners: &Corners, x: &Mat<f64>) -> Mat<f64> {
        let mut y = vec![7.0; SIDE_BY_SIDE * 3 * corners.count()];
        corners.restrict(3 * SIDE_BY_SIDE, &rows(x), &mut y);
        columns(&y)
    }

    /// How far a matrix is from what it should be, relative to the largest entry.
    fn off(found: &Mat<f64>, expected: &Mat<f64>) -> f64 {
        assert_eq!((found.nrows(), found.ncols()), (expected.nrows(), expected.ncols()));
        (found - expected).norm_max() / expected.norm_max()
    }

    /// Dense K_c and M_c.
    fn dense(matrices: &CoarseMatrices, size: usize) -> [Mat<f64>; 2] {
        let [mut k, mut m] = [Mat::zeros(size, size), Mat::zeros(size, size)];
        let stiffness = StiffnessMatrix::Nodal(matrices.stiffness());
        assert_eq!(stiffness.ncols(), size);
        for column in 0..size {
            stiffness.for_each_in_column(column, |row, value| k[(row, column)] = value);
        }
        for entry in matrices.mass().entries() {
            (0..3).for_each(|axis| m[(3 * entry.row + axis, 3 * entry.col + axis)] = entry.val);
        }
        [k, m]
    }

    /// Independent reference: a dense P made from the elements.
    #[test]
    fn what_goes_to_all_nodes_and_to_the_corners_is_transposed() {
        let block = Block::new([3, 2, 4]);
        let (corners, p) = (&block.corners, block.prolongation());
        assert_eq!([corners.count(), corners.ends.len()], [4 * 3 * 5, 7 * 5 * 9]);
        let mut seed = 3;
        let x = random_block(p.ncols(), SIDE_BY_SIDE, &mut seed);
        let y = random_block(p.nrows(), SIDE_BY_SIDE, &mut seed);
        let (px, pty) = (prolong(corners, &x), restrict(corners, &y));
        for k in 0..SIDE_BY_SIDE {
            let [work, of_corners] = [px.col(k).transpose() * y.col(k), x.col(k).transpose() * pty.col(k)];
            assert!((work - of_corners).abs() < 1e-6 * px.col(k).norm_l2() * y.col(k).norm_l2(), "{work} {of_corners}");
        }
        // Rows are in single precision.
        assert!(off(&px, &(&p * &x)) < 1e-6);
        assert!(off(&pty, &(p.transpose() * &y)) < 1e-6);
        let in_double = corners.prolonged(x.as_ref());
        assert!(off(&in_double, &(&p * &x)) < 1e-15);
        assert_eq!(corners.at_corners(in_double.as_ref()), x);
    }

    /// Closed form: a linear field.
    #[test]
    fn linear_displacements_are_kept() {
        let block = Block::new([3, 2, 4]);
        let slope = [[0.3, -1.2, 0.5], [0.9, 0.1, -0.7], [-0.4, 1.1, 0.8]];
        // One column is linear, the others are it with the axes of the displacement changed round.
        let field = |positions: &[[f64; 3]]| {
            Mat::from_fn(3 * positions.len(), SIDE_BY_SIDE, |i, k| {
                let (x, along) = (positions[i / 3], (i + k) % 3);
                2.0 + along as f64 + (0..3).map(|axis| slope[along][axis] * x[axis]).sum::<f64>()
            })
        };
        let (everywhere, of_corners) = (field(block.mesh.positions()), field(&block.corner_positions()));
        assert!(off(&prolong(&block.corners, &of_corners), &everywhere) < 1e-6);
        assert!(off(&block.corners.prolonged(of_corners.as_ref()), &everywhere) < 1e-15);
        assert_eq!(block.corners.at_corners(everywhere.as_ref()), of_corners);
    }

    /// Independent reference: the dense products Pᵀ K P and Pᵀ M P.
    #[test]
    fn matrices_over_corners_are_the_products_with_the_prolongation() {
        // The second has the corners of two tasks.
        for cells in [[2, 3, 2], [66, 1, 1]] {
            let block = Block::new(cells);
            let (Block { matrices, corners, .. }, p) = (&block, block.prolongation());
            let found = corners.matrices(block.stiffness(), &block.mass());
            let [k, m] = dense(&found, 3 * corners.count());
            for (found, of_nodes) in [(k, matrices.stiffness()), (m, matrices.mass())] {
                // Measured: 7.5e-16 at worst.
                assert!(off(&found, &(p.transpose() * (of_nodes * &p))) < 1e-14);
            }
            // Rows that rise, both triangles alike.
            let CoarseMatrices { start, nodes, stiffness, mass } = &found;
            NodalStiffness::new(start, nodes, stiffness).unwrap().check().unwrap();
            NodalMass::of_nodes(start, nodes, mass).unwrap();
        }
        const { assert!(67 * 4 > PER_TASK, "there is one task only") };
    }

    /// Conserved: no force of rigid motions; mass, centre of mass and inertia of the fine matrices.
    #[test]
    fn rigid_motions_of_the_corners_meet_no_stiffness_and_all_of_the_mass() {
        let block = Block::new([4, 3, 5]);
        let found = block.corners.matrices(block.stiffness(), &block.mass());
        let motions = |positions: &[[f64; 3]]| rigid_fields(positions, &Vector3::new(4.0, 3.0, 5.0), 3);
        let (everywhere, of_corners) = (motions(block.mesh.positions()), motions(&block.corner_positions()));
        let [k, m] = dense(&found, 3 * block.corners.count());
        let forces = &k * &of_corners;
        for (motion, force) in of_corners.col_iter().zip(forces.col_iter()) {
            let relative = force.norm_l2() / (k.norm_l2() * motion.norm_l2());
            // Measured: 1.9e-17 at worst.
            assert!(relative < 1e-15, "{relative:e}");
        }
        // Mass, centre of mass and inertia.
        let expected = tall::inner(everywhere.as_ref(), block.mass().product(everywhere.as_ref()).as_ref());
        assert!(off(&(of_corners.transpose() * (&m * &of_corners)), &expected) < 1e-13);
        let [total, before] = [found.mass(), block.mass()].map(|mass| mass.row_sums().iter().sum::<f64>());
        assert!((total / before - 1.0).abs() < 1e-13 && (expected[(0, 0)] / before - 1.0).abs() < 1e-13);
    }
}
