//! A grid of deformed bodies seen in space: mode shapes, snapshots.

use crate::FigureError;
use crate::chart::{INK, LABEL_EM, TICK_EM, TITLE_EM};
use crate::picture::{Anchor, Picture};
use crate::render::{Canvas, Grades, check_indices, check_points, value_colour};
use crate::ticks;
use crate::view::{Seen, View, Window};
use plotters::style::RGBColor;
use std::path::{Path, PathBuf};

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 16.0;
const GAP: f64 = 14.0;
const BAR: [f64; 2] = [240.0, 10.0];
const FINENESS: u32 = 4;
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
        self.picture()?.save(stem.as_ref())
    }

    fn picture(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let see = |points: &[[f64; 3]]| points.iter().map(|point| self.view.see(point)).collect::<Vec<_>>();
        let undeformed = see(self.undeformed);
        let bodies: Vec<Vec<Seen>> = self.panels.iter().map(|panel| see(&panel.points)).collect();
        let windows: Vec<_> =
            bodies.iter().map(|body| Window::around(body.iter().chain(&undeformed).copied())).collect();
        let largest = |axis: usize| windows.iter().map(|w| w.size()[axis]).fold(0.0, f64::max);
        let extent = largest(0).max(largest(1));

        // The panel is as wide as the grid allows and as high as the largest body needs, up to a square.
        let columns = self.columns as f64;
        let panel_width = ((WIDTH - 2.0 * MARGIN - (columns - 1.0) * GAP) / columns).floor();
        let scale = 0.99 * panel_width / if extent > 0.0 { extent } else { 1.0 };
        let panel_height = (scale * largest(1) * 1.02).ceil().max(24.0) + 4.0;
        let caption = 1.7 * LABEL_EM;
        let rows = self.panels.len().div_ceil(self.columns) as f64;
        let top = MARGIN + if self.title.is_empty() { 0.0 } else { 1.8 * TITLE_EM };
        let bar_top = top + rows * (caption + panel_height + GAP) + 4.0;
        let height = bar_top + BAR[1] + 1.6 * TICK_EM + 1.7 * LABEL_EM + 0.5 * MARGIN;

        let mut picture = Picture::new(WIDTH as u32, height.ceil() as u32, FINENESS);
        picture.text([0.5 * WIDTH, MARGIN + TITLE_EM], &self.title, TITLE_EM, Anchor::Centre, INK);
        let (low, high) = self.value_range();
        for (i, (panel, body)) in self.panels.iter().zip(&bodies).enumerate() {
            let (row, column) = (i / self.columns, i % self.columns);
            let left = MARGIN + column as f64 * (panel_width + GAP);
            let above = (top + row as f64 * (caption + panel_height + GAP)).floor();
            let centre = [left + 0.5 * panel_width, above + LABEL_EM];
            picture.text(centre, &panel.title, LABEL_EM, Anchor::Centre, INK);

            let values: Vec<f64> = panel.values.iter().map(|value| (value - low) / (high - low)).collect();
            let fineness = f64::from(FINENESS);
            let size = [panel_width, panel_height].map(|length| (length * fineness) as u32);
            let mut canvas = Canvas::new(size, scale * fineness, windows[i].centre(), GRADES);
            canvas.surface(self.triangles, body, &values);
            for (points, width, colour) in [(body, 0.7, EDGE), (&undeformed, 0.7, UNDEFORMED)] {
                for edge in self.edges.iter().filter(|_| !points.is_empty()) {
                    let [from, to] = edge.map(|i| points[i as usize]);
                    canvas.line(&from, &to, width * fineness, colour);
                }
            }
            picture.bitmap([left, above + caption], size[0], size[1], canvas.into_rgb());
        }
        self.draw_bar(&mut picture, bar_top, (low, high));
        Ok(picture)
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

    fn value_range(&self) -> (f64, f64) {
        let values = self.panels.iter().flat_map(|panel| &panel.values);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        ticks::linear_range(low, high, 0.0)
    }

    fn draw_bar(&self, picture: &mut Picture, top: f64, (low, high): (f64, f64)) {
        let [width, height] = BAR;
        let left = 0.5 * (WIDTH - width);
        let steps = 120;
        for i in 0..steps {
            let at = |i: usize| left + width * i as f64 / steps as f64;
            let (from, to) = (at(i), at(i + 1));
            let colour = value_colour((i as f64 + 0.5) / steps as f64);
            picture.area(vec![[from, top], [to, top], [to, top + height], [from, top + height]], colour);
        }
        let ticks = ticks::linear(low, high, 5);
        for (value, label) in &ticks.major {
            let at = left + width * (value - low) / (high - low);
            picture.line(vec![[at, top + height], [at, top + height + 3.0]], INK, 1.0);
            picture.text([at, top + height + 1.4 * TICK_EM], label, TICK_EM, Anchor::Centre, INK);
        }
        picture.text([left + width + 14.0, top + height], &ticks.note, TICK_EM, Anchor::Left, INK);
        let below = top + height + 1.6 * TICK_EM + 1.2 * LABEL_EM;
        picture.text([0.5 * WIDTH, below], &self.value_label, LABEL_EM, Anchor::Centre, INK);
    }
}
