//! Lines of charts: their points, and the pens that draw them.

use plotters::element::DashedPathElement;
use plotters::prelude::*;

use crate::FigureError;
use crate::document::picture::{INK, Unit};

/// Okabe and Ito's colours, told apart by all common kinds of colour vision; the light ones last.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
pub(crate) const GUIDE: RGBColor = RGBColor(150, 150, 150);

// Lengths in pixels.
const SOLID_WIDTH: f64 = 1.5;
/// Wider than a solid line, so that either is seen where they coincide.
const DASHED_WIDTH: f64 = 2.5;
const DASH: f64 = 8.0;
const DASH_GAP: f64 = 6.0;
const RING: f64 = 3.5;

/// How a series is drawn. Dashed lines are wider and lie above solid ones: where the two coincide,
/// both are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stroke {
    /// An unbroken line.
    #[default]
    Solid,
    /// A dashed line.
    Dashed,
    /// A thin grey line below the others, with its label at its end and not in the legend.
    Guide,
    /// A ring at each point and no line.
    Rings,
}

impl Stroke {
    /// The stroke of the line with this number, from 0: solid while colours are new, dashed where they begin again.
    pub fn of_line(number: usize) -> Self {
        if number < COLOURS.len() { Self::Solid } else { Self::Dashed }
    }
}

/// One line, or one set of rings, of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend, or of a guide at its end; a chart whose labels are all empty has no legend.
    pub label: String,
    /// The points (x, y); lines join them in this order.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub stroke: Stroke,
}

impl Series {
    /// True if it is one of the lines that show data.
    pub(crate) fn is_line(&self) -> bool {
        matches!(self.stroke, Stroke::Solid | Stroke::Dashed)
    }
}

/// How the line of a series is drawn.
pub(crate) struct Pen {
    stroke: Stroke,
    pub(crate) style: ShapeStyle,
    unit: Unit,
}

impl Pen {
    /// Style of the series with this index.
    pub(crate) fn new(stroke: Stroke, i: usize, unit: Unit) -> Self {
        let (colour, width) = match stroke {
            Stroke::Solid => (COLOURS[i % COLOURS.len()], SOLID_WIDTH),
            Stroke::Dashed => (COLOURS[i % COLOURS.len()], DASHED_WIDTH),
            Stroke::Guide => (GUIDE, 1.0),
            Stroke::Rings => (INK, SOLID_WIDTH),
        };
        Self { stroke, style: colour.stroke_width(unit.stroke(width)), unit }
    }

    /// On a chart or on a legend.
    pub(crate) fn draw<DB: DrawingBackend, C: CoordTranslate<From: Clone + 'static>>(
        &self,
        area: &DrawingArea<DB, C>,
        points: Vec<C::From>,
    ) -> Result<(), FigureError> {
        let px = |pixels| self.unit.px(pixels);
        match self.stroke {
            Stroke::Solid | Stroke::Guide => area.draw(&PathElement::new(points, self.style))?,
            Stroke::Dashed => area.draw(&DashedPathElement::new(points, px(DASH), px(DASH_GAP), self.style))?,
            Stroke::Rings => {
                for point in points {
                    area.draw(&Circle::new(point.clone(), px(RING), WHITE.filled()))?;
                    area.draw(&Circle::new(point, px(RING), self.style))?;
                }
            }
        }
        Ok(())
    }
}
