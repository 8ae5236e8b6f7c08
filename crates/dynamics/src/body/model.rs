//! Requirements of every formulation on a body and its loads.

use reduced_body::ReducedBody;

use crate::error::SetupError;
use crate::load::SharedLoad;

/// Refuses a body whose rigid motions are of a kind that has no equations here, damping ratios that are not one number of
/// zero or more for each flexible mode, and loads of another body.
///
/// # Errors
/// [`SetupError`].
pub fn check_model(body: &ReducedBody, damping_ratios: &[f64], loads: &[SharedLoad]) -> Result<(), SetupError> {
    check_motion(body)?;
    check_damping(damping_ratios, body.flexible())?;
    loads.iter().try_for_each(|load| load.check(body.flexible()))
}

/// Refuses a body whose rigid motions are of a kind that has no equations here.
pub(crate) fn check_motion(body: &ReducedBody) -> Result<(), SetupError> {
    if body.motion.others().is_empty() { Ok(()) } else { Err(SetupError::MotionLeft { motion: Box::new(body.motion) }) }
}

/// Refuses damping ratios that are not one number of zero or more for each mode.
pub(crate) fn check_damping(damping_ratios: &[f64], flexible: usize) -> Result<(), SetupError> {
    if damping_ratios.len() != flexible {
        let found = damping_ratios.len();
        return Err(SetupError::Length { what: "the list of damping ratios", expected: flexible, found });
    }
    match damping_ratios.iter().copied().find(|zeta| !(*zeta >= 0.0 && zeta.is_finite())) {
        Some(found) => Err(SetupError::Value { what: "a damping ratio", found, expected: "zero or more" }),
        None => Ok(()),
    }
}
