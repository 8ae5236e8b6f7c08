//! The rest of a body under steady forces and a steady spin, by Newton's iteration with the stress as an unknown of its own.
//!
//! ```text
//! start  u = 0,  S = C:ε(u_m),  u_m = K⁻¹ (all forces)         in equilibrium, hence right
//! K* e = f(u) + M W (X + u) − f_int(u),    S ← C:(E(u) + B(u)e),    u ← u + e
//! ```
//!
//! Newton's iteration on displacements alone takes ten to thirty factors on a slender body, or fails: the membrane stress of
//! displacements that are still wrong enters its tangent. (G. Magisano, L. Leonetti, G. Garcea, "How to improve efficiency
//! and robustness of the Newton method in geometrically non-linear structural problem discretized via displacement-based
//! finite elements", 2017.)

use fem_tet10::Stresses;
use nalgebra::Vector3;

use crate::body::FullBody;
use crate::error::NonlinearError;
use crate::followers::change;
use crate::forces::ExternalForces;
use crate::tangent::{Tangent, TangentTerms};
use crate::vectors::{add, peak, sum};

/// How an equilibrium is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquilibriumSettings {
    /// The largest change of the displacement of a node that ends the iteration, over the largest displacement.
    pub tolerance: f64,
    /// Most factors for one step of the load.
    pub max_factors: usize,
    /// Steps of the load and of the square of the spin that are tried in turn, until one of them leads to an end.
    pub steps: &'static [usize],
}

impl Default for EquilibriumSettings {
    fn default() -> Self {
        Self { tolerance: 1e-10, max_factors: 20, steps: &[1, 4, 16] }
    }
}

/// A rest.
pub struct Equilibrium {
    /// Displacements (3n).
    pub displacement: Vec<f64>,
    /// The stress there.
    pub stresses: Stresses,
    /// Factors that were made.
    pub factors: usize,
    /// [`Tangent::negative_pivots`] there: without any, and without forces that follow the displacements, the rest is stable.
    pub negative_pivots: usize,
}

/// The rest of a body under `forces` and the spin `omega_body` about its origin, near the one that a start leads to: from
/// zero displacements, or from those of `start`.
///
/// # Errors
/// [`NonlinearError::NoEquilibrium`]; errors of the factors.
pub fn equilibrium(
    body: &FullBody<'_>,
    forces: &ExternalForces,
    omega_body: &Vector3<f64>,
    start: Option<&[f64]>,
    settings: &EquilibriumSettings,
) -> Result<Equilibrium, NonlinearError> {
    let mut failed = NonlinearError::NoEquilibrium { steps: 0, left: f64::INFINITY };
    for steps in settings.steps {
        match in_steps(body, forces, omega_body, start, *steps, settings) {
            Ok(found) => return Ok(found),
            Err(error @ (NonlinearError::NoEquilibrium { .. } | NonlinearError::NotFinite { .. })) => failed = error,
            Err(error) => return Err(error),
        }
        if start.is_some() {
            break;
        }
    }
    Err(failed)
}

fn in_steps(
    body: &FullBody<'_>,
    forces: &ExternalForces,
    omega_body: &Vector3<f64>,
    start: Option<&[f64]>,
    steps: usize,
    settings: &EquilibriumSettings,
) -> Result<Equilibrium, NonlinearError> {
    let rest = vec![0.0; body.dofs()];
    let mut u = start.map_or_else(|| rest.clone(), <[f64]>::to_vec);
    let mut stresses = None;
    let mut factors = 0;
    for step in 1..=steps {
        let part = step as f64 / steps as f64;
        let omega = omega_body * part.sqrt();
        let forces = forces.scaled(part);
        let all = |u: &[f64]| -> Result<Vec<f64>, NonlinearError> {
            Ok(sum(&forces.at(body.mesh(), u)?, 1.0, &body.centrifugal(u, &omega)))
        };
        // A stress in equilibrium with the forces, by the linear body.
        if stresses.is_none() {
            let at_rest = body.strain().stresses(&rest);
            let linear = Tangent::new(body, &TangentTerms::spinning(&rest, &at_rest, &Vector3::zeros()))?;
            factors += 1;
            stresses = Some(body.strain().linear_stresses(&linear.answer(&all(&u)?)?));
        }
        let mut last = f64::INFINITY;
        for iteration in 0.. {
            let Some(at) = &stresses else { break };
            let tangent = Tangent::new(body, &TangentTerms::spinning(&u, at, &omega))?;
            factors += 1;
            let residual = sum(&all(&u)?, -1.0, &body.strain().internal_forces(&u));
            let change = change(body, &tangent, &forces, &u, &residual)?;
            stresses = Some(body.strain().linearized_stresses(&u, &change));
            add(&mut u, 1.0, &change);
            let left = peak(&change) / peak(&u).max(f64::MIN_POSITIVE);
            if !left.is_finite() {
                return Err(NonlinearError::NotFinite { what: "a displacement in search of an equilibrium" });
            }
            let is_last = step == steps;
            // On the way it need not be exact; rounding ends the last one, too.
            let tolerance = if is_last { settings.tolerance } else { 1e-3 };
            if left < tolerance || (left < 1e-8 && left > 0.5 * last) {
                if !is_last {
                    break;
                }
                let stresses = body.strain().stresses(&u);
                let negative_pivots = tangent.negative_pivots();
                return Ok(Equilibrium { displacement: u, stresses, factors, negative_pivots });
            }
            if iteration >= settings.max_factors {
                return Err(NonlinearError::NoEquilibrium { steps: factors, left });
            }
            last = left;
        }
    }
    Err(NonlinearError::NoEquilibrium { steps: factors, left: f64::INFINITY })
}
