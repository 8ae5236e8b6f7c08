//! Consistent mass and stiffness over pairs of coupled nodes, filled column by column.
//!
//! Each column of nodes gathers from the elements around its node, always in the same order. So no two threads
//! write to one place, and the sums do not depend on how many threads there are.

use std::ops::Range;
use std::sync::OnceLock;

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use rayon::prelude::*;

use crate::assembly::coupling::{Coupling, Incidence, parts};
use crate::assembly::point_mass::PointMass;
use crate::element::columns::{ElementPoints, MassProducts};
use crate::element::integration::Rules;
use crate::element::vectorized::vectorized;
use crate::error::AssemblyError;
use crate::material::Materials;
use crate::mesh::checked::Mesh;
use crate::mesh::locate::Location;

/// Purpose of the memory, in messages.
const MATRICES: &str = "the mass and stiffness matrices";

/// Stiffness and mass matrices (N×N, N = 3n), both triangles stored: a 3×3 block of K and a scalar of M for each pair of
/// coupled nodes.
#[derive(Debug, Clone)]
pub struct Matrices {
    coupling: Coupling,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    /// Made where they are asked for.
    pattern: OnceLock<SymbolicSparseColMat<usize>>,
    expanded_mass: OnceLock<Vec<f64>>,
}

impl Matrices {
    /// The same mass with another stiffness, whose entries are in the order of [`stiffness_by_nodes`](Self::stiffness_by_nodes),
    /// such as that of a deformed body ([`crate::FiniteStrain::stiffness`]).
    ///
    /// # Panics
    /// Where there are not as many entries.
    #[must_use]
    pub fn with_stiffness(&self, stiffness: Vec<f64>) -> Self {
        assert_eq!(stiffness.len(), self.stiffness.len(), "an entry for each of the stiffness");
        Self { stiffness, ..self.clone() }
    }

    /// K (N×N), force per length. Its pattern is made at the first call.
    pub fn stiffness(&self) -> SparseColMatRef<'_, usize, f64> {
        SparseColMatRef::new(self.pattern().as_ref(), &self.stiffness)
    }

    /// M (N×N): the consistent mass matrix with the point masses in it, in the pattern of K. It is made at the first call.
    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        let expanded = self.expanded_mass.get_or_init(|| {
            let mut values = vec![0.0; self.stiffness.len()];
            for node in 0..self.coupling.start.len() - 1 {
                let pairs = self.coupling.start[node]..self.coupling.start[node + 1];
                let column = &mut values[9 * pairs.start..9 * pairs.end];
                for (place, value) in self.mass[pairs.clone()].iter().enumerate() {
                    for axis in 0..3 {
                        column[3 * (axis * pairs.len() + place) + axis] = *value;
                    }
                }
            }
            values
        });
        SparseColMatRef::new(self.pattern().as_ref(), expanded)
    }

    /// Where the nodes that each node is coupled to begin in [`nodes`](Self::nodes) (n + 1).
    pub fn start(&self) -> &[usize] {
        &self.coupling.start
    }

    /// The nodes that each node is coupled to, itself too, in rising order.
    pub fn nodes(&self) -> &[u32] {
        &self.coupling.nodes
    }

    /// The entries of K column by column: of each node the columns of its three axes, in each the rows of the three axes of
    /// each of the nodes that it is coupled to.
    pub fn stiffness_by_nodes(&self) -> &[f64] {
        &self.stiffness
    }

    /// The entries of M_s, a scalar for each pair of nodes: `M = M_s ⊗ I₃`.
    pub fn mass_by_nodes(&self) -> &[f64] {
        &self.mass
    }

    /// Memory held for the matrices over nodes, in bytes: 84 for each pair of nodes (an index, ten values) and 8 for each node.
    pub fn bytes(&self) -> usize {
        4 * self.coupling.nodes.len() + 8 * (self.coupling.start.len() + self.stiffness.len() + self.mass.len())
    }

    /// The pattern over degrees of freedom: a 3×3 block for each pair of coupled nodes.
    fn pattern(&self) -> &SymbolicSparseColMat<usize> {
        self.pattern.get_or_init(|| {
            let size = 3 * (self.coupling.start.len() - 1);
            let (mut start, mut rows) = (Vec::with_capacity(size + 1), Vec::with_capacity(self.stiffness.len()));
            start.push(0);
            for node in 0..size / 3 {
                for _axis in 0..3 {
                    for row in self.coupling.of(node) {
                        let first = 3 * *row as usize;
                        rows.extend([first, first + 1, first + 2]);
                    }
                    start.push(rows.len());
                }
            }
            SymbolicSparseColMat::new_checked(size, size, start, None, rows)
        })
    }
}

