//! The problem on the corners of second-order elements.
//!
//! Between two corners the displacement is linear, and the node in the middle of their edge has the mean of theirs, u = P u_c.
//! That is the space of linear elements on the same corners: with an eighth of the unknowns. `K_c = PᵀKP`, `M_c = PᵀMP`.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::mass::NodalMass;
use crate::stiffness::NodalStiffness;

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

    /// What a node takes of its corners, each with its weight.
    #[inline(always)]
    fn weights(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let [a, b] = self.ends[node];
        let weight = if a == b { 1.0 } else { 0.5 };
        std::iter::once((a as usize, weight)).chain((a != b).then_some((b as usize, weight)))
    }

    /// Y = P·X, where a node has so many numbers.
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
        Mat::from_fn(3 * self.count(), x.ncols(), |row, k| x[(3 * self.nodes[row / 3] as usize + row % 3, k)])
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
            .map(|takers| {
                let mut place = vec![u32::MAX; self.count()];
                let mut columns = Columns::default();
                takers.iter().for_each(|takers| self.add_column(takers, stiffness, mass, &mut place, &mut columns));
                columns
            })
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
