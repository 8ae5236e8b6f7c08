//! The stiffness by the stress of the spin, by what it acts on.

use faer::Mat;

use crate::conservative::manifold::Manifold;

/// The K_ij of [`ReducedBody::PAIRS`](reduced_body::ReducedBody::PAIRS) on the modal coordinates (nf × nf), of a manifold, too: what
/// only follows is without it.
pub(crate) struct SpinStiffness([Mat<f64>; 6]);

impl SpinStiffness {
    pub fn new(stiffness: &[Mat<f64>; 6], manifold: Option<&Manifold>) -> Self {
        let Some(manifold) = manifold else { return Self(stiffness.clone()) };
        let modes = manifold.modes();
        Self(stiffness.each_ref().map(|k| k.get(..modes, ..modes).to_owned()))
    }

    pub fn of_pairs(&self) -> &[Mat<f64>; 6] {
        &self.0
    }
}
