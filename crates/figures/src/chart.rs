//! Line charts with linear or logarithmic axes.

use std::path::{Path, PathBuf};

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::axis::{Axis, Scale};
use crate::path::{Point, clipped, thinned};
use crate::picture::{Area, Figure, INK, LABEL_EM, TICK_EM, TITLE_EM, Unit, save, titled};

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
const GRID: RGBColor = RGBColor(222, 222, 222);
const FAINT_GRID: RGBColor = RGBColor(240, 240, 240);
const GUIDE: RGBColor = RGBColor(150, 150, 150);
const GUIDE_INK: RGBColor = RGBColor(95, 95, 95);

// Lengths in pixels.
const SIZE: [u32; 2] = [720, 440];
const MARGIN: f64 = 14.0;
const LEGEND_ROW: f64 = 19.0;
const LEGEND_LINE: f64 = 30.0;
const LEGEND_GAP: f64 = 20.0;
const TICK: f64 = 4.0;
const SOLID_WIDTH: f64 = 1.5;
/// Wider than a solid line, so that either is seen where they coincide.
const DASHED_WIDTH: f64 = 2.5;
const DASH: f64 = 8.0;
const DASH_GAP: f64 = 6.0;
const DOT: f64 = 3.0;
const RING: f64 = 3.5;
/// Between the end of a guide and its label.
const GUIDE_GAP: f64 = 4.0;

/// Series with no more points than this show each as a dot.
const FEW_POINTS: usize = 24;
/// Columns per pixel, each of which keeps the highest and the lowest point of a long series.
const COLUMNS_PER_PIXEL: f64 = 2.0;

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

/// A chart of lines over two axes. Colours are chosen by the order of the series; a series of a few
/// points shows each of them as a dot.
#[derive(Debug, Clone, PartialEq)]
pub struct LineChart {
    /// Title; may be empty.
    pub title: String,
    /// What x is, with its unit: "Time (s)".
    pub x_label: String,
    /// What y is, with its unit: "ω₂ (rad/s)".
    pub y_label: String,
    /// Scale of the x axis.
    pub x_scale: Scale,
    /// Scale of the y axis.
    pub y_scale: Scale,
    /// The lines.
    pub series: Vec<Series>,
}

