//! A = K + sM in the space that the support allows, factored once.
//!
//! The held rows and columns are taken out of A before it is factored, `L Lᵀ = P A_f Pᵀ`. The few unknowns
//! that they have in common (motions C) are eliminated as a block: with `E = C − A_f⁻¹ A C`, which is
//! A-orthogonal to all displacements of the other rows, `x = A_f⁻¹ b + E (Eᵀ A E)⁻¹ Eᵀ b`.

use std::borrow::Cow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError as PivotError;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky};
use faer::{Accum, Conj, Mat, MatMut, Par, Side, Spec};

use crate::error::ModalError;
use crate::factor::cholesky::NotPositive;
use crate::factor::interleave::interleave;
use crate::factor::shifted_matrix::ShiftedMatrix;
use crate::factor::symbolic::{Supernodal, Symbolic, failed};
use crate::factor::{cholesky, substitution};
use crate::matrix::dense::whitening;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::renumbering::Renumbering;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::memory_estimate::{Forecast, MemoryEstimate, reserve_of_dense_products};
use crate::support::constraints::Constraints;

/// Purpose of the memory, in messages.
const FACTOR: &str = "the factor of K + sM and the search for modes";

/// The factor of K + sM.
pub(crate) struct Shifted {
    /// The constraints of the held degrees of freedom.
    pub constraints: Constraints,
    /// The shift s.
    pub shift: f64,
    symbolic: Symbolic,
    values: Vec<f64>,
    /// E, A-orthonormal.
    extensions: Mat<f64>,
    /// Blocks and columns that were solved for.
    solved: [AtomicUsize; 2],
    /// The memory that it takes.
    pub memory: MemoryEstimate,
    /// Time that it took to choose the shift.
    pub estimate_time: Duration,
    /// Time of the ordering and the symbolic factorisation.
    pub ordering_time: Duration,
    /// Time of the numeric factorisation.
    pub factor_time: Duration,
}

/// K + sM with an order of its unknowns, and with the pattern of the factor.
pub(crate) struct Ordered<'a> {
    matrix: ShiftedMatrix<'a>,
    symbolic: Symbolic,
    time: Duration,
}

impl<'a> Ordered<'a> {
    /// Orders `K + shift·M`.
    pub(crate) fn new(
        stiffness: StiffnessMatrix<'a>,
        mass: &'a MassMatrix<'a>,
        shift: f64,
        constraints: &'a Constraints,
        memory: &MemoryEstimate,
    ) -> Result<Self, ModalError> {
        let started = Instant::now();
        memory::check("ordering K + sM", memory.of_ordering())?;
        let matrix = ShiftedMatrix::new(stiffness, mass, shift, constraints);
        let symbolic = Symbolic::new(&matrix)?;
        Ok(Self { matrix, symbolic, time: started.elapsed() })
    }

    /// Multiplications (each with an addition) that make the factor.
    pub(crate) fn multiplications(&self) -> f64 {
        self.symbolic.multiplications()
    }

    /// Time that it took.
    pub(crate) fn time(&self) -> Duration {
        self.time
    }
}

/// Scratch memory of a solution, which can be used again.
pub(crate) struct SolveScratch {
    dense: substitution::Scratch,
    by_faer: MemBuffer,
}

impl Shifted {
    /// Factors `K + sM`, where there is memory for it and for what `search` says of what comes after. `progress` hears what
    /// the factorisation is going to take.
    pub(crate) fn factor(
        ordered: Ordered<'_>,
        constraints: &Constraints,
        memory: MemoryEstimate,
        search: impl Fn(&MemoryEstimate) -> usize,
        progress: impl FnOnce(Forecast),
    ) -> Result<Self, ModalError> {
        let Ordered { matrix, symbolic, time: ordering_time } = ordered;
        let (size, shift) = (matrix.size(), matrix.shift());
        let motions = constraints.motions();
        let a_motions = matrix.product_with_held(motions.as_ref());
        let threads = if symbolic.is_parted() { rayon::current_num_threads() } else { 1 };
        let (needed, reserve) = match &symbolic {
            Symbolic::Supernodal(Supernodal { supernodes, .. }) => {
                (cholesky::scratch_bytes(supernodes, threads), reserve_of_dense_products(threads))
            }
            Symbolic::Simplicial(symbolic) => {
                let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
                (scratch.unaligned_bytes_required(), 0)
            }
        };
        let memory = memory.with_factor(&symbolic, needed);
        let search = search(&memory);
        memory::check_with_reserve(FACTOR, memory.of_factor(search), reserve)?;
        progress(Forecast::new(&symbolic, memory.peak(search), threads));
        let start = Instant::now();
        let mut values = memory::zeros(FACTOR, symbolic.entries())?;
        make(&matrix, &symbolic, &mut values)?;
        let extensions = Mat::zeros(size, 0);
        let constraints = constraints.clone();
        let estimate_time = Duration::ZERO;
        let mut shifted = Self {
            constraints,
            shift,
            symbolic,
            values,
            extensions,
            solved: Default::default(),
            memory,
            estimate_time,
            ordering_time,
            factor_time: start.elapsed(),
        };
        shifted.extend(motions, a_motions)?;
        shifted.factor_time = start.elapsed();
        Ok(shifted)
    }

