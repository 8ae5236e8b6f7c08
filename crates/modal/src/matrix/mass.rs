//! The mass matrix as a matrix over nodes: `M = M_s ⊗ I₃`.

use std::borrow::Cow;

use faer::sparse::{SparseColMatRef, Triplet};
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use crate::error::ModalError;
use crate::input::check_matrix;
use crate::matrix::node_pairs::NodePairs;
use crate::matrix::products::{Packed, nodal_product};
use crate::matrix::symmetry::check_symmetric;

/// An entry that differs from those of the other axes by more than this, relative to the diagonals, is no rounding.
const ISOTROPY: f64 = 1e-12;

/// The scalar mass matrix over nodes, of which the mass matrix is three copies, one for each axis.
///
/// Solid elements and point masses give such a mass; it is a ninth of the stored entries of M.
#[derive(Debug, Clone)]
pub struct NodalMass<'a> {
    start: Cow<'a, [usize]>,
    nodes: Cow<'a, [u32]>,
    values: Cow<'a, [f64]>,
}

impl<'a> NodalMass<'a> {
    /// `M_s` in compressed columns: `nodes[start[j]..start[j + 1]]` are the nodes that node j is coupled to, itself too, in
    /// rising order, and `values` their entries.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::Unsorted`] and [`ModalError::NoNode`] where the lists do not fit together;
    /// [`ModalError::NotFinite`], [`ModalError::NotSymmetric`].
    pub fn of_nodes(start: &'a [usize], nodes: &'a [u32], values: &'a [f64]) -> Result<Self, ModalError> {
        NodePairs::new(start, nodes)?;
        if values.len() != nodes.len() {
            let what = "the entries of the mass matrix over nodes";
            return Err(ModalError::Length { what, found: values.len(), expected: nodes.len() });
        }
        if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
            let index = 3 * (start.partition_point(|first| *first <= entry) - 1);
            return Err(ModalError::NotFinite { what: "mass", place: "column", index, value: values[entry] });
        }
        check_symmetric("mass", 3, start, |entry| nodes[entry] as usize, |entry| values[entry])?;
        Ok(Self { start: start.into(), nodes: nodes.into(), values: values.into() })
    }

    /// The mass of lists that are known to fit together.
    pub(crate) fn of_checked_nodes(start: &'a [usize], nodes: &'a [u32], values: &'a [f64]) -> Self {
        Self { start: start.into(), nodes: nodes.into(), values: values.into() }
    }

    /// Takes `M_s` out of M (3n×3n, both triangles stored).
    ///
    /// # Errors
    /// [`ModalError::Size`] where M is not square with three rows for each node, [`ModalError::NotFinite`],
    /// [`ModalError::AnisotropicMass`] where M is not `M_s ⊗ I₃`, [`ModalError::NotSymmetric`] where M_s is not symmetric.
    pub fn new(mass: SparseColMatRef<'_, usize, f64>) -> Result<Self, ModalError> {
        check_matrix("mass", mass, mass.ncols().next_multiple_of(3))?;
        Self::of_checked(mass)
    }

    /// The same where size and numbers are checked.
    pub(crate) fn of_checked(mass: SparseColMatRef<'_, usize, f64>) -> Result<Self, ModalError> {
        let n = mass.ncols() / 3;
        // A column of each node, which grows by doubling, and then all of them in one.
        memory::check("the mass matrix over nodes", 48 * mass.row_idx().len() / 9)?;
        let entry = |row: usize, column: usize| mass.get(row, column).copied().unwrap_or(0.0);
        let diagonal: Vec<f64> = (0..n).map(|node| entry(3 * node, 3 * node)).collect();
        let columns: Vec<Vec<(u32, f64)>> = (0..n)
            .into_par_iter()
            .map(|node| {
                let mut column: Vec<(u32, f64)> = Vec::new();
                for axis in 0..3 {
                    let j = 3 * node + axis;
                    let mut found = 0;
                    for (i, value) in mass.row_idx_of_col(j).zip(mass.val_of_col(j)) {
                        let scale = (diagonal[i / 3] * diagonal[node]).abs().sqrt();
                        let refuse = || ModalError::AnisotropicMass { row: i, column: j, value: *value };
                        if i % 3 != axis {
                            if value.abs() > ISOTROPY * scale {
                                return Err(refuse());
                            }
                        } else if axis == 0 {
                            if *value != 0.0 {
                                column.push(((i / 3) as u32, *value));
                            }
                        } else if *value != 0.0 {
                            match column.get(found) {
                                Some((row, first))
                                    if *row as usize == i / 3 && (value - first).abs() <= ISOTROPY * scale => {}
                                _ => return Err(refuse()),
                            }
                            found += 1;
                        }
                    }
                    if axis > 0 && found != column.len() {
                        let (row, value) = column[found];
                        return Err(ModalError::AnisotropicMass { row: 3 * row as usize, column: 3 * node, value });
                    }
                }
                Ok(column)
            })
            .collect::<Result<_, _>>()?;
        let mut start = Vec::with_capacity(n + 1);
        start.push(0);
        let (mut nodes, mut values) = (Vec::new(), Vec::new());
        for column in columns {
            nodes.extend(column.iter().map(|(row, _)| *row));
            values.extend(column.iter().map(|(_, value)| *value));
            start.push(nodes.len());
        }
        check_symmetric("mass", 3, &start, |entry| nodes[entry] as usize, |entry| values[entry])?;
        Ok(Self { start: start.into(), nodes: nodes.into(), values: values.into() })
    }

    /// M·X for X with 3n rows.
    pub fn product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut y = Mat::zeros(x.nrows(), x.ncols());
        self.product_into(x, y.as_mut(), &mut Vec::new());
        y
    }

    /// Y = M·X for X with 3n rows; `packed` is scratch that can be used again.
    pub(crate) fn product_into(&self, x: MatRef<'_, f64>, y: MatMut<'_, f64>, packed: &mut Vec<Packed>) {
        nodal_product(&self.start, &self.nodes, &self.values, x, y, packed);
    }

    /// Sums over the columns: the mass that each node stands for (n).
    pub fn row_sums(&self) -> Vec<f64> {
        self.start.windows(2).map(|range| self.values[range[0]..range[1]].iter().sum()).collect()
    }

    /// The entries of M_s.
    pub(crate) fn entries(&self) -> impl Iterator<Item = Triplet<usize, usize, f64>> {
        let columns = self.start.windows(2).enumerate();
        columns
            .flat_map(move |(column, range)| {
                (range[0]..range[1]).map(move |entry| (self.nodes[entry] as usize, column, self.values[entry]))
            })
            .map(|(row, column, value)| Triplet::new(row, column, value))
    }

    /// The same with nodes of these masses after the others, that nothing couples.
    pub(crate) fn with_nodes(&self, masses: &[f64]) -> NodalMass<'static> {
        let (first, entries) = (self.node_count() as u32, self.nodes.len());
        let start = self.start.iter().copied().chain(entries + 1..=entries + masses.len()).collect::<Vec<_>>();
        let nodes = self.nodes.iter().copied().chain(first..first + masses.len() as u32).collect::<Vec<_>>();
        let values = self.values.iter().chain(masses).copied().collect::<Vec<_>>();
        NodalMass { start: start.into(), nodes: nodes.into(), values: values.into() }
    }

    /// True if a node has a mass at all.
    pub(crate) fn is_massive(&self, node: usize) -> bool {
        self.values[self.start[node]..self.start[node + 1]].iter().any(|value| *value != 0.0)
    }

    /// The pairs of nodes that have an entry.
    pub(crate) fn pairs(&self) -> NodePairs<'_> {
        NodePairs { start: &self.start, nodes: &self.nodes }
    }

    /// Their entries.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The nodes that a node is coupled to, and the entries.
    #[inline(always)]
    pub(crate) fn column(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[node]..self.start[node + 1];
        self.nodes[range.clone()].iter().zip(&self.values[range]).map(|(node, value)| (*node as usize, *value))
    }

    /// Number of nodes n.
    pub(crate) fn node_count(&self) -> usize {
        self.start.len() - 1
    }
}
