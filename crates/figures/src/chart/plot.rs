//! Two axes and the lines between them.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::chart::axis::Axis;
use crate::chart::path::{Point, clipped, thinned};
use crate::chart::series::{Pen, Series, Stroke};
use crate::document::picture::{Area, INK, LABEL_EM, TICK_EM, Unit};

const GRID: RGBColor = RGBColor(222, 222, 222);
const FAINT_GRID: RGBColor = RGBColor(240, 240, 240);
const GUIDE_INK: RGBColor = RGBColor(95, 95, 95);

// Lengths in pixels.
const TICK: f64 = 4.0;
const DOT: f64 = 3.0;
/// Room to the right of the axes, for half the label of a tick.
const RIGHT: f64 = 11.0;
/// Between the end of a guide and its label.
const GUIDE_GAP: f64 = 4.0;

/// Series with no more points than this show each as a dot.
const FEW_POINTS: usize = 24;
/// Columns over the width of a plot, each of which keeps the highest and the lowest point of a long series.
const COLUMNS: f64 = 1440.0;

/// Two axes and lines.
pub(crate) struct Plot<'a> {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Title above the middle; may be empty.
    pub(crate) title: &'a str,
    /// Labels of the two axes; may be empty.
    pub(crate) x_label: &'a str,
    pub(crate) y_label: &'a str,
    pub(crate) series: &'a [Series],
}

impl Plot<'_> {
    /// Draws all of it and returns the part of the area that lies between the axes.
    pub(crate) fn draw<DB: DrawingBackend>(&self, area: &Area<DB>, unit: Unit) -> Result<Area<DB>, FigureError> {
        let Self { x, y, .. } = self;
        let mut widest = 0;
        for label in y.labels() {
            widest = widest.max(text_width(area, &label, unit)?);
        }
        let above = if y.note.is_empty() && self.title.is_empty() { 0.0 } else { TICK_EM };
        let [below, beside] = [(self.x_label, 1.8), (self.y_label, 1.6)]
            .map(|(label, lines)| if label.is_empty() { 0.0 } else { lines * LABEL_EM });
        let mut chart = ChartBuilder::on(area)
            .margin_top(unit.px(6.0 + above))
            .margin_right(self.right_margin(area, unit)?)
            .x_label_area_size(unit.px(1.8 * LABEL_EM + below))
            .y_label_area_size(widest + unit.px(beside + 2.0 * TICK))
            .build_cartesian_2d(x.clone(), y.clone())?;
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(FAINT_GRID.stroke_width(unit.stroke(0.75)))
            .bold_line_style(GRID.stroke_width(unit.stroke(0.75)))
            .axis_style(INK.stroke_width(unit.stroke(1.0)))
            .label_style(unit.text(TICK_EM, HPos::Center, VPos::Top))
            .axis_desc_style(unit.text(LABEL_EM, HPos::Center, VPos::Top))
            .set_all_tick_mark_size(unit.px(TICK));
        if !self.x_label.is_empty() {
            mesh.x_desc(self.x_label);
        }
        if !self.y_label.is_empty() {
            mesh.y_desc(self.y_label);
        }
        mesh.draw()?;

        let plot = chart.plotting_area();
        let shown =
            |series: &Series| -> Vec<Point> { series.points.iter().map(|p| (x.shown(p.0), y.shown(p.1))).collect() };
        let is_inside = |p: &Point| is_within(p.0, x.range) && is_within(p.1, y.range);
        let screen = area.use_screen_coord();
        for (series, pen) in self.with(Stroke::Guide, unit) {
            for line in clipped(shown(series), x.range, y.range) {
                draw_guide_label(&screen, plot, &line, &series.label, unit)?;
                pen.draw(plot, line)?;
            }
        }
        let column = (x.range.1 - x.range.0) / COLUMNS;
        for (series, pen) in self.with(Stroke::Solid, unit).chain(self.with(Stroke::Dashed, unit)) {
            let points = shown(series);
            if points.len() <= FEW_POINTS {
                for point in points.iter().filter(|point| is_inside(point)) {
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
        screen.draw(&PathElement::new(frame, INK.stroke_width(unit.stroke(1.0))))?;
        let (above, below) = (top - unit.px(3.0), area.get_pixel_range().1.end);
        for (text, side, place) in [
            (y.note.as_str(), HPos::Left, (left, above)),
            (self.title, HPos::Center, ((left + right) / 2, above)),
            (x.note.as_str(), HPos::Right, (right, below)),
        ] {
            if !text.is_empty() {
                screen.draw(&Text::new(text, place, unit.text(TICK_EM, side, VPos::Bottom)))?;
            }
        }
        for (series, pen) in self.with(Stroke::Rings, unit) {
            pen.draw(plot, shown(series).into_iter().filter(is_inside).collect())?;
        }
        Ok(plot.strip_coord_spec())
    }

    /// The series of a stroke, each with its pen.
    fn with(&self, stroke: Stroke, unit: Unit) -> impl Iterator<Item = (&Series, Pen)> {
        let with_pens =
            self.series.iter().enumerate().map(move |(i, series)| (series, Pen::new(series.stroke, i, unit)));
        with_pens.filter(move |(series, _)| series.stroke == stroke)
    }

    /// Room to the right of the axes: for the labels of guides, or half that of a tick.
    fn right_margin<DB: DrawingBackend>(&self, area: &Area<DB>, unit: Unit) -> Result<i32, FigureError> {
        let mut right = unit.px(RIGHT);
        for (guide, _) in self.with(Stroke::Guide, unit) {
            right = right.max(unit.px(GUIDE_GAP) + text_width(area, &guide.label, unit)?);
        }
        Ok(right)
    }
}

/// In the margin if the line ends at the right edge, else to the left of its end.
fn draw_guide_label<DB: DrawingBackend, C: CoordTranslate<From = Point>>(
    screen: &Area<DB>,
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
        screen.draw(&Text::new(label, (x + gap, y), text(HPos::Left)))?;
    } else {
        let below = unit.px(TICK_EM);
        let back = if y0 > y { (x - x0) * below / (y0 - y) } else { 0 };
        screen.draw(&Text::new(label, (x - back - gap, y + below), text(HPos::Right)))?;
    }
    Ok(())
}

/// Width of a text of the size of tick labels, in units.
pub(crate) fn text_width<DB: DrawingBackend>(area: &Area<DB>, text: &str, unit: Unit) -> Result<i32, FigureError> {
    Ok(area.estimate_text_size(text, &unit.text(TICK_EM, HPos::Left, VPos::Center))?.0 as i32)
}

/// True if a shown value lies on an axis, up to rounding.
fn is_within(value: f64, (low, high): (f64, f64)) -> bool {
    let rounding = 1e-9 * (high - low);
    (low - rounding..=high + rounding).contains(&value)
}