impl LineChart {
    /// Writes `<stem>.svg` and `<stem>.png` and returns the two paths. Long histories are thinned to
    /// the highest and lowest point of every half pixel, so that peaks survive.
    ///
    /// # Errors
    /// [`FigureError::Empty`] without any point, [`FigureError::NotFinite`],
    /// [`FigureError::NotPositive`] on a logarithmic axis, [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 2], FigureError> {
        self.check()?;
        save(self, stem.as_ref())
    }

    fn check(&self) -> Result<(), FigureError> {
        if self.series.iter().all(|series| series.points.is_empty()) {
            return Err(FigureError::Empty { figure: self.title.clone(), what: "point" });
        }
        for series in &self.series {
            for (index, &(x, y)) in series.points.iter().enumerate() {
                for (value, scale) in [(x, self.x_scale), (y, self.y_scale)] {
                    let (figure, label) = (self.title.clone(), series.label.clone());
                    if !value.is_finite() {
                        return Err(FigureError::NotFinite { figure, what: format!("series \"{label}\""), index });
                    }
                    if scale == Scale::Log && value <= 0.0 {
                        return Err(FigureError::NotPositive { figure, series: label, index, value });
                    }
                }
            }
        }
        Ok(())
    }

    /// The series of a stroke, each with its pen.
    fn with(&self, stroke: Stroke, unit: Unit) -> impl Iterator<Item = (&Series, Pen)> {
        let with_pens =
            self.series.iter().enumerate().map(move |(i, series)| (series, Pen::new(series.stroke, i, unit)));
        with_pens.filter(move |(series, _)| series.stroke == stroke)
    }

    /// Draws the legend in columns at the top of an area and returns the rest. plotters' own legend would hide a part of
    /// the lines, so it is not used.
    fn draw_legend<DB: DrawingBackend>(&self, area: Area<DB>, unit: Unit) -> Result<Area<DB>, FigureError> {
        let named = |(_, series): &(usize, &Series)| !series.label.is_empty() && series.stroke != Stroke::Guide;
        let entries: Vec<_> = self.series.iter().enumerate().filter(named).collect();
        let text = unit.text(TICK_EM, HPos::Left, VPos::Center);
        let mut width = 1;
        for (_, series) in &entries {
            width = width.max(unit.px(LEGEND_LINE + 6.0 + LEGEND_GAP) + text_width(&area, &series.label, unit)?);
        }
        let room = area.dim_in_pixel().0 as i32;
        let columns = (room / width).clamp(1, entries.len().max(1) as i32);
        let rows = entries.len().div_ceil(columns as usize);
        let (legend, rest) = area.split_vertically(unit.px(LEGEND_ROW * rows as f64));
        let side = (room - columns * width + unit.px(LEGEND_GAP)) / 2;
        let cells = legend.margin(0, 0, side, side - unit.px(LEGEND_GAP)).split_evenly((rows, columns as usize));
        for ((i, Series { label, stroke, .. }), cell) in entries.into_iter().zip(cells) {
            let height = unit.px(0.5 * LEGEND_ROW);
            let line = match stroke {
                Stroke::Rings => vec![(unit.px(0.5 * LEGEND_LINE), height)],
                _ => vec![(0, height), (unit.px(LEGEND_LINE), height)],
            };
            Pen::new(*stroke, i, unit).draw(&cell, line)?;
            cell.draw_text(label, &text, (unit.px(LEGEND_LINE + 6.0), height))?;
        }
        Ok(rest)
    }

    /// Room to the right of the axes: for the labels of guides, or half that of a tick.
    fn right_margin<DB: DrawingBackend>(&self, area: &Area<DB>, unit: Unit) -> Result<i32, FigureError> {
        let mut right = unit.px(0.8 * MARGIN);
        for (guide, _) in self.with(Stroke::Guide, unit) {
            right = right.max(unit.px(GUIDE_GAP) + text_width(area, &guide.label, unit)?);
        }
        Ok(right)
    }
}

impl Figure for LineChart {
    fn size(&self) -> [u32; 2] {
        SIZE
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = Axis::new(self.x_scale, points().map(|p| p.0), 0.0, 7);
        let y = Axis::new(self.y_scale, points().map(|p| p.1), 0.05, 6);

        let margin = unit.px(MARGIN);
        let area = picture.margin(unit.px(0.6 * MARGIN), margin, margin, margin);
        let area = self.draw_legend(titled(area, &self.title, TITLE_EM, unit)?, unit)?;

        let mut widest = 0;
        for label in y.labels() {
            widest = widest.max(text_width(&area, &label, unit)?);
        }
        let note_height = if y.note.is_empty() { 0.0 } else { TICK_EM };
        let mut chart = ChartBuilder::on(&area)
            .margin_top(unit.px(6.0 + note_height))
            .margin_right(self.right_margin(&area, unit)?)
            .x_label_area_size(unit.px(3.6 * LABEL_EM))
            .y_label_area_size(widest + unit.px(1.6 * LABEL_EM + 2.0 * TICK))
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .light_line_style(FAINT_GRID.stroke_width(unit.stroke(0.75)))
            .bold_line_style(GRID.stroke_width(unit.stroke(0.75)))
            .axis_style(INK.stroke_width(unit.stroke(1.0)))
            .label_style(unit.text(TICK_EM, HPos::Center, VPos::Top))
            .axis_desc_style(unit.text(LABEL_EM, HPos::Center, VPos::Top))
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .set_all_tick_mark_size(unit.px(TICK))
            .draw()?;

        let plot = chart.plotting_area();
        let shown =
            |series: &Series| -> Vec<Point> { series.points.iter().map(|p| (x.shown(p.0), y.shown(p.1))).collect() };
        let column = (x.range.1 - x.range.0) / (f64::from(SIZE[0]) * COLUMNS_PER_PIXEL);
        for (series, pen) in self.with(Stroke::Guide, unit) {
            for line in clipped(shown(series), x.range, y.range) {
                draw_guide_label(picture, plot, &line, &series.label, unit)?;
                pen.draw(plot, line)?;
            }
        }
        for (series, pen) in self.with(Stroke::Solid, unit).chain(self.with(Stroke::Dashed, unit)) {
            let points = shown(series);
            if points.len() <= FEW_POINTS {
                for point in points.iter().filter(|p| is_within(p.0, x.range) && is_within(p.1, y.range)) {
                    plot.draw(&Circle::new(*point, unit.px(DOT), pen.style.filled()))?;
                }
            }
            for line in clipped(points, x.range, y.range) {
                pen.draw(plot, thinned(line, column))?;
            }
        }

        let (across, down) = plot.get_pixel_range();
        let (left, right, top, bottom) = (across.start, across.end - 1, down.start, down.end - 1);
        let frame = vec![(left, bottom), (left, top), (right, top), (right, bottom), (left, bottom)];
        picture.draw(&PathElement::new(frame, INK.stroke_width(unit.stroke(1.0))))?;
        let above = (left, top - unit.px(3.0));
        let below = (right, picture.dim_in_pixel().1 as i32 - margin);
        for (note, side, place) in [(&y.note, HPos::Left, above), (&x.note, HPos::Right, below)] {
            if !note.is_empty() {
                picture.draw_text(note, &unit.text(TICK_EM, side, VPos::Bottom), place)?;
            }
        }
        for (series, pen) in self.with(Stroke::Rings, unit) {
            let points = shown(series).into_iter();
            pen.draw(plot, points.filter(|p| is_within(p.0, x.range) && is_within(p.1, y.range)).collect())?;
        }
        Ok(())
    }
}

