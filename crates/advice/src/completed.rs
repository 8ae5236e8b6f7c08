//! The advice with what is found out after the modes to keep have been chosen.

use crate::row::{Effect, Row};
use crate::table::Advice;

/// What is found out about the body that a run is made with.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// [`Advice::deflection`] of that body: static shapes carry some of it, too.
    pub deflection: f64,
    /// The row of [`crate::stress_row`], where loads or a drive stress the body.
    pub stress: Option<Row>,
    /// Whether the body has no static shapes for what the spin stretches.
    pub lacks_stretch: bool,
}

impl Advice {
    /// The same advice with what has been found since. Of the two reasons for stiffening, the stress of the spin and that
    /// of loads and drives, the one with the larger influence has the row.
    pub fn completed(self, findings: Findings) -> Self {
        let Findings { deflection, mut stress, lacks_stretch } = findings;
        let lacks_stretch = lacks_stretch && self.stretch >= self.tolerance;
        let complete = |row: Row| match row.effect {
            Effect::GeometricStiffening => stress.take().filter(|s| row.influence <= s.influence).unwrap_or(row),
            Effect::StaticCorrection if lacks_stretch => Row { why: row.why + LACKS_STRETCH, ..row },
            _ => row,
        };
        Self { rows: self.rows.into_iter().map(complete).collect(), deflection, ..self }
    }
}

const LACKS_STRETCH: &str = " The answer lacks what the spin stretches beyond the modes: take static_correction = true \
     with the scheme exponential, or more modes.";
