//! A grid of deformed bodies seen in space: mode shapes, snapshots.

use std::path::{Path, PathBuf};

use plotters::backend::DrawingBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::DrawingArea;
use plotters::element::{Rectangle, Text};
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color, RGBColor};

use crate::FigureError;
use crate::axis::{Axis, Scale};
use crate::picture::{Figure, INK, LABEL_EM, TICK_EM, TITLE_EM, Unit, save};
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
    /// What it shows, for instance "Mode 7: 24.53 Hz".
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

    fn top(&self) -> f64 {
        MARGIN + if self.title.is_empty() { 0.0 } else { 1.8 * TITLE_EM }
    }

    /// How the bodies are laid out.
    fn layout(&self) -> Layout {
        let see = |points: &[[f64; 3]]| points.iter().map(|point| self.view.see(point)).collect::<Vec<_>>();
        let undeformed = see(self.undeformed);
        let bodies: Vec<Vec<Seen>> = self.panels.iter().map(|panel| see(&panel.points)).collect();
        let windows: Vec<_> =
            bodies.iter().map(|body| Window::around(body.iter().chain(&undeformed).copied())).collect();
        let largest = |axis: usize| windows.iter().map(|w| w.size()[axis]).fold(0.0, f64::max);
        let extent = largest(0).max(largest(1));
        // A panel is as wide as the grid allows and as high as the largest body needs, up to a square.
        let columns = self.columns as f64;
        let width = ((WIDTH - 2.0 * MARGIN - (columns - 1.0) * GAP) / columns).floor();
        let scale = 0.99 * width / if extent > 0.0 { extent } else { 1.0 };
        let height = (scale * largest(1) * 1.02).ceil().max(24.0) + 4.0;
        Layout { undeformed, bodies, windows, panel: [width, height], scale }
    }

    fn draw_bar<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        values: &Axis,
        unit: Unit,
    ) -> Result<(), FigureError> {
        let side = unit.px(0.5 * (WIDTH - BAR[0]));
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

struct Layout {
    undeformed: Vec<Seen>,
    bodies: Vec<Vec<Seen>>,
    windows: Vec<Window>,
    /// Width and height of a panel in pixels.
    panel: [f64; 2],
    /// Pixels per unit of length.
    scale: f64,
}

impl Figure for ShapeGrid<'_> {
    fn size(&self) -> [u32; 2] {
        let rows = self.panels.len().div_ceil(self.columns) as f64;
        let [_, height] = self.layout().panel;
        [WIDTH, self.top() + rows * (CAPTION + height + GAP) + BAR_AREA + 0.5 * MARGIN]
            .map(|length| length.ceil() as u32)
    }

    fn draw<DB: DrawingBackend>(&self, picture: &DrawingArea<DB, Shift>, unit: Unit) -> Result<(), FigureError> {
        let Layout { undeformed, bodies, windows, panel: [width, height], scale } = self.layout();
        let values =
            Axis::new(Scale::Linear, self.panels.iter().flat_map(|panel| panel.values.iter().copied()), 0.0, 5);
        let (low, high) = values.range;
        let centred = |em| unit.text(em, HPos::Center, VPos::Top);
        if !self.title.is_empty() {
            picture.draw_text(&self.title, &centred(TITLE_EM), (unit.px(0.5 * WIDTH), unit.px(MARGIN)))?;
        }
        for (i, (panel, body)) in self.panels.iter().zip(&bodies).enumerate() {
            let (row, column) = (i / self.columns, i % self.columns);
            let left = MARGIN + column as f64 * (width + GAP);
            let above = (self.top() + row as f64 * (CAPTION + height + GAP)).floor();
            let caption = (unit.px(left + 0.5 * width), unit.px(above));
            picture.draw_text(&panel.title, &centred(LABEL_EM), caption)?;

            let shades: Vec<f64> =
                panel.values.iter().map(|value| (values.shown(*value) - low) / (high - low)).collect();
            let fine = unit.per_pixel();
            let size = [width, height].map(|length| (length * fine) as u32);
            let mut canvas = Canvas::new(size, scale * fine, windows[i].centre(), GRADES);
            canvas.surface(self.triangles, body, &shades);
            for (points, colour) in [(body, EDGE), (&undeformed, UNDEFORMED)] {
                for edge in self.edges.iter().filter(|_| !points.is_empty()) {
                    let [from, to] = edge.map(|i| points[i as usize]);
                    canvas.line(&from, &to, 0.7 * fine, colour);
                }
            }
            canvas.draw(picture, (unit.px(left), unit.px(above + CAPTION)))?;
        }
        let (_, bar) = picture.split_vertically(picture.dim_in_pixel().1 as i32 - unit.px(BAR_AREA + 0.5 * MARGIN));
        let (bar, _) = bar.split_vertically(unit.px(BAR_AREA));
        self.draw_bar(&bar, &values, unit)
    }
}
