//! From (K, M) and the nodes to vibration modes, checked.

use std::time::{Duration, Instant};

use faer::reborrow::Reborrow;
use faer::sparse::SparseColMatRef;
use faer::{Mat, Side};

use crate::dense::symmetric_eigen;
use crate::error::ModalError;
use crate::lanczos::largest_pairs;
use crate::mass::NodalMass;
use crate::products::symmetric_product;
use crate::rigid::RigidModes;
use crate::shifted::Shifted;
use crate::start::eigenvalue_estimate;
use crate::symmetry::check_symmetric;
use crate::tall;

/// An eigenvalue below this fraction of the shift has no stiffness behind it.
const ZERO_ENERGY: f64 = 1e-9;
/// Components this close to the largest magnitude share it; the first of them gives the sign.
const TIE: f64 = 1e-6;

/// Rigid and flexible modes of a free body. All shapes are M-orthonormal together.
#[derive(Debug, Clone)]
pub struct Modes {
    /// The six rigid modes and the mass properties.
    pub rigid: RigidModes,
    /// λ of the flexible modes, (rad/time)², smallest first.
    pub eigenvalues: Vec<f64>,
    /// Flexible mode shapes (3n×nf), mass-normalised, the component of largest magnitude positive.
    pub shapes: Mat<f64>,
    /// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ for each mode, in the scale of the shifted problem, where rounding is small.
    pub residuals: Vec<f64>,
    /// ‖Kφ − λMφ‖ / ‖Kφ‖ for each mode. Rounding in K leaves up to 1e-6 of this in the lowest modes of fine meshes.
    pub force_residuals: Vec<f64>,
    /// What was done, and where the time went.
    pub stats: SolveStats,
}

/// Counts and times of a solution.
#[derive(Debug, Clone, Copy, Default)]
pub struct SolveStats {
    /// The shift s, (rad/time)².
    pub shift: f64,
    /// Unknowns N.
    pub unknowns: usize,
    /// Entries of the factor of K + sM.
    pub factor_entries: usize,
    /// Solutions with a block of vectors.
    pub block_solves: usize,
    /// Vectors in the Lanczos basis at the end.
    pub basis_size: usize,
    /// Rigid modes, the check of K, and the first guess.
    pub preparation_time: Duration,
    /// Ordering and symbolic factorisation.
    pub ordering_time: Duration,
    /// Numeric factorisation.
    pub factor_time: Duration,
    /// Lanczos.
    pub lanczos_time: Duration,
    /// Rayleigh–Ritz, residuals and signs.
    pub ritz_time: Duration,
}

/// How far a solution has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// K + sM is being ordered and factored.
    Factorizing,
    /// Modes that have converged, of those asked for.
    Lanczos {
        /// Converged.
        converged: usize,
        /// Asked for.
        requested: usize,
    },
}

impl Modes {
    /// Natural frequencies of the flexible modes, cycles per time.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.eigenvalues.iter().map(|lambda| lambda.sqrt() / std::f64::consts::TAU).collect()
    }
}

/// The six rigid and the `flexible` lowest other modes of `K φ = λ M φ`.
///
/// `stiffness` and `mass` are N×N with both triangles stored, N = 3n, degrees of freedom `3·node + axis`;
/// `positions` are the n nodes. `progress` hears how far it has come.
///
/// # Errors
/// See [`ModalError`].
pub fn solve(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    positions: &[[f64; 3]],
    flexible: usize,
    mut progress: impl FnMut(Progress),
) -> Result<Modes, ModalError> {
    let started = Instant::now();
    check_input(stiffness, mass, positions)?;
    let unknowns = 3 * positions.len();
    let (rows, values) = (stiffness.symbolic().row_idx(), stiffness.val());
    check_symmetric("stiffness", 1, stiffness.symbolic().col_ptr(), |entry| rows[entry], |entry| values[entry])?;
    let nodal_mass = NodalMass::new(mass)?;
    let available = (3 * nodal_mass.massive_count()).saturating_sub(6);
    if flexible > available {
        return Err(ModalError::TooManyModes { requested: flexible, available });
    }
    let rigid = RigidModes::new(&nodal_mass, positions)?;
    rigid.check_free(stiffness)?;
    let mut stats = SolveStats { unknowns, ..SolveStats::default() };
    if flexible == 0 {
        stats.preparation_time = started.elapsed();
        let none = Vec::new;
        let shapes = Mat::zeros(unknowns, 0);
        return Ok(Modes { rigid, eigenvalues: none(), shapes, residuals: none(), force_residuals: none(), stats });
    }
    stats.shift = eigenvalue_estimate(stiffness, &nodal_mass, positions, &rigid)?;
    stats.preparation_time = started.elapsed();

    progress(Progress::Factorizing);
    let operator = Shifted::factor(stiffness, mass, stats.shift)?;
    stats.ordering_time = operator.ordering_time;
    stats.factor_time = operator.factor_time;
    stats.factor_entries = operator.entries();

    let started = Instant::now();
    let pairs = largest_pairs(&operator, &nodal_mass, rigid.shapes.as_ref(), flexible, available, |converged| {
        progress(Progress::Lanczos { converged, requested: flexible });
    })?;
    drop(operator);
    stats.block_solves = pairs.block_solves;
    stats.basis_size = pairs.basis_size;
    stats.lanczos_time = started.elapsed();

    let started = Instant::now();
    let RitzPairs { eigenvalues, mut shapes, force_residuals } = rayleigh_ritz(stiffness, &nodal_mass, &pairs.vectors)?;
    refuse_mechanism(&eigenvalues, &shapes, positions, stats.shift)?;
    fix_signs(&mut shapes);
    stats.ritz_time = started.elapsed();
    Ok(Modes { rigid, eigenvalues, shapes, residuals: pairs.residuals, force_residuals, stats })
}

