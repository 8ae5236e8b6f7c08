//! Small multiples: one line a panel, all over the same axes.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::chart::axis::{Axis, Scale};
use crate::chart::lines::{MARGIN, Noise, Reference, Y_MARGIN, check_series};
use crate::chart::plot::Plot;
use crate::chart::series::Series;
use crate::document::formats::save;
use crate::document::picture::{Area, Figure, LABEL_EM, TICK_EM, TITLE_EM, Unit, titled};

const WIDTH: u32 = 720;
const PANEL_HEIGHT: u32 = 130;
/// Titles above the panels, and the label of the x axes below them.
const HEAD: u32 = 90;

/// Lines that would hide one another in one chart, each in a panel of its own over the same linear axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartGrid {
    /// Title; may be empty.
    pub title: String,
    /// Name of x, with its unit: "Time (s)".
    pub x_label: String,
    /// Name of y, with its unit.
    pub y_label: String,
    /// The lines, row by row; their labels are the titles of the panels.
    pub series: Vec<Series>,
    /// Panels in a row.
    pub columns: usize,
    /// The quantity beside which the values are small; see [`LineChart::reference`](crate::LineChart::reference).
    pub reference: Option<Reference>,
}

impl ChartGrid {
    /// Writes `<stem>.svg`, `<stem>.pdf` and `<stem>.png` and returns the three paths.
    ///
    /// # Errors
    /// [`FigureError::Unfit`] without columns or any point, and of numbers that are not finite; [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 3], FigureError> {
        if self.columns == 0 {
            return Err(FigureError::empty(&self.title, "column"));
        }
        check_series(&self.title, &self.series, [Scale::Linear; 2])?;
        save(self, stem.as_ref())
    }

    fn rows(&self) -> usize {
        self.series.len().div_ceil(self.columns)
    }
}

impl Figure for ChartGrid {
    fn size(&self) -> [u32; 2] {
        [WIDTH, HEAD + PANEL_HEIGHT * self.rows() as u32]
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let noise = Noise::of(self.reference.as_ref(), &self.series);
        let around = noise.iter().flat_map(|noise| noise.values());
        let x = Axis::new(Scale::Linear, points().map(|p| p.0), 0.0, 5);
        let y = Axis::new(Scale::Linear, points().map(|p| p.1).chain(around), Y_MARGIN, 3);

        let margin = unit.px(MARGIN);
        let area = picture.margin(unit.px(0.6 * MARGIN), margin, margin, margin);
        let mut area = titled(area, &self.title, TITLE_EM, unit)?;
        if let Some(noise) = noise {
            area = titled(area, &noise.in_words(), TICK_EM, unit)?;
        }
        let (beside, below) = (unit.px(1.4 * LABEL_EM), unit.px(1.2 * LABEL_EM));
        let (width, height) = area.dim_in_pixel();
        let (middle, centre) = ((height as i32 - below) / 2, (width as i32 + beside) / 2);
        let text = unit.text(LABEL_EM, HPos::Center, VPos::Top);
        area.draw_text(&self.y_label, &text.transform(FontTransform::Rotate270), (0, middle))?;
        let text = unit.text(LABEL_EM, HPos::Center, VPos::Bottom);
        area.draw_text(&self.x_label, &text, (centre, height as i32))?;
        let cells = area.margin(0, below, beside, 0).split_evenly((self.rows(), self.columns));
        for (series, cell) in self.series.iter().zip(cells) {
            let title = &series.label;
            let series = std::slice::from_ref(series);
            Plot { x: x.clone(), y: y.clone(), title, x_label: "", y_label: "", series }.draw(&cell, unit)?;
        }
        Ok(())
    }
}
