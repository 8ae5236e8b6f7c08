//! Shapes of second order: what large modes draw in, twist and stretch.
//!
//! ```text
//! Θ_jk = −K⁻¹ g_jk,   g_jk = ∂²f_int/∂q_j∂q_k at rest        u = Ψ q + ½ Σ Θ_jk q_j q_k
//! Ψ_ext = [Ψ, H]      T_jk = −K_ee⁻¹ (Ψ_eᵀ g_jk)
//! ```
//!
//! H are M-orthonormal vectors of what the Θ have beside the modes Ψ. In the extended shapes, Θ_jk without its parts along
//! the large modes, which is a choice of what their coordinates mean, is T_jk; e are all extended shapes but the large
//! modes.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};

use crate::error::ModalError;
use crate::input::{check_finite_columns, check_rows};
use crate::matrix::tall;
use crate::memory_estimate::of_vectors;
use crate::solve::{Modes, Solver};

/// Smallest part of a static response beside the modes with which it is added: less is rounding.
const DEPENDENT: f64 = 1e-6;

/// The shapes that follow large modes, and what the strain energy has of third and fourth order.
#[derive(Debug, Clone)]
pub struct SecondOrderShapes {
    /// The modes, then the shapes that only follow; K-orthogonality is lost.
    pub modes: Modes,
    /// Number of shapes that are coordinates of the motion.
    pub dynamic: usize,
    /// The large ones among them, numbered from 0, ascending.
    pub large: Vec<usize>,
    /// T (extended shapes × pairs of large modes), zero along the large modes.
    pub slopes: Mat<f64>,
    /// Φ_i·g_jk (large modes × pairs), force.
    pub cubic: Mat<f64>,
    /// T_ijᵀ K_ee T_kl (pairs × pairs): energy that the shapes that follow relieve.
    pub relief: Mat<f64>,
}

impl SecondOrderShapes {
    /// The pairs (j ≤ k) of `count` large modes, in the order of all lists here.
    pub fn pairs(count: usize) -> Vec<[usize; 2]> {
        (0..count).flat_map(|j| (j..count).map(move |k| [j, k])).collect()
    }
}

impl Solver<'_> {
    /// The shapes that follow the `large` ones of `modes`, which are numbered from 0 and ascend. `forces` are the g_jk
    /// (N×pairs) of [`SecondOrderShapes::pairs`], `fem_tet10::second_order_forces`, and `answers` the
    /// [`static_response`](Self::static_response) to them.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::LargeModes`];
    /// [`ModalError::Memory`], [`ModalError::NotPositiveDefinite`] and [`ModalError::DenseEigen`] where the numbers
    /// cannot be had.
    pub fn second_order_shapes(
        &self,
        modes: Modes,
        large: &[usize],
        forces: MatRef<'_, f64>,
        answers: MatRef<'_, f64>,
    ) -> Result<SecondOrderShapes, ModalError> {
        let (size, dynamic) = (modes.shapes.nrows(), modes.shapes.ncols());
        let pairs = SecondOrderShapes::pairs(large.len());
        for (what, vectors) in [("forces of second order", forces), ("the answers to them", answers)] {
            if vectors.ncols() != pairs.len() {
                return Err(ModalError::Length { what, expected: pairs.len(), found: vectors.ncols() });
            }
            check_rows(what, vectors.nrows(), size)?;
            check_finite_columns(what, vectors)?;
        }
        if !(large.is_sorted_by(|a, b| a < b) && large.last().is_none_or(|last| *last < dynamic)) {
            return Err(ModalError::LargeModes { found: large.to_vec(), count: dynamic });
        }
        memory::check("shapes of second order", of_vectors(size, 3 * (dynamic + pairs.len())))?;
        let follow = self.beside(&modes, answers, DEPENDENT)?;
        let extended = dynamic + follow.ncols();
        let shapes = tall::side_by_side(modes.shapes.as_ref(), follow.as_ref());
        // The modes and static shapes are Rayleigh–Ritz vectors.
        let stiff = tall::inner(shapes.as_ref(), self.stiffness.product(follow.as_ref()).as_ref());
        let stiffness = |i: usize, j: usize| match (i.min(j), i.max(j)) {
            (_, column) if column < dynamic => {
                if i == j {
                    modes.eigenvalues[i]
                } else {
                    0.0
                }
            }
            (row, column) if row < dynamic => stiff[(row, column - dynamic)],
            (row, column) => 0.5 * (stiff[(row, column - dynamic)] + stiff[(column, row - dynamic)]),
        };
        let along = tall::inner(shapes.as_ref(), forces);
        let others: Vec<usize> = (0..extended).filter(|a| !large.contains(a)).collect();
        let (k, g) = (
            Mat::from_fn(others.len(), others.len(), |i, j| stiffness(others[i], others[j])),
            Mat::from_fn(others.len(), pairs.len(), |i, j| along[(others[i], j)]),
        );
        let factor = k
            .llt(Side::Lower)
            .map_err(|_| ModalError::NotPositiveDefinite { matrix: "stiffness", size: others.len() })?;
        let answer = factor.solve(&g);
        let mut slopes = Mat::zeros(extended, pairs.len());
        for (i, a) in others.iter().enumerate() {
            for j in 0..pairs.len() {
                slopes[(*a, j)] = -answer[(i, j)];
            }
        }
        let of_follow: Vec<f64> = (dynamic..extended).map(|a| stiffness(a, a)).collect();
        let mut modes = modes;
        modes.eigenvalues.extend(of_follow);
        modes.shapes = shapes;
        Ok(SecondOrderShapes {
            modes,
            dynamic,
            large: large.to_vec(),
            cubic: Mat::from_fn(large.len(), pairs.len(), |i, j| along[(large[i], j)]),
            relief: answer.transpose() * g,
            slopes,
        })
    }
}
