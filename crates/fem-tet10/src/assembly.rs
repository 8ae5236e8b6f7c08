//! Consistent mass and stiffness, filled column by column into one sparsity pattern.
//!
//! Each column of nodes gathers from the elements around its node, always in the same order. So no two threads
//! write to one place, and the sums do not depend on how many threads there are.

use std::collections::HashMap;

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use rayon::prelude::*;

use crate::error::AssemblyError;
use crate::integration::{IntegrationPoint, Rules};
use crate::locate::Location;
use crate::material::{Material, Materials};
use crate::mesh::Mesh;
use crate::point_mass::PointMass;
use crate::quadrature;
use crate::shape::shape_functions;

/// What the memory is for.
const MATRICES: &str = "the mass and stiffness matrices";
/// The integration points of a curved element.
const INTEGRATION_BYTES: usize = 3500;

/// Stiffness and mass matrices (N×N, N = 3n) that share one pattern, both triangles stored.
#[derive(Debug, Clone)]
pub struct Matrices {
    pattern: SymbolicSparseColMat<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

impl Matrices {
    /// K (N×N), force per length.
    pub fn stiffness(&self) -> SparseColMatRef<'_, usize, f64> {
        SparseColMatRef::new(self.pattern.as_ref(), &self.stiffness)
    }

    /// M (N×N): the consistent mass matrix with the point masses in it.
    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        SparseColMatRef::new(self.pattern.as_ref(), &self.mass)
    }

    /// Memory held, in bytes: 24 for each stored entry (one index, two values) and 8 for each column.
    pub fn bytes(&self) -> usize {
        8 * (self.pattern.row_idx().len() + self.pattern.col_ptr().len() + self.stiffness.len() + self.mass.len())
    }
}

/// Assembles K and M.
///
/// While it works it holds, besides the matrices, about 1 kB for each straight element and 3.5 kB for each curved one.
///
/// # Errors
/// See [`AssemblyError`]: materials, groups and point masses that do not fit the mesh.
pub fn assemble(mesh: &Mesh, materials: &Materials, point_masses: &[PointMass]) -> Result<Matrices, AssemblyError> {
    let materials = materials.of_elements(mesh)?;
    let carried = point_masses
        .iter()
        .map(|p| Ok((p.mass, p.location(mesh)?)))
        .collect::<Result<Vec<(f64, Location)>, AssemblyError>>()?;

    let incidence = Incidence::new(mesh);
    let neighbours = neighbours(mesh, &incidence, &carried);
    let entries = 9 * neighbours.iter().map(Vec::len).sum::<usize>();
    memory::check(MATRICES, 24 * entries + INTEGRATION_BYTES * mesh.elements().len())?;
    let pattern = pattern(&neighbours)?;
    let mut stiffness = memory::zeros(MATRICES, entries)?;
    let mut mass = memory::zeros(MATRICES, entries)?;

    let rules = Rules::new();
    let points: Vec<Vec<IntegrationPoint>> =
        (0..mesh.elements().len()).into_par_iter().map(|e| rules.points(&mesh.element_positions(e))).collect();
    let products = MassProducts::new();

    let columns: Vec<_> = split_columns(&mut stiffness, &neighbours)
        .into_iter()
        .zip(split_columns(&mut mass, &neighbours))
        .enumerate()
        .collect();
    columns.into_par_iter().for_each(|(node, (k_column, m_column))| {
        let rows = &neighbours[node];
        for &(element, b) in incidence.of(node) {
            let (element, b) = (element as usize, b as usize);
            let material = &materials[element];
            let places = mesh.elements()[element].map(|row| place_of(rows, row));
            add_stiffness(k_column, rows.len(), &places, &points[element], material, b);
            for (a, place) in places.into_iter().enumerate() {
                add_scalar(m_column, rows.len(), place, material.density * products.integral(&points[element], a, b));
            }
        }
    });
    for (m, location) in &carried {
        add_point_mass(&mut mass, &pattern, &neighbours, *m, location);
    }
    Ok(Matrices { pattern, stiffness, mass })
}

/// For each node, the elements it belongs to and its number in them.
#[derive(Debug)]
pub(crate) struct Incidence {
    start: Vec<usize>,
    entries: Vec<(u32, u8)>,
}

impl Incidence {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut start = vec![0; mesh.positions().len() + 1];
        for node in mesh.elements().iter().flatten() {
            start[*node as usize + 1] += 1;
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut next = start.clone();
        let mut entries = vec![(0, 0); 10 * mesh.elements().len()];
        for (e, nodes) in (0..).zip(mesh.elements()) {
            for (a, node) in (0..).zip(nodes) {
                entries[next[*node as usize]] = (e, a);
                next[*node as usize] += 1;
            }
        }
        Self { start, entries }
    }

    pub(crate) fn of(&self, node: usize) -> &[(u32, u8)] {
        &self.entries[self.start[node]..self.start[node + 1]]
    }
}

