//! Changes to a model that would mend an error that a check has found.

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
    /// Its vibrations come out of step with these large modes.
    OtherLargeModes,
}

impl Mend {
    /// The mend in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::StaticShapes => "static shapes (`[modes] static_correction = true`)",
            Self::MoreModes => "more modes (`[modes] flexible`)",
            Self::LargeModes => "large modes (`[effects] large_deflection = true`)",
            Self::Reference => "modes about the bent rest (`[modes] about`), or fewer loads",
            Self::OtherLargeModes => {
                "another number of large modes (`[modes] large`, `following`), or modes about the bent rest (`[modes] about`), and compare"
            }
        }
    }
}

/// A part of an error, and what would make it smaller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorPart {
    /// The part.
    pub direction: ErrorDirection,
    /// Its size over that of the displacements that the error is stated against.
    pub size: f64,
    /// The mend; `None` where it is so small that it needs none.
    pub mend: Option<Mend>,
}

/// Directions of an error. Those beside the modes are at right angles to each other and to the modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorDirection {
    /// Along the modes, less what a linear body has there, too: their stiffness is wrong.
    Modes,
    /// Left out of the linear answer to the forces by modes and static shapes: beside the modes, and along the static shapes.
    LinearAnswer,
    /// Beside the modes in other directions, as the foreshortening of a body that bends far.
    Bending,
}

impl ErrorDirection {
    /// The direction in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Modes => "along the modes",
            Self::LinearAnswer => "left out of the linear answer to the forces",
            Self::Bending => "beside the modes by bending far",
        }
    }
}

/// The parts of an error: along the modes, along static shapes as a linear body has it, too, beside them, and the share of the linear answer in
/// the latter (0 to 1), relative to the displacements that it is stated against.
pub(crate) fn parts(
    [within, left_out, beside, linear]: [f64; 4],
    has_static_shapes: bool,
    has_large_modes: bool,
) -> [ErrorPart; 3] {
    let of_loads = if has_static_shapes { Mend::MoreModes } else { Mend::StaticShapes };
    let of_bending = if has_large_modes { Mend::Reference } else { Mend::LargeModes };
    let across = (1.0 - linear * linear).max(0.0).sqrt();
    [
        (ErrorDirection::Modes, within, of_bending),
        (ErrorDirection::LinearAnswer, left_out.hypot(beside * linear), of_loads),
        (ErrorDirection::Bending, beside * across, of_bending),
    ]
    .map(|(direction, size, mend)| ErrorPart { direction, size, mend: (size >= SMALL).then_some(mend) })
}

/// The mend of vibrations that come out of step by this part of the largest.
pub(crate) fn mend_of_drift(drift: f64, has_large_modes: bool) -> Option<Mend> {
    let mend = if has_large_modes { Mend::OtherLargeModes } else { Mend::LargeModes };
    (drift >= SMALL).then_some(mend)
}

/// The mends of the larger parts, each once.
pub(crate) fn mends(parts: &[ErrorPart; 3]) -> Vec<Mend> {
    let error = parts.iter().map(|part| part.size * part.size).sum::<f64>().sqrt();
    let [within, linear, bending] = *parts;
    // One mend is for both.
    let bent = within.size.hypot(bending.size);
    let counts = |size: f64| error >= SMALL && size >= PART * error;
    let of = |size: f64, parts: [ErrorPart; 2]| parts.iter().filter(|_| counts(size)).find_map(|part| part.mend);
    [of(linear.size, [linear; 2]), of(bent, [within, bending])].into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_of_an_error_has_its_mend() {
        let mends = |[within, beside, linear]: [f64; 3], has_static_shapes, has_large_modes| {
            mends(&parts([within, 0.0, beside, linear], has_static_shapes, has_large_modes))
        };
        assert_eq!(mends([1e-4, 1e-4, 1.0], false, false), []);
        assert_eq!(mends([1e-4, 0.1, 1.0], false, false), [Mend::StaticShapes]);
        assert_eq!(mends([1e-4, 0.1, 0.95], true, false), [Mend::MoreModes, Mend::LargeModes]);
        assert_eq!(mends([0.1, 0.02, 0.1], true, false), [Mend::LargeModes]);
        assert_eq!(mends([0.1, 0.02, 0.1], true, true), [Mend::Reference]);
        let [along, left_out, bending] = parts([2e-3, 0.0, 0.05, 0.6], false, false);
        assert_eq!([along.mend, left_out.mend], [Some(Mend::LargeModes), Some(Mend::StaticShapes)]);
        // Closed form: 0.05 split by 0.6 and 0.8.
        assert!((left_out.size - 0.03).abs() < 1e-15 && (bending.size - 0.04).abs() < 1e-15);
        // Along the static shapes, as of a linear body.
        let [along, left_out, _] = parts([9e-4, 0.4, 0.5, 0.6], true, false);
        assert!((left_out.size - 0.5).abs() < 1e-15 && left_out.mend == Some(Mend::MoreModes) && along.mend.is_none());
        assert_eq!(parts([9e-4, 0.0, 0.0, 0.0], false, false)[0].mend, None);
        let of_drift = [(0.4, false), (0.4, true), (9e-4, true)].map(|(drift, large)| mend_of_drift(drift, large));
        assert_eq!(of_drift, [Some(Mend::LargeModes), Some(Mend::OtherLargeModes), None]);
    }
}
