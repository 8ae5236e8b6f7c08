//! How far the manifold of large modes holds.
//!
//! It has the displacement to third order in the large modes, and the strain energy to fifth; with q the large and following modes:
//!
//! ```text
//! V = V₂ + V_n      V₂ = ½ Σ ω_k² q_k²      u = Ψ q + Ψ_ext s(q)
//! e = |V_n|/V₂      μ = 4 |s|²/|q|²         error ≈ 2 e μ
//! ```
//!
//! μ is the squared slope of the manifold, |∂u/∂q|² beyond 1: about the square of the largest angle by which the body is
//! bent. Where the first orders left out are of a size e beside the linear ones, the next are of a size e μ. The factor is that
//! of the elastica: see `docs/evidence/nonlinear.md`.

use dynamics::Manifold;

/// Error of the forces up to which a motion is taken as right.
pub(crate) const STATED: f64 = 0.01;
/// Error of the forces that a motion of fourth order cannot be right at: a run is refused there.
pub(crate) const HOLDS: f64 = 0.25;
/// The factor of e μ.
const OF_ELASTICA: f64 = 2.0;

/// Estimates the next order, without allocating.
#[derive(Debug, Clone)]
pub struct FourthOrder<'a> {
    manifold: &'a Manifold,
    circular_frequencies: &'a [f64],
    xi: Vec<f64>,
}

impl<'a> FourthOrder<'a> {
    /// The estimate for a body with these modes.
    pub fn new(manifold: &'a Manifold, circular_frequencies: &'a [f64]) -> Self {
        Self { manifold, circular_frequencies, xi: vec![0.0; manifold.body().flexible()] }
    }

    /// Relative error of the forces on these modes by the orders left out, about; infinite where the strain energy is negative,
    /// which no body has. `q` are all modal coordinates.
    pub fn error(&mut self, q: &[f64]) -> f64 {
        let Self { manifold, circular_frequencies: omega, xi } = self;
        // Of following modes, too: where the large ones pass through zero, the energy beyond V₂ is theirs.
        let bent = manifold.bent();
        let square: f64 = bent.iter().map(|k| q[*k] * q[*k]).sum();
        let quadratic: f64 = bent.iter().map(|k| 0.5 * (omega[*k] * q[*k]).powi(2)).sum();
        if square == 0.0 {
            return 0.0;
        }
        let beyond = manifold.energy(q);
        if quadratic + beyond < 0.0 {
            return f64::INFINITY;
        }
        manifold.coordinates(q, xi);
        xi.iter_mut().zip(q).for_each(|(xi, q)| *xi -= q);
        let follows: f64 = xi.iter().map(|s| s * s).sum();
        OF_ELASTICA * (beyond.abs() / quadratic) * (4.0 * follows / square)
    }

    /// The modes that are large.
    pub(crate) fn large(&self) -> &[usize] {
        self.manifold.large()
    }
}
