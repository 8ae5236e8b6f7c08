//! A = K + sM in the space that the support allows, factored once.
//!
//! The held rows and columns are taken out of A before it is factored, `L Lᵀ = P A_f Pᵀ`. The few unknowns
//! that they have in common (motions C) are eliminated as a block: with `E = C − A_f⁻¹ A C`, which is
//! A-orthogonal to all displacements of the other rows, `x = A_f⁻¹ b + E (Eᵀ A E)⁻¹ Eᵀ b`.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError as PivotError;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMat, SparseColMatRef};
use faer::{Accum, Conj, Mat, MatMut, Par, Side, Spec};

use crate::constraints::Constraints;
use crate::dense::whitening;
use crate::error::ModalError;
use crate::foretold::{Forecast, Foretold, of_dense_products};
use crate::ordering::nested_dissection;
use crate::products::symmetric_product;
use crate::subtrees::Subtrees;
use crate::{substitution, tall};

/// What the memory is for.
const FACTOR: &str = "the factor of K + sM and the search for modes";
/// Entries of a factor that is small.
const SMALL: usize = 500_000;

/// The factor of K + sM.
pub(crate) struct Shifted {
    /// What the held degrees of freedom may do.
    pub constraints: Constraints,
    /// The shift s.
    pub shift: f64,
    symbolic: SymbolicCholesky<usize>,
    subtrees: Option<Subtrees>,
    values: Vec<f64>,
    /// E, A-orthonormal.
    extensions: Mat<f64>,
    /// Blocks and columns that were solved for.
    solved: [AtomicUsize; 2],
    par: Par,
    /// The memory that it takes.
    pub memory: Foretold,
    /// Time that it took to choose the shift.
    pub estimate_time: Duration,
    /// Time of the ordering and the symbolic factorisation.
    pub ordering_time: Duration,
    /// Time of the numeric factorisation.
    pub factor_time: Duration,
}

/// Scratch memory of a solution, which can be used again.
pub(crate) struct SolveScratch {
    dense: substitution::Scratch,
    by_faer: MemBuffer,
}

impl Shifted {
    /// Orders and factors `K + shift·M`, where there is memory for it and for what `search` says of what comes after.
    /// `progress` hears what the factorisation is going to take.
    pub(crate) fn factor(
        stiffness: SparseColMatRef<'_, usize, f64>,
        mass: SparseColMatRef<'_, usize, f64>,
        shift: f64,
        constraints: &Constraints,
        search: impl Fn(&Foretold) -> usize,
        progress: impl FnOnce(Forecast),
    ) -> Result<Self, ModalError> {
        let start = Instant::now();
        let size = stiffness.ncols();
        let memory = Foretold::new(stiffness, mass, 6);
        memory::check("ordering K + sM", memory.of_ordering())?;
        let mut shifted = sum(stiffness, mass, shift).map_err(|reason| failed(size, reason))?;
        let motions = constraints.motions();
        let a_motions = symmetric_product(shifted.as_ref(), motions.as_ref());
        if !constraints.is_empty() {
            hold_out(&mut shifted, constraints);
        }
        let ordering = nested_dissection(shifted.symbolic())?;
        let symbolic = factorize_symbolic_cholesky(
            shifted.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(ordering.as_ref()),
            CholeskySymbolicParams::default(),
        )
        .map_err(|reason| failed(size, reason))?;
        let subtrees = match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(factor) => Some(Subtrees::new(factor)),
            SymbolicCholeskyRaw::Simplicial(_) => None,
        };
        let ordering_time = start.elapsed();