    /// Takes in the motions C of the held rows, with their forces A C.
    fn extend(&mut self, motions: Mat<f64>, a_motions: Mat<f64>) -> Result<(), ModalError> {
        if motions.ncols() == 0 {
            return Ok(());
        }
        let mut answers = a_motions.clone();
        self.solve_in_place(answers.as_mut(), &mut self.solve_scratch(motions.ncols())?);
        let extensions = motions - answers;
        let whitening = whitening(&tall::inner(extensions.as_ref(), a_motions.as_ref()))
            .map_err(|_| ModalError::Indefinite { pivot: extensions.nrows(), shift: self.shift })?;
        self.extensions = tall::product(extensions.as_ref(), whitening.as_ref());
        Ok(())
    }

    /// Stored entries of the factor.
    pub(crate) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Blocks and columns that were solved for up to now.
    pub(crate) fn solved(&self) -> [usize; 2] {
        self.solved.each_ref().map(|count| count.load(Ordering::Relaxed))
    }

    /// Scratch memory for [`solve_in_place`](Self::solve_in_place) with up to `columns` columns.
    pub(crate) fn solve_scratch(&self, columns: usize) -> Result<SolveScratch, ModalError> {
        let by_faer = match &self.symbolic {
            Symbolic::Supernodal(Supernodal { supernodes, .. }) => {
                memory::check(FACTOR, 8 * substitution::scratch(supernodes.unknowns(), columns))?;
                StackReq::EMPTY
            }
            Symbolic::Simplicial(symbolic) => symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq),
        };
        Ok(SolveScratch { dense: Default::default(), by_faer: buffer(by_faer)? })
    }

    /// Replaces forces `x` by the displacements (K + sM)⁻¹ x that the support allows.
    pub(crate) fn solve_in_place(&self, x: MatMut<'_, f64>, scratch: &mut SolveScratch) {
        self.in_order_of_nodes().solve_in_place(x, scratch);
    }

    /// The same for vectors of which the rows are those of the nodes, one after the other.
    pub(crate) fn in_order_of_nodes(&self) -> Inverted<'_> {
        Inverted {
            factor: self,
            is_in_own_order: false,
            constraints: Cow::Borrowed(&self.constraints),
            extensions: Cow::Borrowed(&self.extensions),
        }
    }

    /// The same for vectors of which the rows are in the factor's own order, and that order: a search that keeps its vectors so
    /// need not put them into it for each solution. None for a factor without supernodes, whose order is not used
    /// so.
    pub(crate) fn in_own_order(&self) -> Option<(Renumbering, Inverted<'_>)> {
        let Symbolic::Supernodal(Supernodal { order, .. }) = &self.symbolic else { return None };
        // The rows of a node stay together.
        let order = Renumbering::new(order.arrays().0.iter().step_by(3).map(|row| (row / 3) as u32).collect());
        let inverted = Inverted {
            factor: self,
            is_in_own_order: true,
            constraints: Cow::Owned(self.constraints.reordered(&order)),
            extensions: Cow::Owned(order.rows(self.extensions.as_ref())),
        };
        Some((order, inverted))
    }
}

/// (K + sM)⁻¹ in the space that the support allows, for vectors of which the rows are in one of two orders.
pub(crate) struct Inverted<'a> {
    factor: &'a Shifted,
    is_in_own_order: bool,
    /// The constraints of the held degrees of freedom.
    pub constraints: Cow<'a, Constraints>,
    extensions: Cow<'a, Mat<f64>>,
}

impl Inverted<'_> {
    /// Scratch memory for [`solve_in_place`](Self::solve_in_place) with up to `columns` columns.
    pub(crate) fn solve_scratch(&self, columns: usize) -> Result<SolveScratch, ModalError> {
        self.factor.solve_scratch(columns)
    }

    /// Replaces forces `x` by the displacements (K + sM)⁻¹ x that the support allows.
    pub(crate) fn solve_in_place(&self, mut x: MatMut<'_, f64>, scratch: &mut SolveScratch) {
        let Shifted { symbolic, values, solved, .. } = self.factor;
        for (solved, count) in solved.iter().zip([1, x.ncols()]) {
            solved.fetch_add(count, Ordering::Relaxed);
        }
        let extends = self.extensions.ncols() > 0;
        let motions = extends.then(|| tall::inner(self.extensions.as_ref().as_ref(), x.rb()));
        self.constraints.clear(x.rb_mut());
        match symbolic {
            Symbolic::Supernodal(Supernodal { order, supernodes, subtrees }) => {
                let factor = substitution::Factor { supernodes, subtrees, values };
                let order = (!self.is_in_own_order).then(|| order.as_ref());
                substitution::solve(factor, order, x.rb_mut(), &mut scratch.dense);
            }
            Symbolic::Simplicial(symbolic) => LltRef::new(symbolic, values).solve_in_place_with_conj(
                Conj::No,
                x.rb_mut(),
                Par::Seq,
                MemStack::new(&mut scratch.by_faer),
            ),
        }
        if let Some(motions) = motions {
            tall::multiply(x, Accum::Add, self.extensions.as_ref().as_ref(), motions.as_ref(), 1.0);
        }
    }
}