fn check_input(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: SparseColMatRef<'_, usize, f64>,
    positions: &[[f64; 3]],
) -> Result<(), ModalError> {
    let expected = 3 * positions.len();
    for (what, matrix) in [("stiffness", stiffness), ("mass", mass)] {
        for found in [matrix.nrows(), matrix.ncols()] {
            if found != expected || found == 0 {
                return Err(ModalError::Size { what, expected, found });
            }
        }
        if let Some(index) = (0..matrix.ncols()).find(|j| matrix.val_of_col(*j).iter().any(|v| !v.is_finite())) {
            let value = matrix.val_of_col(index).iter().copied().find(|v| !v.is_finite()).unwrap_or(f64::NAN);
            return Err(ModalError::NotFinite { what, index, value });
        }
    }
    match positions.iter().enumerate().find_map(|(i, x)| x.iter().find(|c| !c.is_finite()).map(|c| (i, *c))) {
        Some((index, value)) => Err(ModalError::NotFinite { what: "positions", index, value }),
        None => Ok(()),
    }
}

/// Eigenpairs by Rayleigh–Ritz.
struct RitzPairs {
    eigenvalues: Vec<f64>,
    /// M-orthonormal.
    shapes: Mat<f64>,
    /// ‖Kφ − λMφ‖ / ‖Kφ‖.
    force_residuals: Vec<f64>,
}

/// Rayleigh–Ritz of (K, M) on the span of `vectors`.
fn rayleigh_ritz(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: &NodalMass,
    vectors: &Mat<f64>,
) -> Result<RitzPairs, ModalError> {
    let m_vectors = mass.product(vectors.as_ref());
    let k_vectors = symmetric_product(stiffness, vectors.as_ref());
    let gram = tall::inner(vectors.as_ref(), m_vectors.as_ref());
    // Cholesky of the Gram matrix turns the pencil into an ordinary problem: C = L⁻¹ (VᵀKV) L⁻ᵀ.
    let factor = gram.llt(Side::Lower).map_err(|_| ModalError::DenseEigen { size: gram.nrows() })?;
    let mut whitening = Mat::identity(gram.nrows(), gram.nrows());
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(
        factor.L().transpose(),
        whitening.as_mut(),
        faer::Par::Seq,
    );
    let projected = whitening.transpose() * tall::inner(vectors.as_ref(), k_vectors.as_ref()) * &whitening;
    let (eigenvalues, vectors_of_projected) = symmetric_eigen(&projected)?;
    let transform = &whitening * vectors_of_projected;

    let k_shapes = tall::product(k_vectors.as_ref(), transform.as_ref());
    let m_shapes = tall::product(m_vectors.as_ref(), transform.as_ref());
    let force_residuals = eigenvalues
        .iter()
        .enumerate()
        .map(|(k, lambda)| {
            (k_shapes.col(k) - m_shapes.col(k) * faer::Scale(*lambda)).norm_l2() / k_shapes.col(k).norm_l2()
        })
        .collect();
    let shapes = tall::product(vectors.as_ref(), transform.as_ref());
    Ok(RitzPairs { eigenvalues, shapes, force_residuals })
}

fn refuse_mechanism(
    eigenvalues: &[f64],
    shapes: &Mat<f64>,
    positions: &[[f64; 3]],
    shift: f64,
) -> Result<(), ModalError> {
    let count = eigenvalues.iter().take_while(|lambda| **lambda < ZERO_ENERGY * shift).count();
    if count == 0 {
        return Ok(());
    }
    let squared = |node: usize| (0..3).map(|axis| shapes[(3 * node + axis, 0)].powi(2)).sum::<f64>();
    let node = (0..positions.len()).max_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap_or(0);
    Err(ModalError::Mechanism { count, eigenvalue: eigenvalues[0], shift, node, position: positions[node] })
}

/// Turns each shape so that its component of largest magnitude is positive. Where symmetry makes several components
/// equal in magnitude, rounding must not choose among them: the first one counts.
fn fix_signs(shapes: &mut Mat<f64>) {
    for shape in shapes.col_iter_mut() {
        let largest = shape.norm_max();
        let leading = shape.rb().iter().copied().find(|c| c.abs() >= (1.0 - TIE) * largest).unwrap_or(0.0);
        if leading < 0.0 {
            shape.iter_mut().for_each(|c| *c = -*c);
        }
    }
}
