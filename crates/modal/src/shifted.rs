//! K + sM, factored once: `L Lᵀ = P (K + sM) Pᵀ`.

use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError as PivotError;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMat, SparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::error::ModalError;
use crate::ordering::nested_dissection;

/// The factor of K + sM.
pub(crate) struct Shifted {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    par: Par,
    /// Time of the ordering and the symbolic factorisation.
    pub ordering_time: Duration,
    /// Time of the numeric factorisation.
    pub factor_time: Duration,
}

impl Shifted {
    /// Orders and factors `K + shift·M`.
    pub(crate) fn factor(
        stiffness: SparseColMatRef<'_, usize, f64>,
        mass: SparseColMatRef<'_, usize, f64>,
        shift: f64,
    ) -> Result<Self, ModalError> {
        let start = Instant::now();
        let par = parallelism();
        let size = stiffness.ncols();
        let shifted = sum(stiffness, mass, shift).map_err(|reason| failed(size, reason))?;
        let ordering = nested_dissection(shifted.symbolic())?;
        let symbolic = factorize_symbolic_cholesky(
            shifted.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(ordering.as_ref()),
            CholeskySymbolicParams::default(),
        )
        .map_err(|reason| failed(size, reason))?;
        let ordering_time = start.elapsed();

        let start = Instant::now();
        let mut values = vec![0.0; symbolic.len_val()];
        let mut memory = MemBuffer::try_new(symbolic.factorize_numeric_llt_scratch::<f64>(par, Spec::default()))
            .map_err(|_| failed(size, "no memory left"))?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                shifted.as_ref(),
                Side::Lower,
                Default::default(),
                par,
                MemStack::new(&mut memory),
                Spec::default(),
            )
            .map_err(|PivotError::NonPositivePivot { index }| ModalError::Indefinite { pivot: index, shift })?;
        Ok(Self { symbolic, values, par, ordering_time, factor_time: start.elapsed() })
    }

    /// Stored entries of the factor.
    pub(crate) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Scratch memory for [`solve_in_place`](Self::solve_in_place) with up to `columns` columns.
    pub(crate) fn solve_scratch(&self, columns: usize) -> Result<MemBuffer, ModalError> {
        MemBuffer::try_new(self.symbolic.solve_in_place_scratch::<f64>(columns, self.par))
            .map_err(|_| failed(self.symbolic.ncols(), "no memory left"))
    }

    /// Replaces `x` by (K + sM)⁻¹ x.
    pub(crate) fn solve_in_place(&self, x: MatMut<'_, f64>, scratch: &mut MemBuffer) {
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            self.par,
            MemStack::new(scratch),
        );
    }
}

/// faer's parallelism on the rayon pool that the caller runs in.
fn parallelism() -> Par {
    if rayon::current_num_threads() == 1 { Par::Seq } else { Par::rayon(0) }
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

fn failed(size: usize, reason: impl std::fmt::Display) -> ModalError {
    ModalError::Factorization { size, reason: reason.to_string() }
}