/// Fills the zeros in `values` with the entries of the factor.
fn make(matrix: &ShiftedMatrix<'_>, symbolic: &Symbolic, values: &mut [f64]) -> Result<(), ModalError> {
    match symbolic {
        Symbolic::Supernodal(Supernodal { order, supernodes, subtrees }) => {
            let problem = cholesky::Problem { supernodes, subtrees, order: order.as_ref(), matrix };
            let indefinite = |NotPositive(pivot)| ModalError::Indefinite { pivot, shift: matrix.shift() };
            problem.factor(values).map_err(indefinite)?;
            interleave(supernodes, subtrees, values);
            Ok(())
        }
        Symbolic::Simplicial(symbolic) => make_by_columns(matrix, symbolic, values),
    }
}

/// The same without supernodes.
fn make_by_columns(
    matrix: &ShiftedMatrix<'_>,
    symbolic: &SymbolicCholesky<usize>,
    values: &mut [f64],
) -> Result<(), ModalError> {
    let refused = |reason| failed(symbolic.nrows(), reason);
    let assembled = matrix.pattern().and_then(|pattern| matrix.assembled(&pattern)).map_err(refused)?;
    let (par, spec) = (Par::Seq, Spec::default());
    let mut scratch = buffer(symbolic.factorize_numeric_llt_scratch::<f64>(par, spec))?;
    let (side, regularization, stack) = (Side::Lower, Default::default(), MemStack::new(&mut scratch));
    match symbolic.factorize_numeric_llt(values, assembled.as_ref(), side, regularization, par, stack, Spec::default())
    {
        Ok(_) => Ok(()),
        Err(PivotError::NonPositivePivot { index }) => {
            Err(ModalError::Indefinite { pivot: index, shift: matrix.shift() })
        }
    }
}

fn buffer(needed: StackReq) -> Result<MemBuffer, ModalError> {
    let bytes = needed.unaligned_bytes_required();
    memory::check(FACTOR, bytes)?;
    let left = memory::Left::Unknown;
    Ok(MemBuffer::try_new(needed).map_err(|_| memory::OutOfMemory { what: FACTOR, wanted: bytes, left })?)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::eigen::lanczos::random_block;
    use crate::multigrid::coarse::tests::Block;
    use crate::support::held::Support;
    use reduced_body::RigidMotion;

    /// A block on a hinge: the held rows have an unknown of their own.
    /// Conserved: the same answers in the factor's order and in the order of the nodes.
    #[test]
    fn answers_in_the_factor_s_own_order_are_those_of_the_nodes() {
        let block = Block::new([6, 5, 4]);
        let (stiffness, mass) = (StiffnessMatrix::Nodal(block.stiffness()), MassMatrix::Nodal(block.mass()));
        let held = (0..).zip(block.mesh.positions()).filter(|(_, x)| x[2] < 1e-9).map(|(node, _)| node).collect();
        let hinge = Support::new(RigidMotion::hinge(Vector3::zeros(), Vector3::x()), held);
        let constraints = Constraints::new(&hinge, block.mesh.positions(), 3).unwrap();
        let memory = MemoryEstimate::new(stiffness, &mass, 0, 6);
        let ordered = Ordered::new(stiffness, &mass, 1e8, &constraints, &memory).unwrap();
        let factor = Shifted::factor(ordered, &constraints, memory, |_| 0, |_| ()).unwrap();
        let (order, in_own_order) = factor.in_own_order().expect("a factor with supernodes");
        assert!(factor.extensions.ncols() == 1 && !constraints.is_empty());

        let forces = random_block(3 * block.mesh.positions().len(), 5, &mut 3);
        let mut expected = forces.clone();
        factor.solve_in_place(expected.as_mut(), &mut factor.solve_scratch(5).unwrap());
        let mut found = order.rows(forces.as_ref());
        in_own_order.solve_in_place(found.as_mut(), &mut in_own_order.solve_scratch(5).unwrap());
        assert!((&found - order.rows(expected.as_ref())).norm_max() < 1e-14 * expected.norm_max());

        let mut expected = forces.clone();
        factor.constraints.project(expected.as_mut());
        assert_ne!(expected, forces);
        let mut found = order.rows(forces.as_ref());
        in_own_order.constraints.project(found.as_mut());
        order.restore(&mut found);
        assert!((found - &expected).norm_max() < 1e-14);
    }
}
