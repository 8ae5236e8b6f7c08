//! Errors of steady states and of linearised equations.

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// Errors of steady states.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SteadyError {
    /// The inertia of a body is singular.
    #[error("the inertia of a body is singular; check masses and mesh")]
    Inertia,
    /// Numbers are not finite, or the linear algebra does not converge.
    #[error(
        "the linearised equations of the system have no answer: numbers are not finite or far apart; check materials, units and masses"
    )]
    Numbers,
    /// The spin turns bodies that a joint holds.
    #[error(
        "the spin is not one that joint {joint:?} allows: it would move at a rate of {rate:.3e}; the axis of the spin is to be that of \
         the joints that tie the system to the ground"
    )]
    Against {
        /// Name of the joint or coupling.
        joint: String,
        /// Rate of its row.
        rate: f64,
    },
    /// No place in which all forces balance.
    #[error(
        "the bodies find no equilibrium after {passes} passes: {body} is still moving; hold it by a joint or a spring, or take out the \
         load that moves it"
    )]
    NoEquilibrium {
        /// The body that moves most, or its number.
        body: String,
        /// Passes that were made.
        passes: usize,
    },
    /// Newton's method does not converge.
    #[error(
        "the bodies find no shape in which they are at rest in this state after {passes} passes; forces or spin may bend them further than their modes hold: try less, and see what the bodies do by `flexframe check`"
    )]
    NoRest {
        /// Passes that were made.
        passes: usize,
    },
}

impl Diagnostic for SteadyError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Run.alone()
    }
}
