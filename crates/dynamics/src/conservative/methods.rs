//! The schemes of the conservative form.

use crate::conservative::ConservativeBody;
use crate::error::SetupError;
use crate::scheme::Scheme;
use crate::scheme::abilities::Abilities;
use crate::scheme::exponential::Exponential;
use crate::scheme::runge_kutta::{Classical, RungeKutta};
use crate::simulation::setup::{Beginning, Method, Setup, StepLimit};

impl Method {
    /// The conservative form by classical Runge–Kutta on the rotation vector of the step (Munthe-Kaas), stable to 2.83/ω_max.
    pub const RKMK4: Self = Self {
        formulation: "conservative",
        scheme: "rkmk4",
        order: 4,
        evaluations_per_step: 4,
        limit: StepLimit::Modes,
        estimates_error: true,
        abilities: Abilities::ALL,
        joints: None,
        begin: |setup| Beginning::conservative(setup, RungeKutta::<_, Classical, 4>::new),
    };

    /// The conservative form by the exponential scheme of Krogstad (ETD-RK4): the default.
    ///
    /// Coriolis terms turn the modes with up to twice the spin, which the stages of RK4 follow to 2.83 in the step.
    pub const EXPONENTIAL: Self = Self {
        formulation: "conservative",
        scheme: "exponential",
        order: 4,
        evaluations_per_step: 4,
        limit: StepLimit::Turn(std::f64::consts::SQRT_2),
        estimates_error: true,
        abilities: Abilities::ALL,
        joints: None,
        begin: |setup| Beginning::conservative(setup, Exponential::new),
    };
}

impl Beginning {
    /// The conservative form of a body by a scheme, which is made for its equations.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers out of range.
    pub fn conservative<S: Scheme<ConservativeBody>>(
        setup: &Setup,
        scheme: impl FnOnce(&ConservativeBody) -> S,
    ) -> Result<Self, SetupError> {
        let body = ConservativeBody::new(setup.body, setup.damping_ratios, setup.loads.to_vec(), setup.physics)?;
        let body = body.beginning_at(setup.initial);
        let (scheme, start) = (scheme(&body), body.start(setup.initial)?);
        Ok(Self::new(setup, body, scheme, start))
    }
}
