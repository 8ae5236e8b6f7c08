//! Change of frequencies by the stress of loads and of a drive.

use faer::MatRef;

use crate::motion::case::{AdviceError, Case};
use crate::motion::course::Course;
use crate::table::row::Row;

/// A field of forces that stresses the body.
#[derive(Debug, Clone, Copy)]
pub struct StressField<'a> {
    /// Name for the reader: "gravity along (0, 0, -1)".
    pub name: &'a str,
    /// The function of time that it follows.
    pub source: StressSource,
    /// Its stiffness in the modes (nf × nf) where the history of the load, or the acceleration of the drive, is 1.
    pub stiffness: MatRef<'a, f64>,
}

/// The function of time that a field of forces follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StressSource {
    /// The history of a load of the case, numbered from 0.
    Load(usize),
    /// The acceleration of the drive.
    Drive,
}

/// Influence of the stress of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressInfluence {
    /// Largest |K_kl|/(ω_k ω_l) over the run.
    pub value: f64,
    /// Phase that a mode is out by at the end of the time that it rings, without this stress, or `value` if that is
    /// larger; at most 1.
    pub influence: f64,
}

/// Influence of each field, without which the run would be made.
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length and numbers out of range.
pub fn stress(case: &Case, fields: &[StressField<'_>], tolerance: f64) -> Result<Vec<StressInfluence>, AdviceError> {
    case.check(tolerance)?;
    fields.iter().map(|field| influence(case, field)).collect()
}

fn influence(case: &Case, field: &StressField<'_>) -> Result<StressInfluence, AdviceError> {
    let omega = &case.body.circular_frequencies;
    for found in [field.stiffness.nrows(), field.stiffness.ncols()] {
        if found != omega.len() {
            let what = "a row or column of the geometric stiffness";
            return Err(AdviceError::Length { what, found, expected: omega.len() });
        }
    }
    let Amplitude { largest, integral } = amplitude(case, field.source);
    let (mut value, mut influence) = (0.0_f64, 0.0_f64);
    for k in 0..omega.len() {
        // A shift of the frequency counts for as long as the load acts and the mode rings.
        let rings = integral.min(largest / (case.damping_ratios[k] * omega[k]));
        for l in 0..omega.len() {
            let ratio = field.stiffness[(k, l)].abs() / (omega[k] * omega[l]);
            value = value.max(ratio * largest);
            influence = influence.max(ratio * (0.5 * omega[k].min(omega[l]) * rings).max(largest));
        }
    }
    Ok(StressInfluence { value, influence: influence.min(1.0) })
}

/// How much a field acts.
struct Amplitude {
    largest: f64,
    /// ∫ of its magnitude over the run.
    integral: f64,
}

fn amplitude(case: &Case, source: StressSource) -> Amplitude {
    match source {
        StressSource::Load(i) => {
            let history = case.loads.get(i).and_then(|load| load.history());
            history.map_or(Amplitude { largest: 0.0, integral: 0.0 }, |history| Amplitude {
                largest: history.largest(case.end),
                integral: history.magnitude_integral(case.end),
            })
        }
        StressSource::Drive => case.drive.map_or(Amplitude { largest: 0.0, integral: 0.0 }, |drive| {
            let course = Course::new(&drive.speed.history, case.end, case.costly_histories());
            let largest = drive.speed.amplitude.abs() * course.steepest();
            Amplitude { largest, integral: largest * case.end }
        }),
    }
}

/// The row of [`dynamics::Effect::GeometricStiffening`] of the field with the largest influence; none without fields.
pub fn stress_row(fields: &[StressField<'_>], influences: &[StressInfluence], tolerance: f64) -> Option<Row> {
    let larger = |a: &(_, &StressInfluence), b: &(_, &StressInfluence)| a.1.influence.total_cmp(&b.1.influence);
    let (field, &StressInfluence { value, influence }) = fields.iter().zip(influences).max_by(larger)?;
    let (name, shift) = (field.name, 100.0 * 0.5 * value);
    let why = format!("The stress of {name} moves the frequency of a mode by up to {shift:.2e} %.");
    Some(Row { value, influence, on: influence >= tolerance, why })
}
