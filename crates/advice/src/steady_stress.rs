//! Change of frequencies by the stress of loads that stay as they are.

use faer::MatRef;

use crate::case::{AdviceError, Case};
use crate::row::Row;

/// The row of [`Effect::GeometricStiffening`](dynamics::Effect) by the stress of steady loads, whose stiffness in the modes of the case is
/// `stiffness` (nf × nf, K_kl). Its value is the largest |K_kl|/(ω_k ω_l); its influence is the phase that a mode is out
/// by at the end of the time that it rings.
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length and numbers out of range.
pub fn steady_stress(case: &Case, stiffness: MatRef<'_, f64>, tolerance: f64) -> Result<Row, AdviceError> {
    case.check(tolerance)?;
    let omega = &case.body.circular_frequencies;
    for found in [stiffness.nrows(), stiffness.ncols()] {
        if found != omega.len() {
            let what = "a row or column of the stress stiffness";
            return Err(AdviceError::Length { what, found, expected: omega.len() });
        }
    }
    let (mut value, mut influence) = (0.0_f64, 0.0_f64);
    for k in 0..omega.len() {
        let rings = case.end.min(1.0 / (case.damping_ratios[k] * omega[k]));
        for l in 0..omega.len() {
            let ratio = stiffness[(k, l)].abs() / (omega[k] * omega[l]);
            value = value.max(ratio);
            influence = influence.max(ratio * (0.5 * omega[k].min(omega[l]) * rings).max(1.0));
        }
    }
    let influence = influence.min(1.0);
    let shift = 100.0 * 0.5 * value;
    let why = format!("The stress of steady loads moves the frequency of a mode by up to {shift:.2e} %.");
    Ok(Row { value, influence, on: influence >= tolerance, why })
}
