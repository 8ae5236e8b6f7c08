//! Drawing with plotters.
//!
//! plotters counts in whole units. Figures are composed in pixels with y downwards and drawn in units finer than the
//! pixel: a document keeps the fine units, a bitmap is averaged down, which smooths all its edges.

use std::fmt::Display;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::FigureError;
use crate::document::font;

pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
/// Sizes of letters, in pixels per em.
pub(crate) const TITLE_EM: f64 = 14.0;
pub(crate) const LABEL_EM: f64 = 13.0;
pub(crate) const TICK_EM: f64 = 11.5;

/// Units per pixel of an SVG or a PDF.
pub(crate) const FINE: u32 = 4;

/// A picture or a part of one, in units.
pub(crate) type Area<DB> = DrawingArea<DB, Shift>;

/// A figure that can be drawn.
pub(crate) trait Figure {
    /// Width and height in pixels.
    fn size(&self) -> [u32; 2];

    /// Dots per pixel of a PNG.
    fn dots(&self) -> u32 {
        2
    }

    /// Draws into an area of this size.
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>, unit: Unit) -> Result<(), FigureError>;
}

/// Conversion of pixels into the units that plotters counts in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    per_pixel: u32,
    /// True if lines and areas stay lines and areas, as in a document, and do not become dots.
    pub(crate) is_vector: bool,
}

impl Unit {
    /// Unit of an SVG or a PDF.
    pub(crate) const DOCUMENT: Self = Self { per_pixel: FINE, is_vector: true };

    /// Unit of a bitmap with `per_pixel` units per pixel.
    pub(crate) fn of_bitmap(per_pixel: u32) -> Self {
        Self { per_pixel, is_vector: false }
    }

    /// Units that this many pixels make.
    pub(crate) fn px(self, pixels: f64) -> i32 {
        (pixels * self.per_pixel()).round() as i32
    }

    /// The same for the width of a line, which is never nothing.
    pub(crate) fn stroke(self, pixels: f64) -> u32 {
        self.px(pixels).max(1) as u32
    }

    pub(crate) fn per_pixel(self) -> f64 {
        f64::from(self.per_pixel)
    }

    /// Text whose em is this many pixels, and which point of it stands where it is drawn.
    pub(crate) fn text(self, em: f64, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
        let size = em * self.per_pixel() * font::SIZE_PER_EM;
        font::of_size(size).color(&INK).pos(Pos::new(horizontal, vertical))
    }
}

/// Draws a title, if there is one, and returns the area below it.
pub(crate) fn titled<DB: DrawingBackend>(
    area: Area<DB>,
    title: &str,
    em: f64,
    unit: Unit,
) -> Result<Area<DB>, FigureError> {
    if title.is_empty() {
        return Ok(area);
    }
    Ok(area.titled(title, unit.text(em, HPos::Center, VPos::Top))?.margin(unit.px(5.0), 0, 0, 0))
}

pub(crate) fn draw_error(error: impl Display) -> FigureError {
    FigureError::Draw { reason: error.to_string() }
}
