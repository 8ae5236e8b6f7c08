//! Line charts with linear or logarithmic axes.

use crate::picture::{Anchor, Picture, Place};
use crate::ticks::{self, Ticks};
use crate::{FigureError, font};
use plotters::style::RGBColor;
use std::path::{Path, PathBuf};

/// Okabe and Ito's colours, told apart by all common kinds of colour vision; the light ones last.
pub(crate) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
const GRID: RGBColor = RGBColor(222, 222, 222);
const GUIDE: RGBColor = RGBColor(150, 150, 150);
const GUIDE_INK: RGBColor = RGBColor(95, 95, 95);
const PAPER: RGBColor = RGBColor(255, 255, 255);
const FAINT_GRID: RGBColor = RGBColor(240, 240, 240);

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 440.0;
const MARGIN: f64 = 14.0;
/// Sizes of letters, in pixels per em.
pub(crate) const TITLE_EM: f64 = 14.0;
pub(crate) const LABEL_EM: f64 = 13.0;
pub(crate) const TICK_EM: f64 = 11.5;
const LEGEND_ROW: f64 = 19.0;
const LEGEND_GAP: f64 = 5.0;
const LEGEND_LINE: f64 = 30.0;
const TICK_LENGTH: f64 = 4.0;
const SOLID_WIDTH: f64 = 1.5;
const GUIDE_WIDTH: f64 = 1.0;
/// Between the end of a guide and its label.
const GUIDE_GAP: f64 = 4.0;
/// Wider than a solid line, so that either is seen where they coincide.
const DASHED_WIDTH: f64 = 2.5;
const DASH: [f64; 2] = [8.0, 6.0];
/// Coordinates per pixel.
const FINENESS: u32 = 4;
/// Series with no more points than this show each as a dot.
const FEW_POINTS: usize = 24;
const DOT_RADIUS: f64 = 3.0;
const RING_RADIUS: f64 = 4.0;
/// Series with more points than this are thinned.
const MANY_POINTS: usize = 3000;
/// Columns per pixel, each of which keeps the highest and the lowest point of a thinned series.
const COLUMNS_PER_PIXEL: f64 = 2.0;

/// How an axis maps values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Evenly, between two values, the lower one first: lines are cut off there, and points beyond are left out.
    Window(f64, f64),
    /// By decades; values must be positive.
    Log,
}

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

impl Series {
    fn is_in_legend(&self) -> bool {
        !self.label.is_empty() && self.stroke != Stroke::Guide
    }
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

/// An axis on the picture: from pixel `start` to pixel `end`.
struct Axis {
    scale: Scale,
    /// In decades if the scale is logarithmic.
    range: (f64, f64),
    start: f64,
    end: f64,
    ticks: Ticks,
}

impl Axis {
    fn pixel(&self, value: f64) -> f64 {
        let value = match self.scale {
            Scale::Linear | Scale::Window(..) => value,
            Scale::Log => value.log10(),
        };
        let (min, max) = self.range;
        self.start + (value - min) / (max - min) * (self.end - self.start)
    }

    fn new(scale: Scale, values: impl Iterator<Item = f64>, margin: f64, ticks: usize) -> Self {
        let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
        let (range, ticks) = match scale {
            Scale::Linear => {
                let (min, max) = ticks::linear_range(min, max, margin);
                ((min, max), ticks::linear(min, max, ticks))
            }
            Scale::Window(min, max) => ((min, max), ticks::linear(min, max, ticks)),
            Scale::Log => {
                let (low, high) = ticks::decades(min, max);
                ((f64::from(low), f64::from(high)), ticks::logarithmic((low, high), ticks))
            }
        };
        Self { scale, range, start: 0.0, end: 1.0, ticks }
    }
}

impl LineChart {
    /// Writes `<stem>.svg` and `<stem>.png` and returns the two paths. Long histories are thinned to
    /// the highest and lowest point of every half pixel, so that peaks survive.
    ///
    /// # Errors
    /// [`FigureError::Empty`] without any point, [`FigureError::NotFinite`],
    /// [`FigureError::NotPositive`] on a logarithmic axis, [`FigureError::Write`].
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<[PathBuf; 2], FigureError> {
        self.picture()?.save(stem.as_ref())
    }

