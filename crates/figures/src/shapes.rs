//! A grid of deformed bodies seen in space: mode shapes, snapshots.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::axis::{Axis, Scale};
use crate::picture::{Area, Figure, INK, LABEL_EM, TICK_EM, TITLE_EM, Unit, save, titled};
use crate::render::{Canvas, Grades, check_indices, check_points, value_colour};
use crate::view::{Seen, View, Window};

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 16.0;
const GAP: f64 = 14.0;
const BAR: [f64; 2] = [240.0, 10.0];
const CAPTION: f64 = 1.7 * LABEL_EM;
/// The colour bar with its labels.
const BAR_AREA: f64 = BAR[1] + 2.6 * LABEL_EM + 8.0;
const GRADES: Grades = Grades { values: 64, lights: 12 };
pub(crate) const EDGE: RGBColor = RGBColor(40, 40, 40);
const UNDEFORMED: RGBColor = RGBColor(150, 150, 150);

/// One body of a [`ShapeGrid`].
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it shows, for instance "Mode 1: 24.53 Hz".
    pub title: String,
    /// Places of the points in the deformed body.
    pub points: Vec<[f64; 3]>,
    /// A value per point, shown as colour, for instance the size of the displacement.
    pub values: Vec<f64>,
}

/// Deformed bodies of one mesh, all at the same scale, with one colour bar.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeGrid<'a> {
    /// Title of the figure; may be empty.
    pub title: String,
    /// What the colours mean, with its unit.
    pub value_label: String,
    /// The surface, by indices of points; see [`boundary_triangles`](crate::boundary_triangles).
    pub triangles: &'a [[u32; 3]],
    /// Edges drawn as lines, by indices of points; see [`sharp_edges`](crate::sharp_edges).
    pub edges: &'a [[u32; 2]],
    /// Places of the points in the undeformed body, whose edges are drawn in grey; empty for none.
    pub undeformed: &'a [[f64; 3]],
    /// The bodies, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// From where they are seen.
    pub view: View,
}

impl ShapeGrid<'_> {
    /// Writes `<stem>.svg` and `<stem>.png` and returns the two paths. Colours run from the smallest
    /// value of all panels to the largest. The bodies are a bitmap inside the SVG, texts are texts.
    ///
    /// # Errors
    /// [`FigureError::Empty`] without panels or columns, [`FigureError::WrongLength`],
    /// [`FigureError::NoSuchPoint`], [`FigureError::NotFinite`], [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 2], FigureError> {
        self.check()?;
        save(self, stem.as_ref())
    }

    fn check(&self) -> Result<(), FigureError> {
        let figure = self.title.as_str();
        if self.columns == 0 || self.panels.is_empty() {
            let what = if self.columns == 0 { "column" } else { "panel" };
            return Err(FigureError::Empty { figure: figure.into(), what });
        }
        let count = self.panels[0].points.len();
        check_indices(figure, "a triangle", self.triangles, count)?;
        check_indices(figure, "an edge", self.edges, count)?;
        if !self.undeformed.is_empty() {
            check_points(figure, "undeformed body", count, self.undeformed, &vec![0.0; count])?;
        }
        for panel in &self.panels {
            check_points(figure, &format!("panel \"{}\"", panel.title), count, &panel.points, &panel.values)?;
        }
        Ok(())
    }

    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }

    /// What is seen of each panel with the undeformed body.
    fn windows(&self) -> Vec<Window> {
        let around =
            |panel: &Panel| Window::around(panel.points.iter().chain(self.undeformed).map(|p| self.view.see(p)));
        self.panels.iter().map(around).collect()
    }

    fn draw_bar<DB: DrawingBackend>(&self, area: &Area<DB>, values: &Axis, unit: Unit) -> Result<(), FigureError> {
        let side = unit.px(0.5 * (WIDTH - BAR[0]) - MARGIN);
        let mut chart = ChartBuilder::on(area)
            .margin_left(side)
            .margin_right(side)
            .x_label_area_size(area.dim_in_pixel().1 as i32 - unit.px(BAR[1]))
            .build_cartesian_2d(values.clone(), 0.0..1.0)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .axis_style(INK.stroke_width(unit.stroke(1.0)))
            .label_style(unit.text(TICK_EM, HPos::Center, VPos::Top))
            .axis_desc_style(unit.text(LABEL_EM, HPos::Center, VPos::Top))
            .x_desc(&self.value_label)
            .set_all_tick_mark_size(unit.px(3.0))
            .draw()?;
        let steps = 120;
        let (low, high) = values.range;
        let at = |i: usize| low + (high - low) * i as f64 / steps as f64;
        chart.draw_series((0..steps).map(|i| {
            let colour = value_colour((i as f64 + 0.5) / steps as f64);
            Rectangle::new([(at(i), 0.0), (at(i + 1), 1.0)], colour.filled())
        }))?;
        if !values.note.is_empty() {
            let (across, down) = chart.plotting_area().get_pixel_range();
            let text = unit.text(TICK_EM, HPos::Left, VPos::Bottom);
            let screen = area.use_screen_coord();
            screen.draw(&Text::new(values.note.as_str(), (across.end + unit.px(14.0), down.end), text))?;
        }
        Ok(())
    }
}

