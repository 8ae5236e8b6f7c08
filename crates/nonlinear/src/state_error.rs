//! The true error of a state of a reduced model.
//!
//! ```text
//! r = f(u) − f_int(u) − M a        e = K*⁻¹ r        S = C:ε(K⁻¹ (f(u) − M a))
//! then, where e is not small:  S ← C:(E(u) + B(u)e),   u ← u + e,   a ← a − W e + α × e,   and again
//! ```
//!
//! The stress of the first step comes from the linear body in equilibrium with the forces of the state, not from its
//! displacements: those have a false membrane stress as soon as they bend a slender body, which makes K* a hundred times too stiff
//! or indefinite. (Eqs. (K4), (K5) of `docs/method/check.md`.)

use faer::{Mat, MatRef};
use fem_tet10::Stresses;
use nalgebra::Vector3;

use crate::body::{FullBody, spin};
use crate::error::NonlinearError;
use crate::followers::change;
use crate::forces::ExternalForces;
use crate::tangent::{Tangent, TangentTerms};
use crate::vectors::{add, dot, sum};

/// A state of a body at one time, in the axes of its frame.
#[derive(Debug, Clone)]
pub struct FullState {
    /// Displacements by deformation (3n).
    pub displacement: Vec<f64>,
    /// Accelerations of the nodes against an inertial frame (3n).
    pub acceleration: Vec<f64>,
    /// Angular velocity of the frame.
    pub omega_body: Vector3<f64>,
    /// Angular acceleration of the frame.
    pub alpha_body: Vector3<f64>,
    /// The forces at that time.
    pub forces: ExternalForces,
}

/// How far an error is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateErrorSettings {
    /// An error below this part of the displacements, in the norm of M, is good enough after one factor.
    pub small: f64,
    /// The last change over the error that ends the iteration where the error is not small.
    pub settled: f64,
    /// Most factors, beside that of the body at rest.
    pub max_factors: usize,
}

impl Default for StateErrorSettings {
    fn default() -> Self {
        Self { small: 0.01, settled: 0.1, max_factors: 4 }
    }
}

impl StateErrorSettings {
    /// To the end of the iteration: the answer of the full body.
    pub fn converged() -> Self {
        Self { small: 1e-11, settled: 1e-9, max_factors: 40 }
    }
}

/// The error of a state.
pub struct StateError<'a> {
    /// The displacements of the full body less those of the state (3n).
    pub error: Vec<f64>,
    /// The same after the first factor.
    pub first: Vec<f64>,
    /// Factors that were made, beside that of the body at rest.
    pub factors: usize,
    /// Size of the last change over that of the error, in the norm of M; 1 after one factor.
    pub last_change: f64,
    /// Number of negative eigenvalues of K* at the last factor.
    pub negative_pivots: usize,
    /// The forces of the state less its inertia (3n).
    pub acting: Vec<f64>,
    /// The answer of the linear body to them (3n).
    pub linear_answer: Vec<f64>,
    /// The last K*.
    pub tangent: Tangent<'a>,
    /// The stress of the full body.
    pub stresses: Stresses,
}

impl<'a> FullBody<'a> {
    /// The stiffness of the undeformed body, factored.
    ///
    /// # Errors
    /// As [`Tangent::new`].
    pub fn at_rest(&'a self) -> Result<Tangent<'a>, NonlinearError> {
        let rest = vec![0.0; self.dofs()];
        let stresses = self.strain().stresses(&rest);
        Tangent::new(self, &TangentTerms::spinning(&rest, &stresses, &Vector3::zeros()))
    }

    /// √(vᵀ M v).
    pub fn mass_norm(&self, v: &[f64]) -> f64 {
        dot(v, &self.momentum(v)).max(0.0).sqrt()
    }

    /// Splits displacements into their part along M-orthonormal shapes (3n×k) and the rest.
    pub fn parts(&self, shapes: MatRef<'_, f64>, v: &[f64]) -> [Vec<f64>; 2] {
        let momentum = self.momentum(v);
        let within: Mat<f64> = shapes * (shapes.transpose() * crate::vectors::column(&momentum));
        let within = crate::vectors::list(&within, 0);
        let beside = sum(v, -1.0, &within);
        [within, beside]
    }
}

/// The error of a state. `at_rest` is the factor of [`FullBody::at_rest`].
///
/// # Errors
/// Errors of the factors; [`NonlinearError::NotFinite`].
pub fn state_error<'a>(
    body: &'a FullBody<'a>,
    at_rest: &Tangent<'_>,
    state: &FullState,
    settings: &StateErrorSettings,
) -> Result<StateError<'a>, NonlinearError> {
    let FullState { displacement, acceleration, omega_body, alpha_body, forces } = state;
    for (what, list) in [("a displacement", displacement), ("an acceleration", acceleration)] {
        if !list.iter().all(|value| value.is_finite()) {
            return Err(NonlinearError::NotFinite { what });
        }
    }
    let inertia = body.momentum(acceleration);
    let acting = sum(&forces.at(body.mesh(), displacement)?, -1.0, &inertia);
    let linear_answer = at_rest.answer(&acting)?;
    let mut stresses = body.strain().linear_stresses(&linear_answer);
    let of_state = acting.clone();
    let mut acting = acting;
    let mut u = displacement.clone();
    let mut first = Vec::new();
    let mut factors = 0;
    loop {
        let tangent = Tangent::new(body, &TangentTerms::spinning(&u, &stresses, omega_body))?;
        factors += 1;
        let residual = sum(&acting, -1.0, &body.strain().internal_forces(&u));
        let step = change(body, &tangent, forces, &u, &residual)?;
        stresses = body.strain().linearized_stresses(&u, &step);
        add(&mut u, 1.0, &step);
        if !u.iter().all(|value| value.is_finite()) {
            return Err(NonlinearError::NotFinite { what: "a displacement of the full body" });
        }
        let error = sum(&u, -1.0, displacement);
        if factors == 1 {
            first.clone_from(&error);
        }
        let [of_error, of_step, of_body] = [&error, &step, &u].map(|v| body.mass_norm(v));
        let last_change = if of_error > 0.0 { of_step / of_error } else { 0.0 };
        let is_small = of_error <= settings.small * of_body;
        let is_settled = factors > 1 && last_change <= settings.settled;
        if is_small || is_settled || factors >= settings.max_factors {
            let negative_pivots = tangent.negative_pivots();
            return Ok(StateError {
                error,
                first,
                factors,
                last_change,
                negative_pivots,
                acting: of_state,
                linear_answer,
                tangent,
                stresses,
            });
        }
        let moved = taken_along(&error, omega_body, alpha_body);
        acting = sum(&forces.at(body.mesh(), &u)?, -1.0, &sum(&inertia, 1.0, &body.momentum(&moved)));
    }
}

/// −W e + α × e: how displacements change the accelerations that the frame takes them along with.
fn taken_along(e: &[f64], omega_body: &Vector3<f64>, alpha_body: &Vector3<f64>) -> Vec<f64> {
    let w = spin(omega_body);
    e.chunks_exact(3)
        .flat_map(|e| {
            let e = Vector3::from_column_slice(e);
            <[f64; 3]>::from(alpha_body.cross(&e) - w * e)
        })
        .collect()
}