/// How the line of a series is drawn.
struct Pen {
    stroke: Stroke,
    style: ShapeStyle,
    unit: Unit,
}

impl Pen {
    /// Of the series with this index.
    fn new(stroke: Stroke, i: usize, unit: Unit) -> Self {
        let (colour, width) = match stroke {
            Stroke::Solid => (COLOURS[i % COLOURS.len()], SOLID_WIDTH),
            Stroke::Dashed => (COLOURS[i % COLOURS.len()], DASHED_WIDTH),
            Stroke::Guide => (GUIDE, 1.0),
            Stroke::Rings => (INK, SOLID_WIDTH),
        };
        Self { stroke, style: colour.stroke_width(unit.stroke(width)), unit }
    }

    /// On a chart or on a legend.
    fn draw<DB: DrawingBackend, C: CoordTranslate<From: Clone + 'static>>(
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

/// In the margin if the line ends at the right edge, else to the left of its end.
fn draw_guide_label<DB: DrawingBackend, C: CoordTranslate<From = Point>>(
    picture: &Area<DB>,
    plot: &DrawingArea<DB, C>,
    line: &[Point],
    label: &str,
    unit: Unit,
) -> Result<(), FigureError> {
    let &[.., before, end] = line else { return Ok(()) };
    let [(x0, y0), (x, y)] = [before, end].map(|point| plot.map_coordinate(&point));
    let text =
        |horizontal| TextStyle { color: GUIDE_INK.to_backend_color(), ..unit.text(TICK_EM, horizontal, VPos::Center) };
    let gap = unit.px(GUIDE_GAP);
    if x >= plot.get_pixel_range().0.end - 2 {
        picture.draw_text(label, &text(HPos::Left), (x + gap, y))?;
    } else {
        let below = unit.px(TICK_EM);
        let back = if y0 > y { (x - x0) * below / (y0 - y) } else { 0 };
        picture.draw_text(label, &text(HPos::Right), (x - back - gap, y + below))?;
    }
    Ok(())
}

fn text_width<DB: DrawingBackend>(area: &Area<DB>, text: &str, unit: Unit) -> Result<i32, FigureError> {
    Ok(area.estimate_text_size(text, &unit.text(TICK_EM, HPos::Left, VPos::Center))?.0 as i32)
}

/// Whether a shown value lies on an axis, up to rounding.
fn is_within(value: f64, (low, high): (f64, f64)) -> bool {
    let rounding = 1e-9 * (high - low);
    (low - rounding..=high + rounding).contains(&value)
}
