//! Charts one below another.

use std::path::{Path, PathBuf};

use plotters::prelude::*;

use crate::FigureError;
use crate::chart::lines::LineChart;
use crate::document::formats::{save, svg};
use crate::document::picture::{Area, Figure, TITLE_EM, Unit, titled};

const WIDTH: u32 = 720;
const CHART_HEIGHT: u32 = 300;
/// The title above the charts.
const HEAD: u32 = 30;

/// Charts one below another, each with axes of its own, such as one a unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChartStack {
    /// Title; may be empty.
    pub title: String,
    /// The charts, from the top.
    pub charts: Vec<LineChart>,
}

impl ChartStack {
    /// Writes `<stem>.svg`, `<stem>.pdf` and `<stem>.png` and returns the three paths.
    ///
    /// # Errors
    /// As [`LineChart::save`], for any of the charts.
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 3], FigureError> {
        self.check()?;
        save(self, stem.as_ref())
    }

    /// The text of the SVG.
    ///
    /// # Errors
    /// As [`Self::save`].
    pub fn svg(&self) -> Result<String, FigureError> {
        self.check()?;
        svg(self)
    }

    fn check(&self) -> Result<(), FigureError> {
        if self.charts.is_empty() {
            return Err(FigureError::empty(&self.title, "chart"));
        }
        self.charts.iter().try_for_each(LineChart::check)
    }
}

impl From<LineChart> for ChartStack {
    /// The stack of one chart, which keeps its title.
    fn from(chart: LineChart) -> Self {
        Self { title: String::new(), charts: vec![chart] }
    }
}

impl Figure for ChartStack {
    fn size(&self) -> [u32; 2] {
        match &self.charts[..] {
            [chart] if self.title.is_empty() => chart.size(),
            charts => [WIDTH, HEAD + CHART_HEIGHT * charts.len() as u32],
        }
    }

    /// A tall bitmap takes longer than the answer that it shows.
    fn dots(&self) -> u32 {
        if self.charts.len() > 2 { 1 } else { 2 }
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let top = if self.title.is_empty() { 0.0 } else { 8.0 };
        let area = titled(picture.margin(unit.px(top), 0, 0, 0), &self.title, TITLE_EM, unit)?;
        let cells = area.split_evenly((self.charts.len(), 1));
        self.charts.iter().zip(cells).try_for_each(|(chart, cell)| chart.draw(&cell, unit))
    }
}