/// For each node, the nodes it is coupled to (itself too), sorted.
fn neighbours(mesh: &Mesh, incidence: &Incidence, carried: &[(f64, Location)]) -> Vec<Vec<u32>> {
    let mut carriers: HashMap<u32, Vec<&Location>> = HashMap::new();
    for (_, location) in carried {
        for node in &location.nodes {
            carriers.entry(*node).or_default().push(location);
        }
    }
    (0..mesh.positions().len() as u32)
        .into_par_iter()
        .map(|node| {
            let mut rows: Vec<u32> =
                incidence.of(node as usize).iter().flat_map(|(e, _)| mesh.elements()[*e as usize]).collect();
            for location in carriers.get(&node).into_iter().flatten() {
                rows.extend(&location.nodes);
            }
            rows.sort_unstable();
            rows.dedup();
            rows.shrink_to_fit();
            rows
        })
        .collect()
}

/// The pattern over degrees of freedom: a 3×3 block for each pair of coupled nodes.
fn pattern(neighbours: &[Vec<u32>]) -> Result<SymbolicSparseColMat<usize>, AssemblyError> {
    let n = 3 * neighbours.len();
    let mut col_ptr = Vec::with_capacity(n + 1);
    let mut row_idx = memory::with_capacity(MATRICES, 9 * neighbours.iter().map(Vec::len).sum::<usize>())?;
    col_ptr.push(0);
    for rows in neighbours {
        for _axis in 0..3 {
            for row in rows {
                let first = 3 * *row as usize;
                row_idx.extend([first, first + 1, first + 2]);
            }
            col_ptr.push(row_idx.len());
        }
    }
    Ok(SymbolicSparseColMat::new_checked(n, n, col_ptr, None, row_idx))
}

/// The values of each node's three columns.
fn split_columns<'a>(mut values: &'a mut [f64], neighbours: &[Vec<u32>]) -> Vec<&'a mut [f64]> {
    neighbours
        .iter()
        .map(|rows| {
            let (column, rest) = std::mem::take(&mut values).split_at_mut(9 * rows.len());
            values = rest;
            column
        })
        .collect()
}

/// Where a coupled node stands in the sorted list of its neighbour's rows.
fn place_of(rows: &[u32], row: u32) -> usize {
    rows.partition_point(|r| *r < row)
}

/// Adds the blocks `K_ab = ∫ λ ∇N_a ∇N_bᵀ + μ ∇N_b ∇N_aᵀ + μ (∇N_a·∇N_b) I dV` of column b for all rows a.
fn add_stiffness(
    column: &mut [f64],
    rows: usize,
    places: &[usize; 10],
    points: &[IntegrationPoint],
    material: &Material,
    b: usize,
) {
    let (lambda, mu) = material.lame();
    for (a, place) in places.iter().enumerate() {
        let mut block = [[0.0; 3]; 3];
        for point in points {
            let (ga, gb) = (&point.gradients[a], &point.gradients[b]);
            let dot = mu * point.volume * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
            let (l, m) = (lambda * point.volume, mu * point.volume);
            for i in 0..3 {
                for j in 0..3 {
                    block[j][i] += l * (ga[i] * gb[j]) + m * (gb[i] * ga[j]);
                }
                block[i][i] += dot;
            }
        }
        for (j, block_column) in block.iter().enumerate() {
            for (i, value) in block_column.iter().enumerate() {
                column[3 * (j * rows + place) + i] += value;
            }
        }
    }
}

/// Adds `value · I₃` at a row's place.
fn add_scalar(column: &mut [f64], rows: usize, place: usize, value: f64) {
    for axis in 0..3 {
        column[3 * (axis * rows + place) + axis] += value;
    }
}

/// Adds `m w wᵀ ⊗ I₃`.
fn add_point_mass(
    mass: &mut [f64],
    pattern: &SymbolicSparseColMat<usize>,
    neighbours: &[Vec<u32>],
    m: f64,
    location: &Location,
) {
    for (column_node, w_column) in location.nodes.iter().zip(&location.weights) {
        let rows = &neighbours[*column_node as usize];
        let start = pattern.col_ptr()[3 * *column_node as usize];
        let column = &mut mass[start..start + 9 * rows.len()];
        for (row_node, w_row) in location.nodes.iter().zip(&location.weights) {
            add_scalar(column, rows.len(), place_of(rows, *row_node), m * (w_row * w_column));
        }
    }
}

/// ∫ N_a N_b over an element.
struct MassProducts {
    /// N_a N_b at the points of the degree-5 rule.
    at_points: Vec<[[f64; 10]; 10]>,
    /// ∫ N_a N_b over a straight element of volume one.
    straight: [[f64; 10]; 10],
}

impl MassProducts {
    fn new() -> Self {
        let rule = quadrature::degree_5();
        let at_points: Vec<_> = rule
            .iter()
            .map(|p| {
                let n = shape_functions(p.at);
                n.map(|na| n.map(|nb| na * nb))
            })
            .collect();
        let mut straight = [[0.0; 10]; 10];
        for (p, products) in rule.iter().zip(&at_points) {
            for a in 0..10 {
                for b in 0..10 {
                    straight[a][b] += 6.0 * p.weight * products[a][b];
                }
            }
        }
        Self { at_points, straight }
    }

    fn integral(&self, points: &[IntegrationPoint], a: usize, b: usize) -> f64 {
        if points.len() == self.at_points.len() {
            points.iter().zip(&self.at_points).map(|(point, products)| point.volume * products[a][b]).sum()
        } else {
            points.iter().map(|point| point.volume).sum::<f64>() * self.straight[a][b]
        }
    }
}
