//! Second ways to the eigenvalues: a dense solution, and a count of those below a number.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{CholeskySymbolicParams, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SparseColMatRef};
use faer::{Mat, Par, Side};

/// All eigenvalues of (K, M), smallest first, from the dense matrices.
pub fn dense_eigenvalues(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
) -> Vec<f64> {
    dense_eigenvalues_of(stiffness.to_dense(), mass.to_dense())
}

/// All eigenvalues of a dense (K, M), smallest first.
pub fn dense_eigenvalues_of(stiffness: Mat<f64>, mass: Mat<f64>) -> Vec<f64> {
    let factor = mass.llt(Side::Lower).unwrap();
    let mut half = stiffness;
    let solve = |x: &mut Mat<f64>| {
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(factor.L(), x.as_mut(), Par::Seq);
    };
    solve(&mut half);
    let mut whole = half.transpose().to_owned();
    solve(&mut whole);
    whole.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

/// How many eigenvalues of (K, M) lie below `sigma`: the negative pivots of K − σM (Sylvester's law of inertia).
pub fn count_below(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    sigma: f64,
) -> usize {
    let values: Vec<f64> = stiffness.val().iter().zip(mass.val()).map(|(k, m)| k - sigma * m).collect();
    let shifted = SparseColMat::new(stiffness.symbolic().to_owned().unwrap(), values);
    let symbolic = factorize_symbolic_cholesky(
        shifted.symbolic(),
        Side::Lower,
        SymmetricOrdering::Amd,
        CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        },
    )
    .unwrap();
    let mut factor = vec![0.0; symbolic.len_val()];
    let scratch = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
    symbolic
        .factorize_numeric_ldlt(
            &mut factor,
            shifted.as_ref(),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .unwrap();
    let faer::sparse::linalg::cholesky::SymbolicCholeskyRaw::Simplicial(raw) = symbolic.raw() else { unreachable!() };
    // The pivots are the first entries of the columns.
    raw.col_ptr()[..raw.nrows()].iter().filter(|first| factor[**first] < 0.0).count()
}
