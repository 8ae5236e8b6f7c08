//! The factor of a symmetric matrix that need not be definite, and the number of its negative eigenvalues.
//!
//! `P A Pᵀ = L B Lᵀ` by supernodes, with pivots of one or two rows that are chosen within each supernode (Bunch and
//! Kaufman). By Sylvester's law, A has as many negative eigenvalues as the pivots B have.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::lblt::factor::LbltParams;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::error::ModalError;
use crate::factor::ordering::nested_dissection_of_nodes;
use crate::factor::symbolic::failed;
use crate::matrix::node_pairs::NodePairs;

/// Purpose of the memory, in messages.
const FACTOR: &str = "the factor of a stiffness that need not be definite";

/// An order of the unknowns of symmetric matrices with 3×3 blocks, and the pattern of their factors.
pub struct IndefiniteOrder {
    start: Vec<usize>,
    nodes: Vec<u32>,
    lower: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
}

/// A factor. Degrees of freedom that are held have rows and columns of the unit matrix.
pub struct IndefiniteFactor<'a> {
    order: &'a IndefiniteOrder,
    values: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    held: Vec<bool>,
}

impl IndefiniteOrder {
    /// Pairs of coupled nodes: where the nodes that each node is coupled to begin (n + 1), and these in rising order.
    ///
    /// # Errors
    /// [`ModalError`] for lists that are no pattern, or too large ones.
    pub fn new(start: &[usize], nodes: &[u32]) -> Result<Self, ModalError> {
        let pairs = NodePairs::new(start, nodes)?;
        let order = nested_dissection_of_nodes(&pairs)?.perm(3);
        let lower = pairs.lower(3);
        // Without supernodes there are no pivots to choose.
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let ordering = SymmetricOrdering::Custom(order.as_ref());
        let symbolic = factorize_symbolic_cholesky(lower.as_ref(), Side::Lower, ordering, params)
            .map_err(|reason| failed(lower.ncols(), reason))?;
        Ok(Self { start: start.to_vec(), nodes: nodes.to_vec(), lower, symbolic })
    }

    /// Unknowns, those that are held among them.
    pub fn unknowns(&self) -> usize {
        self.lower.ncols()
    }

    /// Entries of a factor.
    pub fn entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// The factor of a matrix whose entries go column by column: of each node the columns of its three axes, in each the rows
    /// of the three axes of each of the nodes that it is coupled to. `held` are the degrees of freedom that do not move (3n).
    ///
    /// # Errors
    /// [`ModalError::Length`]; memory; [`ModalError::Factorization`] where a pivot is zero or no number.
    pub fn factor(&self, by_nodes: &[f64], held: &[bool]) -> Result<IndefiniteFactor<'_>, ModalError> {
        let size = self.unknowns();
        for (what, found, expected) in [
            ("the entries of the matrix", by_nodes.len(), 9 * self.nodes.len()),
            ("the list of held degrees of freedom", held.len(), size),
        ] {
            if found != expected {
                return Err(ModalError::Length { what, found, expected });
            }
        }
        let entries = self.lower_entries(by_nodes, held);
        let matrix = SparseColMatRef::new(self.lower.as_ref(), &entries[..]);
        let (par, params) = (Par::Seq, Spec::<LbltParams, f64>::default());
        let scratch = self.symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(par, params);
        memory::check(FACTOR, 8 * self.symbolic.len_val() + scratch.unaligned_bytes_required())?;
        let mut values = memory::zeros(FACTOR, self.symbolic.len_val())?;
        let mut subdiagonal = vec![0.0; size];
        let (mut forward, mut inverse) = (vec![0; size], vec![0; size]);
        let mut buffer = MemBuffer::new(scratch);
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut values,
            &mut subdiagonal,
            &mut forward,
            &mut inverse,
            matrix,
            Side::Lower,
            par,
            MemStack::new(&mut buffer),
            params,
        );
        let factor = IndefiniteFactor { order: self, values, subdiagonal, forward, inverse, held: held.to_vec() };
        if factor.pivots().any(|pivot| pivot.iter().any(|number| !number.is_finite())) {
            let reason = "a pivot is zero or no number".to_owned();
            return Err(ModalError::Factorization { size, reason });
        }
        Ok(factor)
    }

    /// The entries on and below the diagonal, with the rows and columns of held degrees of freedom as in the unit matrix.
    fn lower_entries(&self, by_nodes: &[f64], held: &[bool]) -> Vec<f64> {
        let mut entries = Vec::with_capacity(self.lower.row_idx().len());
        for node in 0..self.start.len() - 1 {
            let range = self.start[node]..self.start[node + 1];
            let (nodes, count) = (&self.nodes[range.clone()], range.len());
            let first = nodes.partition_point(|other| (*other as usize) < node);
            for axis in 0..3 {
                let column = 3 * node + axis;
                for (place, other) in nodes.iter().enumerate().skip(first) {
                    let block = 9 * range.start + 3 * (axis * count + place);
                    for (i, value) in by_nodes[block..block + 3].iter().enumerate() {
                        let row = 3 * *other as usize + i;
                        if row >= column {
                            let stays = !(held[row] || held[column]);
                            entries.push(if stays { *value } else { f64::from(u8::from(row == column)) });
                        }
                    }
                }
            }
        }
        entries
    }
}

