//! Displacements to second order in the modes: what makes every load stiffen the body.
//!
//! ```text
//! u = Ψ q + u₂        u₂ = −½ Σ_d d (qᵀ K_d q)        ∂u₂/∂q = −Σ_d d (K_d q)ᵀ
//! ```
//!
//! d are directions in body axes, and K_d the geometric stiffness of the static answer to a unit load in that direction.
//! By reciprocity that is the displacement of second order at the load, in that direction: a load that does its work on u
//! stiffens the body by its own stress, and energy and momentum stay closed.

use std::sync::Arc;

use faer::{Mat, MatRef};
use nalgebra::Vector3;

use crate::column_major::{columns, dot};
use crate::error::SetupError;
use crate::physics::check_unit;

/// How a point moves, or a place turns, to second order in the modes.
#[derive(Debug, Clone)]
pub struct SecondOrder {
    terms: Arc<[Term]>,
    modes: usize,
}

/// One direction.
#[derive(Debug)]
struct Term {
    direction: Vector3<f64>,
    /// K_d, column by column (nf × nf).
    stiffness: Vec<f64>,
}

impl SecondOrder {
    /// By the geometric stiffness in the modes (nf×nf, symmetric) of unit loads in orthogonal directions of the body: all
    /// three, or those that the load comes to have.
    ///
    /// # Errors
    /// [`SetupError`] for matrices that are not square or differ in size, numbers that are not finite, and directions that
    /// are no unit vectors.
    pub fn new(terms: Vec<(Vector3<f64>, Mat<f64>)>) -> Result<Self, SetupError> {
        let modes = terms.first().map_or(0, |(_, stiffness)| stiffness.nrows());
        for (direction, stiffness) in &terms {
            for found in [stiffness.nrows(), stiffness.ncols()] {
                if found != modes {
                    let what = "a row or column of the geometric stiffness of a load";
                    return Err(SetupError::Length { what, expected: modes, found });
                }
            }
            check_unit("the length of a direction of the geometric stiffness", direction)?;
            if let Some(found) = stiffness.col_iter().flat_map(|c| c.iter()).copied().find(|k| !k.is_finite()) {
                let what = "the geometric stiffness of a load";
                return Err(SetupError::Value { what, found, expected: "a finite number" });
            }
        }
        let term = |(direction, stiffness): (Vector3<f64>, Mat<f64>)| Term {
            direction,
            stiffness: columns(stiffness.as_ref()),
        };
        Ok(Self { terms: terms.into_iter().map(term).collect(), modes })
    }

    /// Number of flexible modes.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// Entries of the matrices.
    pub(crate) fn entries(&self) -> usize {
        self.terms.len() * self.modes * self.modes
    }

    /// The same in the first `modes` modes only.
    pub(crate) fn truncated(&self, modes: usize) -> Self {
        let modes = modes.min(self.modes);
        let leading = |term: &Term| Term {
            direction: term.direction,
            stiffness: columns(
                MatRef::from_column_major_slice(&term.stiffness, self.modes, self.modes).get(..modes, ..modes),
            ),
        };
        Self { terms: self.terms.iter().map(leading).collect(), modes }
    }

    /// u₂.
    pub(crate) fn displacement(&self, q: &[f64]) -> Vector3<f64> {
        self.of(q, |k_q| 0.5 * dot(k_q, q))
    }

    /// Its rate.
    pub(crate) fn velocity(&self, q: &[f64], velocity: &[f64]) -> Vector3<f64> {
        self.of(q, |k_q| dot(k_q, velocity))
    }

    fn of(&self, q: &[f64], value: impl Fn(&[f64]) -> f64) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for Term { direction, stiffness } in self.terms.iter() {
            // Symmetric, so that a column is a row: Σ_l q_l value(K_l) is the value of K q.
            let along: f64 =
                stiffness.chunks_exact(self.modes.max(1)).zip(q).map(|(column, q)| q * value(column)).sum();
            sum -= direction * along;
        }
        sum
    }

    /// Adds the modal force `(∂u₂/∂q)ᵀ vector`. Returns u₂ and the power of that force.
    pub(crate) fn push(
        &self,
        vector: &Vector3<f64>,
        q: &[f64],
        velocity: &[f64],
        modal_force: &mut [f64],
    ) -> (Vector3<f64>, f64) {
        let (mut displacement, mut power) = (Vector3::zeros(), 0.0);
        for Term { direction, stiffness } in self.terms.iter() {
            let along = direction.dot(vector);
            let mut bent = 0.0;
            for (l, column) in stiffness.chunks_exact(self.modes.max(1)).enumerate().take(q.len()) {
                let k_q = dot(column, q);
                modal_force[l] -= along * k_q;
                power -= along * k_q * velocity[l];
                bent += k_q * q[l];
            }
            displacement -= direction * (0.5 * bent);
        }
        (displacement, power)
    }
}