        let par = parallelism(&symbolic);
        let needed = symbolic.factorize_numeric_llt_scratch::<f64>(par, Spec::default());
        let memory = memory.with_factor(&symbolic, needed.unaligned_bytes_required());
        let is_dense = matches!(symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_));
        let reserve = if is_dense { of_dense_products(par.degree()) } else { 0 };
        let search = search(&memory);
        memory::check_with_reserve(FACTOR, memory.of_factor(search), reserve)?;
        progress(Forecast::new(&symbolic, memory.peak(search), par));
        let start = Instant::now();
        let mut values = memory::zeros(FACTOR, symbolic.len_val())?;
        let mut scratch = buffer(needed)?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                shifted.as_ref(),
                Side::Lower,
                Default::default(),
                par,
                MemStack::new(&mut scratch),
                Spec::default(),
            )
            .map_err(|PivotError::NonPositivePivot { index }| ModalError::Indefinite { pivot: index, shift })?;
        drop(scratch);
        let extensions = Mat::zeros(size, 0);
        let constraints = constraints.clone();
        let estimate_time = Duration::ZERO;
        let mut shifted = Self {
            constraints,
            shift,
            symbolic,
            subtrees,
            values,
            extensions,
            solved: Default::default(),
            par,
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
            .map_err(|_| ModalError::Indefinite { pivot: self.symbolic.ncols(), shift: self.shift })?;
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
        let by_faer = match self.dense_columns() {
            Some(_) => {
                memory::check(FACTOR, 8 * substitution::scratch(self.symbolic.nrows(), columns))?;
                StackReq::EMPTY
            }
            None => self.symbolic.solve_in_place_scratch::<f64>(columns, self.par),
        };
        Ok(SolveScratch { dense: Default::default(), by_faer: buffer(by_faer)? })
    }

    /// The factor where it has dense columns, its parts, and its order; a small one has none.
    fn dense_columns(&self) -> Option<(SupernodalLltRef<'_, usize, f64>, &Subtrees, PermRef<'_, usize>)> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::new(symbolic, &self.values);
                Some((factor, self.subtrees.as_ref()?, self.symbolic.perm()?))
            }
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Replaces forces `x` by the displacements (K + sM)⁻¹ x that the support allows.
    pub(crate) fn solve_in_place(&self, mut x: MatMut<'_, f64>, scratch: &mut SolveScratch) {
        for (solved, count) in self.solved.iter().zip([1, x.ncols()]) {
            solved.fetch_add(count, Ordering::Relaxed);
        }
        let extends = self.extensions.ncols() > 0;
        let motions = extends.then(|| tall::inner(self.extensions.as_ref(), x.rb()));
        self.constraints.clear(x.rb_mut());
        match self.dense_columns() {
            Some((factor, subtrees, order)) => {
                substitution::solve(factor, subtrees, order, x.rb_mut(), &mut scratch.dense)
            }
            None => LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
                Conj::No,
                x.rb_mut(),
                self.par,
                MemStack::new(&mut scratch.by_faer),
            ),
        }
        if let Some(motions) = motions {
            tall::multiply(x, Accum::Add, self.extensions.as_ref(), motions.as_ref(), 1.0);
        }
    }
}

/// Replaces held rows and columns by those of the identity.
fn hold_out(matrix: &mut SparseColMat<usize, f64>, constraints: &Constraints) {
    let (symbolic, values) = matrix.parts_mut();
    for column in 0..symbolic.ncols() {
        let column_is_held = constraints.holds(column);
        for entry in symbolic.col_range(column) {
            let row = symbolic.row_idx()[entry];
            if column_is_held || constraints.holds(row) {
                values[entry] = if row == column { 1.0 } else { 0.0 };
            }
        }
    }
}

/// faer's parallelism on the rayon pool that the caller runs in. A small factor is made by one thread, which is as fast
/// and takes the scratch of one.
fn parallelism(symbolic: &SymbolicCholesky<usize>) -> Par {
    if rayon::current_num_threads() == 1 || symbolic.len_val() < SMALL { Par::Seq } else { Par::rayon(0) }
}

fn buffer(needed: StackReq) -> Result<MemBuffer, ModalError> {
    let bytes = needed.unaligned_bytes_required();
    memory::check(FACTOR, bytes)?;
    let left = memory::Left::Unknown;
    Ok(MemBuffer::try_new(needed).map_err(|_| memory::OutOfMemory { what: FACTOR, wanted: bytes, left })?)
}

/// K + shift·M, on the pattern of both; zeros that are stored stay stored.
fn sum(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    shift: f64,
) -> Result<SparseColMat<usize, f64>, FaerError> {
    let same_pattern = stiffness.col_ptr() == mass.col_ptr() && stiffness.row_idx() == mass.row_idx();
    if same_pattern {
        let values = stiffness.val().iter().zip(mass.val()).map(|(k, m)| k + shift * m).collect();
        return Ok(SparseColMat::new(stiffness.symbolic().to_owned()?, values));
    }
    faer::sparse::ops::binary_op(stiffness, mass, |k, m| k.copied().unwrap_or(0.0) + shift * m.copied().unwrap_or(0.0))
}

fn failed(size: usize, reason: FaerError) -> ModalError {
    match reason {
        FaerError::OutOfMemory => {
            // At least a row and a value of each column were asked for.
            memory::OutOfMemory { what: FACTOR, wanted: 16 * size, left: memory::Left::Unknown }.into()
        }
        other => ModalError::Factorization { size, reason: other.to_string() },
    }
}