impl Figure for ShapeGrid<'_> {
    /// Panels are as wide as the grid allows and as high as the largest body needs, up to a square.
    fn size(&self) -> [u32; 2] {
        let [across, up] = largest(&self.windows());
        let width = (WIDTH - 2.0 * MARGIN) / self.columns as f64 - GAP;
        let height = (width * up / across.max(up)).max(24.0); // which leaves out what is no number, too
        let title = if self.title.is_empty() { 0.0 } else { 1.8 * TITLE_EM };
        let rows = self.rows() as f64 * (CAPTION + height + GAP);
        [WIDTH, 2.0 * MARGIN + title + rows + BAR_AREA].map(|length| length.ceil() as u32)
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let values =
            Axis::new(Scale::Linear, self.panels.iter().flat_map(|panel| panel.values.iter().copied()), 0.0, 5);
        let (low, high) = values.range;
        let see = |points: &[[f64; 3]]| -> Vec<Seen> { points.iter().map(|point| self.view.see(point)).collect() };
        let undeformed = see(self.undeformed);
        let windows = self.windows();
        let [across, up] = largest(&windows);

        let margin = unit.px(MARGIN);
        let area = titled(picture.margin(margin, margin, margin, margin), &self.title, TITLE_EM, unit)?;
        let (grid, bar) = area.split_vertically(area.dim_in_pixel().1 as i32 - unit.px(BAR_AREA));
        let cells = grid.split_evenly((self.rows(), self.columns));
        for ((panel, window), cell) in self.panels.iter().zip(windows).zip(cells) {
            let gap = unit.px(0.5 * GAP);
            let cell = titled(cell.margin(0, 2 * gap, gap, gap), &panel.title, LABEL_EM, unit)?;
            let (width, height) = cell.dim_in_pixel();
            let fit = (f64::from(width) / across).min(f64::from(height) / up);
            let scale = 0.98 * if fit.is_finite() { fit } else { 1.0 };
            let mut canvas = Canvas::new([width, height], scale, window.centre(), GRADES);
            let body = see(&panel.points);
            let shades: Vec<f64> =
                panel.values.iter().map(|value| (values.shown(*value) - low) / (high - low)).collect();
            canvas.surface(self.triangles, &body, &shades);
            for (points, colour) in [(&body, EDGE), (&undeformed, UNDEFORMED)] {
                for edge in self.edges.iter().filter(|_| !points.is_empty()) {
                    let [from, to] = edge.map(|i| points[i as usize]);
                    canvas.line(&from, &to, 0.7 * unit.per_pixel(), colour);
                }
            }
            canvas.draw(&cell)?;
        }
        self.draw_bar(&bar, &values, unit)
    }
}

/// The largest extents of all windows, to the right and up.
fn largest(windows: &[Window]) -> [f64; 2] {
    [0, 1].map(|axis| windows.iter().map(|window| window.size()[axis]).fold(0.0, f64::max))
}
