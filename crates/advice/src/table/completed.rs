//! The advice with what is found out after the modes to keep have been chosen.

use dynamics::Effect;

use crate::table::row::Row;
use crate::table::rows::Advice;

/// Findings about the body that a run is made with.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// [`Advice::deflection`] of that body: static shapes carry some of it, too.
    pub deflection: f64,
    /// The row of [`crate::stress_row`], where loads or a drive stress the body.
    pub stress: Option<Row>,
    /// True if the body has no static shapes for the stretch by the spin, or for the inertia of the drive.
    pub lacks_stretch: bool,
    /// True if modes bend the body far.
    pub has_large_modes: bool,
}

impl Advice {
    /// The same advice with what has been found since. Of the two reasons for stiffening, the stress of the spin and that
    /// of loads and drives, the one with the larger influence has the row.
    pub fn completed(self, findings: Findings) -> Self {
        let mut advice = Self { deflection: findings.deflection, ..self };
        let stiffening = &mut advice.effects[Effect::GeometricStiffening];
        if let Some(stress) = findings.stress.filter(|stress| stiffening.influence <= stress.influence) {
            *stiffening = stress;
        }
        if findings.has_large_modes {
            let influence = advice.effects[Effect::LargeDeflection].influence;
            for effect in [Effect::Coriolis, Effect::DeformedInertia] {
                let row = &mut advice.effects[effect];
                row.influence = row.influence.max(influence);
                row.on = row.influence >= advice.tolerance;
                row.why += OF_LARGE_MODES;
            }
        }
        if findings.lacks_stretch && advice.stretch.max(advice.pushed) >= advice.tolerance {
            advice.static_correction.why += LACKS_STRETCH;
        }
        advice
    }
}

const OF_LARGE_MODES: &str = " What follows the large modes moves along the body, where turning acts on it.";
const LACKS_STRETCH: &str = " The answer lacks what the modes leave out: take static_correction = true \
     with the scheme exponential, or more modes.";
