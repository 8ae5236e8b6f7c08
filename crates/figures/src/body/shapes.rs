//! A grid of deformed bodies seen in space: mode shapes, snapshots.

use std::path::{Path, PathBuf};

use plotters::prelude::*;

use crate::FigureError;
use crate::body::facets::{self, Facets};
use crate::body::key::{self, colour_axis, draw_key, shade};
use crate::body::render::{Canvas, Grades, check_indices, check_points};
use crate::body::view::{Seen, View, Window};
use crate::document::formats::save;
use crate::document::picture::{Area, Figure, LABEL_EM, TITLE_EM, Unit, titled};

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 16.0;
const GAP: f64 = 14.0;
const CAPTION: f64 = 1.7 * LABEL_EM;
const GRADES: Grades = Grades { values: 64, lights: 12 };
pub(crate) const EDGE: RGBColor = RGBColor(40, 40, 40);
/// Width of edges, in pixels.
const LINE: f64 = 0.7;
const UNDEFORMED: RGBColor = RGBColor(150, 150, 150);

/// One body of a [`ShapeGrid`].
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title, for instance "Mode 1: 24.53 Hz".
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
    /// Name of the coloured quantity, with its unit.
    pub value_label: String,
    /// The surface, by indices of points; see [`facets()`](crate::facets()).
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
    /// Writes `<stem>.svg`, `<stem>.pdf` and `<stem>.png` and returns the three paths. Colours run from 0, or the smallest
    /// value of all panels if that is negative, to the largest. In the SVG and the PDF, bodies are vectors while they have
    /// up to 20 000 visible triangles and lines together, about two megabytes; else bitmaps. Texts are texts.
    ///
    /// # Errors
    /// [`FigureError::Unfit`] without panels or columns, and of lists that do not fit; [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 3], FigureError> {
        self.check()?;
        save(self, stem.as_ref())
    }

    fn check(&self) -> Result<(), FigureError> {
        let figure = self.title.as_str();
        if self.columns == 0 || self.panels.is_empty() {
            let what = if self.columns == 0 { "column" } else { "panel" };
            return Err(FigureError::empty(figure, what));
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

    /// Visible window of each panel with the undeformed body.
    fn windows(&self) -> Vec<Window> {
        let around =
            |panel: &Panel| Window::around(panel.points.iter().chain(self.undeformed).map(|p| self.view.see(p)));
        self.panels.iter().map(around).collect()
    }

    fn lines(&self) -> impl Iterator<Item = ([usize; 2], bool)> {
        let has_undeformed = !self.undeformed.is_empty();
        let edges = move |is_body: bool| self.edges.iter().map(move |edge| (edge.map(|i| i as usize), is_body));
        edges(true).chain(edges(false).filter(move |_| has_undeformed))
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
        [WIDTH, 2.0 * MARGIN + title + rows + key::HEIGHT].map(|length| length.ceil() as u32)
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let values = colour_axis(self.panels.iter().flat_map(|panel| panel.values.iter().copied()));
        let see = |points: &[[f64; 3]]| -> Vec<Seen> { points.iter().map(|point| self.view.see(point)).collect() };
        let undeformed = see(self.undeformed);
        let windows = self.windows();
        let [across, up] = largest(&windows);

        let margin = unit.px(MARGIN);
        let area = titled(picture.margin(margin, margin, margin, margin), &self.title, TITLE_EM, unit)?;
        let (grid, key) = area.split_vertically(area.dim_in_pixel().1 as i32 - unit.px(key::HEIGHT));
        draw_key(&key, &self.view, &values, &self.value_label, unit)?;

        let mut bodies = Vec::new();
        for ((panel, window), cell) in
            self.panels.iter().zip(windows).zip(grid.split_evenly((self.rows(), self.columns)))
        {
            let gap = unit.px(0.5 * GAP);
            let cell = titled(cell.margin(0, 2 * gap, gap, gap), &panel.title, LABEL_EM, unit)?;
            let shades: Vec<f64> = panel.values.iter().map(|value| shade(&values, *value)).collect();
            bodies.push(Body { cell, window, points: see(&panel.points), shades });
        }
        let canvas = |body: &Body<DB>| {
            let (width, height) = body.cell.dim_in_pixel();
            let fit = (f64::from(width) / across).min(f64::from(height) / up);
            let scale = 0.98 * if fit.is_finite() { fit } else { 1.0 };
            let mut canvas = Canvas::new([width, height], scale, body.window.centre(), GRADES);
            canvas.surface(self.triangles, &body.points, &body.shades);
            canvas
        };
        let thickness = LINE * unit.per_pixel();
        let ends = |body: &Body<DB>, edge: [usize; 2], is_body: bool| {
            let (points, colour) = if is_body { (&body.points, EDGE) } else { (&undeformed, UNDEFORMED) };
            (edge.map(|i| points[i]), colour)
        };

        let mut facets = unit.is_vector.then(Vec::new);
        let mut count = 0;
        for body in &bodies {
            let Some(drawn) = facets.as_mut() else { break };
            let canvas = canvas(body);
            let of_body = Facets::of(&canvas, self.triangles, &body.points, &body.shades, unit).map(|mut of_body| {
                for (edge, is_body) in self.lines() {
                    let ([from, to], colour) = ends(body, edge, is_body);
                    of_body.line(&canvas, &from, &to, thickness, colour);
                }
                of_body
            });
            count += of_body.as_ref().map_or(0, Facets::count);
            match of_body.filter(|_| count <= facets::MOST) {
                Some(of_body) => drawn.push(of_body),
                None => facets = None,
            }
        }
        if let Some(facets) = facets {
            return bodies.iter().zip(facets).try_for_each(|(body, facets)| facets.draw(&body.cell));
        }
        for body in &bodies {
            let mut canvas = canvas(body);
            for (edge, is_body) in self.lines() {
                let ([from, to], colour) = ends(body, edge, is_body);
                canvas.line(&from, &to, thickness, colour);
            }
            canvas.draw(&body.cell)?;
        }
        Ok(())
    }
}

/// A body as it is seen, and where it is drawn.
struct Body<DB: DrawingBackend> {
    cell: Area<DB>,
    window: Window,
    points: Vec<Seen>,
    /// Its values, from 0 to 1.
    shades: Vec<f64>,
}

/// The largest extents of all windows, to the right and up.
fn largest(windows: &[Window]) -> [f64; 2] {
    [0, 1].map(|axis| windows.iter().map(|window| window.size()[axis]).fold(0.0, f64::max))
}