    fn picture(&self) -> Result<Picture, FigureError> {
        self.check()?;
        let points = || self.series.iter().flat_map(|series| &series.points);
        let mut x = Axis::new(self.x_scale, points().map(|p| p.0), 0.0, 7);
        let mut y = Axis::new(self.y_scale, points().map(|p| p.1), 0.05, 6);

        let legend = self.legend_rows()?;
        let mut widest = 0.0_f64;
        for (_, label) in &y.ticks.major {
            widest = widest.max(font::width(label, TICK_EM)?);
        }
        let top = MARGIN
            + if self.title.is_empty() { 0.0 } else { 1.6 * TITLE_EM }
            + LEGEND_ROW * legend.len() as f64
            + if legend.is_empty() && self.title.is_empty() { 0.0 } else { LEGEND_GAP }
            + if y.ticks.note.is_empty() { 0.0 } else { 1.3 * TICK_EM };
        let mut right = 1.8 * MARGIN;
        for guide in self.series.iter().filter(|series| series.stroke == Stroke::Guide) {
            right = right.max(GUIDE_GAP + font::width(&guide.label, TICK_EM)? + 0.5 * MARGIN);
        }
        (x.start, x.end) = (MARGIN + 1.9 * LABEL_EM + widest + 8.0, WIDTH - right);
        (y.start, y.end) = (HEIGHT - MARGIN - 3.6 * LABEL_EM, top);

        let mut picture = Picture::new(WIDTH as u32, HEIGHT as u32, FINENESS);
        let mut baseline = MARGIN + TITLE_EM;
        if !self.title.is_empty() {
            picture.text([0.5 * (x.start + x.end), baseline], &self.title, TITLE_EM, Anchor::Centre, INK);
            baseline += 1.6 * TITLE_EM;
        }
        for row in &legend {
            self.draw_legend_row(&mut picture, row, 0.5 * (x.start + x.end), baseline);
            baseline += LEGEND_ROW;
        }
        draw_grid(&mut picture, &x, &y);
        let is_visible = |p: &Place| between(p[0], x.start, x.end) && between(p[1], y.end, y.start);
        for stroke in [Stroke::Guide, Stroke::Solid, Stroke::Dashed] {
            for (i, series) in self.series.iter().enumerate().filter(|(_, series)| series.stroke == stroke) {
                let places: Vec<Place> = series.points.iter().map(|p| [x.pixel(p.0), y.pixel(p.1)]).collect();
                if stroke != Stroke::Guide && places.len() <= FEW_POINTS {
                    let dots = places.iter().filter(|place| is_visible(place));
                    dots.for_each(|place| draw_dot(&mut picture, *place, DOT_RADIUS, colour(i)));
                }
                for piece in self.visible(places, &x, &y) {
                    if stroke == Stroke::Guide {
                        draw_guide_label(&mut picture, &piece, &series.label, x.end);
                    }
                    draw_stroke(&mut picture, thinned(piece), colour(i), stroke);
                }
            }
        }
        self.draw_axes(&mut picture, &x, &y);
        for series in self.series.iter().filter(|series| series.stroke == Stroke::Rings) {
            let places = series.points.iter().map(|p| [x.pixel(p.0), y.pixel(p.1)]);
            draw_stroke(&mut picture, places.filter(is_visible).collect(), INK, Stroke::Rings);
        }
        Ok(picture)
    }