/// Assembles K and M, Eqs. (M2), (M3) of `docs/method/modes.md`.
///
/// While it works it holds, besides the matrices, about 1.2 kB for each straight element and 4.1 kB for each curved one.
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
    let coupling = Coupling::new(mesh, &incidence, &carried);
    let pairs = coupling.nodes.len();
    memory::check(MATRICES, 80 * pairs + ElementPoints::BYTES * mesh.elements().len())?;
    let mut stiffness = memory::zeros(MATRICES, 9 * pairs)?;
    let mut mass = memory::zeros(MATRICES, pairs)?;

    let points = ElementPoints::new(mesh, &Rules::new());
    let products = MassProducts::new();
    let nodes = mesh.positions().len();
    let fill = |places: &mut Vec<u32>, (part, mut stiffness, mut mass): Part<'_>| {
        places.resize(nodes, 0);
        for node in part {
            let rows = coupling.of(node);
            let (k_column, rest) = std::mem::take(&mut stiffness).split_at_mut(9 * rows.len());
            let (m_column, rest_of_mass) = std::mem::take(&mut mass).split_at_mut(rows.len());
            (stiffness, mass) = (rest, rest_of_mass);
            for (place, row) in (0..).zip(rows) {
                places[*row as usize] = place;
            }
            vectorized(
                #[inline(always)]
                || {
                    for &(element, b) in incidence.of(node) {
                        let (element, b) = (element as usize, b as usize);
                        let places = mesh.elements()[element].map(|row| places[row as usize] as usize);
                        let material = &materials[element];
                        let blocks = points.stiffness(element, material, b);
                        for (blocks, column) in blocks.iter().zip(k_column.chunks_exact_mut(3 * rows.len())) {
                            let column = column.as_chunks_mut::<3>().0;
                            for (a, place) in places.iter().enumerate() {
                                for (value, row) in column[*place].iter_mut().zip(blocks) {
                                    *value += row[a];
                                }
                            }
                        }
                        for (place, value) in places.iter().zip(points.mass(element, material, &products, b)) {
                            m_column[*place] += value;
                        }
                    }
                },
            );
        }
    };
    split(&coupling, &mut stiffness, &mut mass).into_par_iter().for_each_init(Vec::new, fill);
    for (m, location) in &carried {
        add_point_mass(&mut mass, &coupling, *m, location);
    }
    Ok(Matrices { coupling, stiffness, mass, pattern: OnceLock::new(), expanded_mass: OnceLock::new() })
}

/// Some nodes, and their columns of K and M.
type Part<'a> = (Range<usize>, &'a mut [f64], &'a mut [f64]);

/// The columns by parts of the nodes.
fn split<'a>(coupling: &Coupling, mut stiffness: &'a mut [f64], mut mass: &'a mut [f64]) -> Vec<Part<'a>> {
    let with_columns = |part: Range<usize>| {
        let pairs = coupling.start[part.end] - coupling.start[part.start];
        let (own, rest) = std::mem::take(&mut stiffness).split_at_mut(9 * pairs);
        let (own_mass, rest_of_mass) = std::mem::take(&mut mass).split_at_mut(pairs);
        (stiffness, mass) = (rest, rest_of_mass);
        (part, own, own_mass)
    };
    parts(coupling.start.len() - 1).into_iter().map(with_columns).collect()
}

/// Adds `m w wᵀ`.
fn add_point_mass(mass: &mut [f64], coupling: &Coupling, m: f64, location: &Location) {
    for (column, w_column) in location.nodes.iter().zip(&location.weights) {
        let (rows, first) = (coupling.of(*column as usize), coupling.start[*column as usize]);
        for (row, w_row) in location.nodes.iter().zip(&location.weights) {
            mass[first + rows.partition_point(|other| other < row)] += m * (w_row * w_column);
        }
    }
}
