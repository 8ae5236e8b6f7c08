//! What would mend an error that a check has found.

use serde::Serialize;

/// A part of the error that is worth a mend, of the whole.
const PART: f64 = 0.3;
/// An error below this is not worth one.
const SMALL: f64 = 1e-3;

/// Something that would make a model's error smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mend {
    /// The linear answer to the loads lies outside the modes, and there are no static shapes.
    StaticShapes,
    /// The same though there are static shapes: the rest of the answer, as that to its own inertia, needs modes.
    MoreModes,
    /// The body bends further than linear modes hold.
    LargeModes,
    /// It bends further than the large modes hold: modes about its deformed rest do.
    Reference,
}

impl Mend {
    /// The mend in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::StaticShapes => "static shapes (`[modes] static_correction = true`)",
            Self::MoreModes => "more modes (`[modes] flexible`)",
            Self::LargeModes => "large modes (`[effects] large_deflection = true`)",
            Self::Reference => "modes about the bent rest (`about` in [modes]), or fewer loads",
        }
    }
}

/// Sizes of an error and its parts, relative to the true displacements.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parts {
    pub error: f64,
    pub within: f64,
    pub beside: f64,
    /// Share of the linear answer in the part beside the modes: 0 to 1.
    pub linear: f64,
}

/// The mends of an error.
pub(crate) fn mends(parts: &Parts, has_static_shapes: bool, has_large_modes: bool) -> Vec<Mend> {
    if parts.error.is_nan() || parts.error < SMALL {
        return Vec::new();
    }
    let counts = |part: f64| part >= PART * parts.error;
    let linear = parts.beside * parts.linear;
    // Orthogonal to the linear one.
    let bent = parts.within.hypot(parts.beside * (1.0 - parts.linear * parts.linear).max(0.0).sqrt());
    let mut mends = Vec::new();
    if counts(linear) {
        mends.push(if has_static_shapes { Mend::MoreModes } else { Mend::StaticShapes });
    }
    if counts(bent) {
        mends.push(if has_large_modes { Mend::Reference } else { Mend::LargeModes });
    }
    mends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_of_an_error_has_its_mend() {
        let parts = |within, beside, linear| Parts { error: f64::hypot(within, beside), within, beside, linear };
        assert_eq!(mends(&parts(1e-4, 1e-4, 1.0), false, false), []);
        assert_eq!(mends(&parts(1e-4, 0.1, 1.0), false, false), [Mend::StaticShapes]);
        assert_eq!(mends(&parts(1e-4, 0.1, 0.95), true, false), [Mend::MoreModes, Mend::LargeModes]);
        assert_eq!(mends(&parts(0.1, 0.02, 0.1), true, false), [Mend::LargeModes]);
        assert_eq!(mends(&parts(0.1, 0.02, 0.1), true, true), [Mend::Reference]);
    }
}