    /// The parts of a path that its windows leave.
    fn visible(&self, path: Vec<Place>, x: &Axis, y: &Axis) -> Vec<Vec<Place>> {
        let mut pieces = vec![path];
        for (i, axis) in [x, y].into_iter().enumerate().filter(|(_, axis)| matches!(axis.scale, Scale::Window(..))) {
            for bound in [axis.start, axis.end] {
                let sign = if bound == axis.start.min(axis.end) { 1.0 } else { -1.0 };
                pieces = pieces.iter().flat_map(|piece| beyond(piece, i, bound, sign)).collect();
            }
        }
        pieces
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

    /// Series with a label and the widths of their entries, broken into rows that fit.
    fn legend_rows(&self) -> Result<Vec<Vec<(usize, f64)>>, FigureError> {
        let room = WIDTH - 8.0 * MARGIN;
        let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
        let mut used = f64::INFINITY;
        for (i, series) in self.series.iter().enumerate().filter(|(_, series)| series.is_in_legend()) {
            let width = LEGEND_LINE + 6.0 + font::width(&series.label, TICK_EM)? + 20.0;
            if used + width > room {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += width;
            if let Some(row) = rows.last_mut() {
                row.push((i, width));
            }
        }
        Ok(rows)
    }

    fn draw_legend_row(&self, picture: &mut Picture, row: &[(usize, f64)], centre: f64, baseline: f64) {
        let mut left = centre - 0.5 * (row.iter().map(|entry| entry.1).sum::<f64>() - 20.0);
        for &(i, width) in row {
            let height = baseline - 0.36 * TICK_EM;
            let line = match self.series[i].stroke {
                Stroke::Rings => vec![[left + 0.5 * LEGEND_LINE, height]],
                _ => vec![[left, height], [left + LEGEND_LINE, height]],
            };
            draw_stroke(picture, line, colour(i), self.series[i].stroke);
            picture.text([left + LEGEND_LINE + 6.0, baseline], &self.series[i].label, TICK_EM, Anchor::Left, INK);
            left += width;
        }
    }

    fn draw_axes(&self, picture: &mut Picture, x: &Axis, y: &Axis) {
        let corners = [[x.start, y.start], [x.end, y.start], [x.end, y.end], [x.start, y.end], [x.start, y.start]];
        picture.line(corners.to_vec(), INK, 1.0);
        for (value, label) in &x.ticks.major {
            let at = x.pixel(*value);
            picture.line(vec![[at, y.start], [at, y.start - TICK_LENGTH]], INK, 1.0);
            picture.text([at, y.start + 1.5 * TICK_EM], label, TICK_EM, Anchor::Centre, INK);
        }
        for (value, label) in &y.ticks.major {
            let at = y.pixel(*value);
            picture.line(vec![[x.start, at], [x.start + TICK_LENGTH, at]], INK, 1.0);
            picture.text([x.start - 6.0, at + 0.36 * TICK_EM], label, TICK_EM, Anchor::Right, INK);
        }
        let below = HEIGHT - MARGIN - 0.3 * LABEL_EM;
        picture.text([0.5 * (x.start + x.end), below], &self.x_label, LABEL_EM, Anchor::Centre, INK);
        picture.text([x.end, below], &x.ticks.note, TICK_EM, Anchor::Right, INK);
        let middle = 0.5 * (y.start + y.end);
        picture.text([MARGIN + LABEL_EM, middle], &self.y_label, LABEL_EM, Anchor::Upwards, INK);
        picture.text([x.start, y.end - 0.5 * TICK_EM], &y.ticks.note, TICK_EM, Anchor::Left, INK);
    }
}

fn colour(series: usize) -> RGBColor {
    COLOURS[series % COLOURS.len()]
}

fn draw_grid(picture: &mut Picture, x: &Axis, y: &Axis) {
    let lines = |axis: &Axis| {
        let minor = axis.ticks.minor.iter().map(|&value| (value, FAINT_GRID));
        let major = axis.ticks.major.iter().map(|(value, _)| (*value, GRID));
        minor.chain(major).map(|(value, colour)| (axis.pixel(value), colour)).collect::<Vec<_>>()
    };
    for (at, colour) in lines(x) {
        picture.line(vec![[at, y.start], [at, y.end]], colour, 0.75);
    }
    for (at, colour) in lines(y) {
        picture.line(vec![[x.start, at], [x.end, at]], colour, 0.75);
    }
}

fn draw_dot(picture: &mut Picture, [x, y]: Place, radius: f64, colour: RGBColor) {
    let corner = |i: u32| (f64::from(i) * std::f64::consts::TAU / 24.0).sin_cos();
    let circle = (0..24).map(corner).map(|(sin, cos)| [x + radius * cos, y + radius * sin]);
    picture.area(circle.collect(), colour);
}

fn between(value: f64, low: f64, high: f64) -> bool {
    (low - 1e-6..=high + 1e-6).contains(&value)
}

/// The parts of a path whose coordinate `i` is not below `bound`, or for the sign −1 not above.
fn beyond(path: &[Place], i: usize, bound: f64, sign: f64) -> Vec<Vec<Place>> {
    let depth = |place: &Place| sign * (place[i] - bound);
    let mut pieces = Vec::new();
    let mut piece: Vec<Place> = path.first().copied().filter(|place| depth(place) >= 0.0).into_iter().collect();
    for pair in path.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (from, to) = (depth(&a), depth(&b));
        if (from < 0.0) != (to < 0.0) {
            let part = from / (from - to);
            piece.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
        }
        if to >= 0.0 {
            piece.push(b);
        } else if !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// In the margin if the line ends there, else to the left of its end.
fn draw_guide_label(picture: &mut Picture, places: &[Place], label: &str, right: f64) {
    let &[.., [x0, y0], [x, y]] = places else { return };
    if x > right - 0.5 {
        picture.text([x + GUIDE_GAP, y + 0.36 * TICK_EM], label, TICK_EM, Anchor::Left, GUIDE_INK);
    } else {
        let below = 1.3 * TICK_EM;
        let back = if y0 > y { (x - x0) / (y0 - y) * below } else { 0.0 };
        picture.text([x - back - GUIDE_GAP, y + below], label, TICK_EM, Anchor::Right, GUIDE_INK);
    }
}

fn draw_stroke(picture: &mut Picture, places: Vec<Place>, colour: RGBColor, stroke: Stroke) {
    match stroke {
        Stroke::Solid => picture.line(places, colour, SOLID_WIDTH),
        Stroke::Guide => picture.line(places, GUIDE, GUIDE_WIDTH),
        Stroke::Rings => places.into_iter().for_each(|place| {
            draw_dot(picture, place, RING_RADIUS, INK);
            draw_dot(picture, place, RING_RADIUS - SOLID_WIDTH, PAPER);
        }),
        Stroke::Dashed => {
            for dash in dashes(&places) {
                picture.line(dash, colour, DASHED_WIDTH);
            }
        }
    }
}

/// The parts of a path that the pen is down for.
fn dashes(places: &[Place]) -> Vec<Vec<Place>> {
    let mut dashes = Vec::new();
    let mut dash: Vec<Place> = places.first().copied().into_iter().collect();
    let (mut pen, mut left) = (0, DASH[0]);
    for pair in places.windows(2) {
        let ([mut at, end], mut rest) = ([pair[0], pair[1]], distance(pair[0], pair[1]));
        while rest > left {
            let fraction = left / rest;
            at = [at[0] + fraction * (end[0] - at[0]), at[1] + fraction * (end[1] - at[1])];
            rest -= left;
            if pen == 0 {
                dash.push(at);
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash.push(at);
            }
            pen = 1 - pen;
            left = DASH[pen];
        }
        left -= rest;
        if pen == 0 {
            dash.push(end);
        }
    }
    dashes.push(dash);
    dashes.retain(|dash| dash.len() > 1);
    dashes
}

fn distance(a: Place, b: Place) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// What a reader can see of a long path. Of a path that runs to the right, each column keeps its first,
/// lowest, highest and last place; of any other, places a quarter of a pixel apart.
fn thinned(places: Vec<Place>) -> Vec<Place> {
    if places.len() <= MANY_POINTS {
        return places;
    }
    let column = |place: &Place| (place[0] * COLUMNS_PER_PIXEL).floor();
    let mut kept = Vec::new();
    if places.is_sorted_by(|a, b| a[0] <= b[0]) {
        for group in places.chunk_by(|a, b| column(a) == column(b)) {
            let by_height = |a: &&Place, b: &&Place| a[1].total_cmp(&b[1]);
            let mut four: Vec<Place> = [group.first(), group.last()].into_iter().flatten().copied().collect();
            four.extend(group.iter().min_by(by_height));
            four.extend(group.iter().max_by(by_height));
            four.sort_by(|a, b| a[0].total_cmp(&b[0]));
            kept.extend(four);
        }
        kept.dedup();
    } else {
        for place in places {
            if kept.last().is_none_or(|&last| distance(last, place) >= 0.25) {
                kept.push(place);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_cut_where_it_leaves_a_window() {
        let path = [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0], [3.0, 0.5], [4.0, 3.0]];
        let below = beyond(&path, 1, 1.0, -1.0);
        assert_eq!(below, [vec![[0.0, 0.0], [0.5, 1.0]], vec![[1.5, 1.0], [2.0, 0.0], [3.0, 0.5], [3.2, 1.0]]]);
        let above = beyond(&path, 1, 1.0, 1.0);
        assert_eq!(above, [vec![[0.5, 1.0], [1.0, 2.0], [1.5, 1.0]], vec![[3.2, 1.0], [4.0, 3.0]]]);
        assert!(beyond(&path, 0, 5.0, 1.0).is_empty());
        assert_eq!(beyond(&path, 0, -1.0, 1.0), [path.to_vec()]);
    }
}
