//! A = K + sM in the space that the support allows, factored once.
//!
//! The held rows and columns are taken out of A before it is factored, `L Lᵀ = P A_f Pᵀ`. The few unknowns
//! that they have in common (motions C) are eliminated as a block: with `E = C − A_f⁻¹ A C`, which is
//! A-orthogonal to all displacements of the other rows, `x = A_f⁻¹ b + E (Eᵀ A E)⁻¹ Eᵀ b`.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError as PivotError;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky};
use faer::{Accum, Conj, Mat, MatMut, Par, Side, Spec};

use crate::cholesky::NotPositive;
use crate::constraints::Constraints;
use crate::dense::whitening;
use crate::error::ModalError;
use crate::foretold::{Forecast, Foretold, of_dense_products};
use crate::interleave::interleave;
use crate::mass_matrix::MassMatrix;
use crate::shifted_matrix::ShiftedMatrix;
use crate::stiffness::StiffnessMatrix;
use crate::symbolic::{Supernodal, Symbolic, failed};
use crate::{cholesky, substitution, tall};

/// What the memory is for.
const FACTOR: &str = "the factor of K + sM and the search for modes";

/// The factor of K + sM.
pub(crate) struct Shifted {
    /// What the held degrees of freedom may do.
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
    pub memory: Foretold,
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
        memory: &Foretold,
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
        memory: Foretold,
        search: impl Fn(&Foretold) -> usize,
        progress: impl FnOnce(Forecast),
    ) -> Result<Self, ModalError> {
        let Ordered { matrix, symbolic, time: ordering_time } = ordered;
        let (size, shift) = (matrix.size(), matrix.shift());
        let motions = constraints.motions();
        let a_motions = matrix.product_with_held(motions.as_ref());
        let threads = if symbolic.is_parted() { rayon::current_num_threads() } else { 1 };
        let (needed, reserve) = match &symbolic {
            Symbolic::Supernodal(Supernodal { supernodes, .. }) => {
                (cholesky::scratch_bytes(supernodes, threads), of_dense_products(threads))
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
    pub(crate) fn solve_in_place(&self, mut x: MatMut<'_, f64>, scratch: &mut SolveScratch) {
        for (solved, count) in self.solved.iter().zip([1, x.ncols()]) {
            solved.fetch_add(count, Ordering::Relaxed);
        }
        let extends = self.extensions.ncols() > 0;
        let motions = extends.then(|| tall::inner(self.extensions.as_ref(), x.rb()));
        self.constraints.clear(x.rb_mut());
        match &self.symbolic {
            Symbolic::Supernodal(Supernodal { order, supernodes, subtrees }) => {
                let factor = substitution::Factor { supernodes, subtrees, values: &self.values };
                substitution::solve(factor, order.as_ref(), x.rb_mut(), &mut scratch.dense);
            }
            Symbolic::Simplicial(symbolic) => LltRef::new(symbolic, &self.values).solve_in_place_with_conj(
                Conj::No,
                x.rb_mut(),
                Par::Seq,
                MemStack::new(&mut scratch.by_faer),
            ),
        }
        if let Some(motions) = motions {
            tall::multiply(x, Accum::Add, self.extensions.as_ref(), motions.as_ref(), 1.0);
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
