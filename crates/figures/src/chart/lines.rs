//! Line charts with linear or logarithmic axes.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::chart::axis::{Axis, Scale, power_of_ten};
use crate::chart::inset::Inset;
use crate::chart::plot::{Plot, text_width};
use crate::chart::series::{GUIDE, Pen, Series, Stroke};
use crate::document::formats::{save, svg_file};
use crate::document::picture::{Area, Figure, TICK_EM, TITLE_EM, Unit, titled};

// Lengths in pixels.
const SIZE: [u32; 2] = [720, 440];
pub(crate) const MARGIN: f64 = 14.0;
const LEGEND_ROW: f64 = 19.0;
const LEGEND_LINE: f64 = 30.0;
const LEGEND_GAP: f64 = 20.0;

/// Margin above and below the values on a linear y axis, as a part of their extent.
pub(crate) const Y_MARGIN: f64 = 0.05;

/// Values below this part of their [`Reference`] are numerical noise: rounding, and what iterations leave over in
/// mode shapes.
const NOISE: f64 = 1e-7;

/// The quantity beside which the values of a chart are small, where they would be zero but for the numerics.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Its name: "the peak of α₂".
    pub name: String,
    /// Its size, in the unit of the y axis. If that is zero, it is as if there were none.
    pub value: f64,
}

/// A chart of lines over two axes. Colours are chosen by the order of the series; one without points keeps its colour, so
/// that charts of the same series have the same colours, and is not in the legend. A series of a few points shows each of
/// them as a dot. Where all happens within a tenth of a linear x axis, an inset shows that part.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LineChart {
    /// Title; may be empty.
    pub title: String,
    /// Name of x, with its unit: "Time (s)".
    pub x_label: String,
    /// Name of y, with its unit: "ω₂ (rad/s)".
    pub y_label: String,
    /// Scale of the x axis.
    pub x_scale: Scale,
    /// Scale of the y axis.
    pub y_scale: Scale,
    /// The lines.
    pub series: Vec<Series>,
    /// The quantity beside which the values are small. A line below the title says how small; below 1e-7 of it they are called
    /// numerical noise, and a linear y axis reaches as far as the reference does.
    pub reference: Option<Reference>,
}

impl LineChart {
    /// True without any point: then there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        without_points(&self.series)
    }

    /// Writes `<stem>.svg`, `<stem>.pdf` and `<stem>.png` and returns the three paths. Long histories are thinned to
    /// the highest and lowest point of every half pixel, so that peaks survive.
    ///
    /// # Errors
    /// [`FigureError::Unfit`] without any point, of numbers that are not finite, and not positive on a logarithmic axis;
    /// [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 3], FigureError> {
        self.check()?;
        save(self, stem.as_ref())
    }

    /// Writes an SVG only.
    ///
    /// # Errors
    /// As [`LineChart::save`].
    pub fn save_svg(&self, path: impl AsRef<Path>) -> Result<(), FigureError> {
        self.check()?;
        svg_file(self, path.as_ref())
    }

    pub(crate) fn check(&self) -> Result<(), FigureError> {
        check_series(&self.title, &self.series, [self.x_scale, self.y_scale])
    }

    /// Draws the legend in columns at the top of an area and returns the rest. plotters' own legend would hide a part of
    /// the lines, so it is not used.
    fn draw_legend<DB: DrawingBackend>(&self, area: Area<DB>, unit: Unit) -> Result<Area<DB>, FigureError> {
        let listed =
            |series: &Series| !series.label.is_empty() && !series.points.is_empty() && series.stroke != Stroke::Guide;
        let entries: Vec<_> = self.series.iter().enumerate().filter(|(_, series)| listed(series)).collect();
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

    /// An inset over the plot, where one is called for, with lines to it from what it shows.
    fn draw_inset<DB: DrawingBackend>(
        &self,
        plot: &Area<DB>,
        x: &Axis,
        y: &Axis,
        unit: Unit,
    ) -> Result<(), FigureError> {
        let both_linear = self.x_scale == Scale::Linear && self.y_scale == Scale::Linear;
        let Some(inset) = Inset::of(&self.series, x.values(), y.values()).filter(|_| both_linear) else {
            return Ok(());
        };
        let (width, height) = plot.dim_in_pixel();
        let across = |part: f64| (part * f64::from(width)).round() as i32;
        let down = |part: f64| ((1.0 - part) * f64::from(height)).round() as i32;
        let (left, right) = (across(inset.across.0), across(inset.across.1));
        let (top, bottom) = (down(inset.up.1), down(inset.up.0));
        let (low, high) = x.values();
        let from = across((inset.edge - low) / (high - low));
        let to = if from < left { left } else { right };
        let pen = GUIDE.stroke_width(unit.stroke(0.75));
        for (start, end) in [(0, top), (height as i32 - 1, bottom)] {
            plot.draw(&PathElement::new(vec![(from, start), (to, end)], pen))?;
        }
        let area = plot.clone().shrink((left, top), (right - left, bottom - top));
        area.fill(&WHITE)?;
        plot.draw(&Rectangle::new([(left, top), (right, bottom)], pen))?;
        let window = |(low, high): (f64, f64)| Axis::new(Scale::Window(low, high), [], 0.0, 4);
        let (x, y) = (window(inset.x), window(y.values()));
        let area = area.margin(0, 0, unit.px(4.0), 0);
        Plot { x, y, title: "", x_label: "", y_label: "", series: &self.series }.draw(&area, unit)?;
        Ok(())
    }
}