impl IndefiniteFactor<'_> {
    /// Replaces forces (3n×k) by A⁻¹ of them; held degrees of freedom get zero.
    ///
    /// # Errors
    /// Memory.
    pub fn solve_in_place(&self, mut x: MatMut<'_, f64>) -> Result<(), ModalError> {
        for column in x.as_mut().col_iter_mut() {
            for (value, held) in column.iter_mut().zip(&self.held) {
                if *held {
                    *value = 0.0;
                }
            }
        }
        let symbolic = &self.order.symbolic;
        // The two lists are inverse to each other.
        let pivots = PermRef::new_checked(&self.forward, &self.inverse, self.forward.len());
        let factor = IntranodeLbltRef::new(symbolic, &self.values, &self.subdiagonal, pivots);
        let scratch = symbolic.solve_in_place_scratch::<f64>(x.ncols(), Par::Seq);
        memory::check(FACTOR, scratch.unaligned_bytes_required())?;
        let mut buffer = MemBuffer::new(scratch);
        factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut buffer));
        Ok(())
    }

    /// Number of negative eigenvalues of A.
    pub fn negative_pivots(&self) -> usize {
        let negative = |[a, b, c]: [f64; 3]| {
            // Of a pivot of one row, b and c are 0 and 1.
            let determinant = a * c - b * b;
            if determinant < 0.0 {
                1
            } else if a < 0.0 {
                2
            } else {
                0
            }
        };
        self.pivots().map(negative).sum()
    }

    /// Pivots of two rows as [a, b, c] of [[a, b], [b, c]]; those of one row with b = 0 and c = 1.
    fn pivots(&self) -> impl Iterator<Item = [f64; 3]> {
        let SymbolicCholeskyRaw::Supernodal(supernodes) = self.order.symbolic.raw() else {
            return Vec::new().into_iter();
        };
        let mut pivots = Vec::with_capacity(self.subdiagonal.len());
        for s in 0..supernodes.n_supernodes() {
            let (begin, end) = (supernodes.supernode_begin()[s], supernodes.supernode_end()[s]);
            let width = end - begin;
            let values = &self.values[supernodes.col_ptr_for_val()[s]..supernodes.col_ptr_for_val()[s + 1]];
            let height = values.len() / width.max(1);
            let diagonal = |k: usize| values[k * height + k];
            let mut k = 0;
            while k < width {
                let below = self.subdiagonal[begin + k];
                if below == 0.0 || k + 1 == width {
                    pivots.push([diagonal(k), 0.0, 1.0]);
                    k += 1;
                } else {
                    pivots.push([diagonal(k), below, diagonal(k + 1)]);
                    k += 2;
                }
            }
        }
        pivots.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    /// A chain of nodes, each coupled to the next two, with a block that depends on both; `shift` off its diagonal.
    fn chain(count: usize, shift: f64) -> (Vec<usize>, Vec<u32>, Vec<f64>, Mat<f64>) {
        let (mut start, mut nodes) = (vec![0], Vec::new());
        for node in 0..count {
            nodes.extend((node.saturating_sub(2)..(node + 3).min(count)).map(|other| other as u32));
            start.push(nodes.len());
        }
        let entry = |row: usize, column: usize| {
            let (low, high) = (row.min(column), row.max(column));
            if row == column { 6.0 + (row % 5) as f64 - shift } else { ((3 * low + 7 * high) as f64).sin() }
        };
        let is_coupled = |row: usize, column: usize| (row / 3).abs_diff(column / 3) <= 2;
        let dense = Mat::from_fn(3 * count, 3 * count, |i, j| if is_coupled(i, j) { entry(i, j) } else { 0.0 });
        let mut values = Vec::new();
        for node in 0..count {
            for axis in 0..3 {
                for other in &nodes[start[node]..start[node + 1]] {
                    values.extend((0..3).map(|i| dense[(3 * *other as usize + i, 3 * node + axis)]));
                }
            }
        }
        (start, nodes, values, dense)
    }

    /// Independent reference: the eigenvalues of the same matrix by faer's dense solver.
    #[test]
    fn negative_pivots_are_as_many_as_negative_eigenvalues_and_solutions_fit() {
        for shift in [-20.0, 0.0, 3.0, 6.5, 8.0, 30.0] {
            let (start, nodes, values, mut dense) = chain(40, shift);
            let mut held = vec![false; 120];
            for row in [0, 1, 57] {
                held[row] = true;
                for other in 0..120 {
                    dense[(row, other)] = 0.0;
                    dense[(other, row)] = 0.0;
                }
                dense[(row, row)] = 1.0;
            }
            let order = IndefiniteOrder::new(&start, &nodes).unwrap();
            let factor = order.factor(&values, &held).unwrap();
            let eigenvalues = dense.self_adjoint_eigenvalues(Side::Lower).unwrap();
            let negative = eigenvalues.iter().filter(|value| **value < 0.0).count();
            assert_eq!(factor.negative_pivots(), negative, "{shift}");
            let expected = Mat::from_fn(120, 2, |i, j| if held[i] { 0.0 } else { ((i + 3 * j) as f64).cos() });
            let mut x = &dense * &expected;
            factor.solve_in_place(x.as_mut()).unwrap();
            assert!((x - expected).norm_max() < 1e-10);
        }
    }

    #[test]
    fn a_matrix_of_zeros_and_one_of_another_size_are_refused() {
        let (start, nodes, values, _) = chain(10, 0.0);
        let order = IndefiniteOrder::new(&start, &nodes).unwrap();
        assert!(order.factor(&vec![0.0; values.len()], &[false; 30]).is_err());
        assert!(order.factor(&values[1..], &[false; 30]).is_err());
    }
}
