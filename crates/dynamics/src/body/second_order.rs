//! Displacements to second order in the modes: what makes every load stiffen the body.
//!
//! ```text
//! u = Ψ q + u₂        u₂ = −½ Σ_d d (qᵀ K_d q)        ∂u₂/∂q = −Σ_d d (K_d q)ᵀ
//! ```
//!
//! d are directions in body axes, and K_d the geometric stiffness of the static response to a unit load in that direction.
//! By reciprocity that is the displacement of second order at the load, in that direction: a load that does its work on u
//! stiffens the body by its own stress, and energy and momentum stay closed.

use std::sync::Arc;

use faer::Mat;
use keys::{Key, Keyed};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::body::physics::check_unit;
use crate::error::SetupError;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::lists::dot;

/// How a point moves, or a place turns, to second order in the modes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(into = "Vec<Direction>", try_from = "Vec<Direction>")]
pub struct SecondOrder {
    terms: Arc<[Term]>,
    modes: usize,
}

/// One direction.
#[derive(Debug)]
struct Term {
    direction: Vector3<f64>,
    /// K_d (nf × nf).
    stiffness: Mat<f64>,
    /// The same, ready for products.
    blocked: BlockedMatrix,
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
        Ok(Self { terms: terms.into_iter().map(Term::new).collect(), modes })
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
        let leading = |term: &Term| Term::new((term.direction, term.stiffness.get(..modes, ..modes).to_owned()));
        Self { terms: self.terms.iter().map(leading).collect(), modes }
    }

    /// Adds factor × Σ_d (d · vector) K_d, the stiffness against a load along `vector`, to the leading entries of a matrix.
    pub(crate) fn add_stiffness(&self, factor: f64, vector: &Vector3<f64>, mut to: faer::MatMut<'_, f64>) {
        let modes = to.nrows().min(self.modes);
        for Term { direction, stiffness, .. } in self.terms.iter() {
            let along = factor * direction.dot(vector);
            for (i, j) in (0..modes).flat_map(|j| (0..modes).map(move |i| (i, j))) {
                to[(i, j)] += along * stiffness[(i, j)];
            }
        }
    }

    /// The columns of ∂u₂/∂q, added to those of a displacement.
    pub(crate) fn add_slopes(&self, q: &[f64], columns: &mut [Vector3<f64>]) {
        for Term { direction, stiffness, .. } in self.terms.iter() {
            for (i, column) in columns.iter_mut().enumerate().take(self.modes) {
                let k_q: f64 = q.iter().enumerate().map(|(j, q)| stiffness[(i, j)] * q).sum();
                *column -= direction * k_q;
            }
        }
    }

    /// u₂.
    pub(crate) fn displacement(&self, q: &[f64]) -> Vector3<f64> {
        self.of(q, q) * 0.5
    }

    /// Its rate.
    pub(crate) fn velocity(&self, q: &[f64], velocity: &[f64]) -> Vector3<f64> {
        self.of(q, velocity)
    }

    /// −Σ_d d (xᵀ K_d q)
    fn of(&self, q: &[f64], x: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for Term { direction, blocked, .. } in self.terms.iter() {
            blocked.each_block(q, |first, k_q| sum -= direction * dot(k_q, &x[first.min(q.len())..]));
        }
        sum
    }

    /// Adds the modal force `(∂u₂/∂q)ᵀ vector`.
    pub(crate) fn add_force(&self, vector: &Vector3<f64>, q: &[f64], modal_force: &mut [f64]) {
        for Term { direction, blocked, .. } in self.terms.iter() {
            let along = direction.dot(vector);
            if along != 0.0 {
                blocked.each_block(q, |first, k_q| {
                    let first = first.min(q.len());
                    modal_force[first..q.len()].iter_mut().zip(k_q).for_each(|(force, k_q)| *force -= along * k_q);
                });
            }
        }
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
        for Term { direction, blocked, .. } in self.terms.iter() {
            let along = direction.dot(vector);
            let mut bent = 0.0;
            blocked.each_block(q, |first, k_q| {
                // The load may know more modes than the run has.
                let first = first.min(q.len());
                modal_force[first..q.len()].iter_mut().zip(k_q).for_each(|(force, k_q)| *force -= along * k_q);
                power -= along * dot(k_q, &velocity[first..]);
                bent += dot(k_q, &q[first..]);
            });
            displacement -= direction * (0.5 * bent);
        }
        (displacement, power)
    }
}

impl Term {
    fn new((direction, stiffness): (Vector3<f64>, Mat<f64>)) -> Self {
        Self { direction, blocked: BlockedMatrix::new(stiffness.as_ref()), stiffness }
    }
}

/// A direction and K_d, as serde has them.
#[derive(Serialize, Deserialize)]
struct Direction(Vector3<f64>, #[serde(with = "reduced_body::as_data")] Mat<f64>);

impl From<SecondOrder> for Vec<Direction> {
    fn from(second_order: SecondOrder) -> Self {
        second_order.terms.iter().map(|term| Direction(term.direction, term.stiffness.clone())).collect()
    }
}

impl TryFrom<Vec<Direction>> for SecondOrder {
    type Error = SetupError;

    fn try_from(terms: Vec<Direction>) -> Result<Self, SetupError> {
        Self::new(terms.into_iter().map(|Direction(direction, stiffness)| (direction, stiffness)).collect())
    }
}

impl Keyed for SecondOrder {
    fn key(&self, key: Key) -> Key {
        self.terms.iter().fold(key.of("second order", 1).with("terms", &self.terms.len()), |key, term| {
            key.with("direction", &term.direction).with("stiffness", &term.stiffness)
        })
    }
}