impl Figure for LineChart {
    fn size(&self) -> [u32; 2] {
        SIZE
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let noise = Noise::of(self.reference.as_ref(), &self.series);
        let around = noise.iter().flat_map(|noise| noise.values());
        let x = Axis::new(self.x_scale, points().map(|p| p.0), 0.0, 7);
        let y = Axis::new(self.y_scale, points().map(|p| p.1).chain(around), Y_MARGIN, 6);

        let margin = unit.px(MARGIN);
        let area = picture.margin(unit.px(0.6 * MARGIN), margin, margin, margin);
        let mut area = titled(area, &self.title, TITLE_EM, unit)?;
        if let Some(noise) = noise {
            area = titled(area, &noise.in_words(), TICK_EM, unit)?;
        }
        let area = self.draw_legend(area, unit)?;
        let plot = Plot {
            x: x.clone(),
            y: y.clone(),
            title: "",
            x_label: &self.x_label,
            y_label: &self.y_label,
            series: &self.series,
        };
        self.draw_inset(&plot.draw(&area, unit)?, &x, &y, unit)
    }
}

fn without_points(series: &[Series]) -> bool {
    series.iter().all(|series| series.points.is_empty())
}

/// Refuses series that cannot be drawn over axes of these scales, x and y.
pub(crate) fn check_series(title: &str, series: &[Series], scales: [Scale; 2]) -> Result<(), FigureError> {
    if without_points(series) {
        return Err(FigureError::empty(title, "point"));
    }
    for series in series {
        for (index, &(x, y)) in series.points.iter().enumerate() {
            for (value, scale) in [x, y].into_iter().zip(scales) {
                let label = &series.label;
                if !value.is_finite() {
                    let words = format!("has a value that is not finite: series \"{label}\", entry {index}");
                    return Err(FigureError::unfit(title, words));
                }
                if scale == Scale::Log && value <= 0.0 {
                    return Err(FigureError::unfit(
                        title,
                        format!(
                            "has a logarithmic axis but series \"{label}\" holds {value}, entry {index}; leave the entry out or use a linear axis"
                        ),
                    ));
                }
            }
        }
    }
    Ok(())
}

/// How small the values of a chart are.
pub(crate) struct Noise<'a> {
    reference: &'a Reference,
    /// The largest |y|.
    largest: f64,
}

impl<'a> Noise<'a> {
    /// Noise of all points; `None` without a reference.
    pub(crate) fn of(reference: Option<&'a Reference>, series: &[Series]) -> Option<Self> {
        let largest = series.iter().flat_map(|series| &series.points).map(|point| point.1.abs()).fold(0.0, f64::max);
        Some(Self { reference: reference.filter(|reference| reference.value > 0.0)?, largest })
    }

    fn is_noise(&self) -> bool {
        self.largest <= NOISE * self.reference.value
    }

    /// Values that the y axis has to hold besides the points, so that noise is not enlarged to fill it.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> {
        let value = self.reference.value;
        [-value, value].into_iter().filter(|_| self.is_noise())
    }

    pub(crate) fn in_words(&self) -> String {
        let Reference { name, value } = self.reference;
        let (largest, part) = (power_of_ten(self.largest), power_of_ten(self.largest / value));
        let what = if self.is_noise() { "numerical noise: " } else { "" };
        format!("{what}at most {largest}, {part} of {name}")
    }
}
