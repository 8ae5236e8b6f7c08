//! The typeface of all figures: DejaVu Sans, carried in the program, so that figures need no system font.

use ab_glyph::{Font, FontRef};
use plotters::style::text_anchor::VPos;
use plotters::style::{FontStyle, IntoFont, TextStyle, register_font};

use crate::FigureError;

/// The name under which plotters knows the typeface. A viewer of an SVG uses its own typeface of this kind.
const FAMILY: &str = "sans-serif";

/// Letters are as high as plotters' size divided by this, in an SVG.
pub(crate) const SIZE_PER_EM: f64 = 1.24;
/// Height of a line (ascent and descent) per em, by which plotters measures text in a bitmap.
pub(crate) const LINE_PER_EM: f64 = (1901.0 + 483.0) / 2048.0;
/// Height of an x per em.
const X_PER_EM: f64 = 1120.0 / 2048.0;

/// The typeface, as a TrueType file.
pub(crate) const FILE: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");

/// How far the base line of a text lies below the point where it is anchored, in ems, as plotters writes it into an SVG.
pub(crate) fn base_line(anchor: VPos) -> f64 {
    match anchor {
        VPos::Top => 0.76,
        VPos::Center => 0.5 * X_PER_EM,
        VPos::Bottom => -0.5 * X_PER_EM,
    }
}

/// Makes the typeface known; before anything is drawn.
pub(crate) fn register() -> Result<(), FigureError> {
    register_font(FAMILY, FontStyle::Normal, FILE)
        .map_err(|_| FigureError::Draw { reason: "the built-in font could not be read".into() })
}

/// Text of the size that plotters measures in.
pub(crate) fn of_size(size: f64) -> TextStyle<'static> {
    TextStyle::from((FAMILY, size).into_font())
}

/// Width of a text whose em is so large, by the advances of its letters.
pub(crate) fn width(text: &str, em: f64) -> f64 {
    // A letter of the typeface is not wider than an em.
    let Ok(font) = FontRef::try_from_slice(FILE) else { return text.chars().count() as f64 * em };
    let per_em = font.units_per_em().unwrap_or(2048.0);
    text.chars().map(|letter| em * f64::from(font.h_advance_unscaled(font.glyph_id(letter)) / per_em)).sum()
}
