//! The typeface of all figures: DejaVu Sans, carried in the program, so that figures need no system font.

use crate::FigureError;
use plotters::style::{FontStyle, IntoFont, TextStyle, register_font};
use std::sync::OnceLock;

/// The name under which the typeface is known to the drawing library. A viewer of an SVG uses its own
/// typeface of this kind.
const FAMILY: &str = "sans-serif";

/// Height of a line (ascent and descent) per em, by which the rasteriser measures text.
pub(crate) const LINE_PER_EM: f64 = (1901.0 + 483.0) / 2048.0;

/// Half the height of an x per em.
pub(crate) const HALF_X_HEIGHT: f64 = 0.5 * 1120.0 / 2048.0;

/// A text style of this size in the drawing library's own measure.
pub(crate) fn style(size: f64) -> Result<TextStyle<'static>, FigureError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular()).is_ok());
    if !registered {
        return Err(FigureError::Draw { reason: "the built-in font could not be read".into() });
    }
    Ok(TextStyle::from((FAMILY, size).into_font()))
}

/// Width of a text in pixels, for an em of `em` pixels.
pub(crate) fn width(text: &str, em: f64) -> Result<f64, FigureError> {
    let enlarged = 16.0; // the library rounds to whole pixels
    let layout = style(em * LINE_PER_EM * enlarged)?.font.layout_box(text);
    let ((left, _), (right, _)) = layout.map_err(|error| FigureError::Draw { reason: error.to_string() })?;
    Ok(f64::from(right - left) / enlarged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minus_is_wider_than_a_hyphen_and_widths_grow_with_the_em() {
        assert!(width("\u{2212}", 12.0).unwrap() > 1.5 * width("-", 12.0).unwrap());
        let ratio = width("ω₁ (rad/s)", 24.0).unwrap() / width("ω₁ (rad/s)", 12.0).unwrap();
        assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
    }
}
