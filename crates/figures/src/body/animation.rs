//! A moving body as an animated GIF, or as pictures for a film.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gif::{Encoder, EncodingError, Repeat};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use whole_file::WholeFile;

use crate::FigureError;
use crate::body::key::{self, colour_axis, draw_key, shade};
use crate::body::render::{Canvas, Grades, check_index, check_indices, check_points, plain_colours, surface_colours};
use crate::body::shapes::EDGE;
use crate::body::view::{View, Window};
use crate::chart::axis::{Axis, round_step};
use crate::document::formats::{png_file, rgb};
use crate::document::picture::{Area, Figure, INK, LABEL_EM, TITLE_EM, Unit, draw_error};

const WIDTH: u16 = 720;
const HEIGHT: u16 = 440;
const MARGIN: f64 = 14.0;
/// Above and below the key.
const KEY_MARGIN: f64 = 6.0;
/// The key below the body, with its margins.
const KEY: f64 = key::HEIGHT + 2.0 * KEY_MARGIN;
/// Few enough that all frames share one palette of a GIF's 256 colours.
const GRADES: Grades = Grades { values: 28, lights: 5 };
const GROUND: RGBColor = RGBColor(214, 214, 214);
const TRACE: RGBColor = RGBColor(213, 94, 0);
const WHITE: RGBColor = RGBColor(255, 255, 255);

/// The body at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmFrame {
    /// Places of the points.
    pub points: Vec<[f64; 3]>,
    /// A value per point, shown as colour.
    pub values: Vec<f64>,
    /// Text in the frame, for instance "t = 0.120 s".
    pub caption: String,
}

/// A moving body, seen by a viewer at rest; the picture holds the whole of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation<'a> {
    /// Title in every frame; may be empty.
    pub title: String,
    /// Name of the coloured quantity, with its unit.
    pub value_label: String,
    /// The surface, by indices of points.
    pub triangles: &'a [[u32; 3]],
    /// The surface of bodies without values, whose points have values of zero.
    pub plain_triangles: &'a [[u32; 3]],
    /// Edges drawn as lines, by indices of points.
    pub edges: &'a [[u32; 2]],
    /// The frames in the order of time.
    pub frames: &'a [FilmFrame],
    /// How long each is shown, in milliseconds (in steps of ten).
    pub frame_milliseconds: u32,
    /// From where the body is seen.
    pub view: View,
    /// True if a grid is drawn in a plane of constant z below the body.
    pub ground: bool,
    /// Index of a point whose path so far is drawn.
    pub traced_point: Option<usize>,
}

impl Animation<'_> {
    /// Writes a GIF of 720×440 dots that starts again at its end. Colours run from 0, or the smallest value of all frames
    /// if that is negative, to the largest; a bar below the body shows them.
    ///
    /// # Errors
    /// [`FigureError::Unfit`] without frames, and of lists that do not fit; [`FigureError::Write`].
    pub fn save_gif(&self, path: impl AsRef<Path>) -> Result<(), FigureError> {
        let path = path.as_ref();
        self.check()?;
        let stage = self.stage();
        let mut palette = Palette::new();
        let system = |error| FigureError::system(path, &error);
        let written = |error| match error {
            EncodingError::Io(error) => system(error),
            error => draw_error(error),
        };
        let mut file = WholeFile::create(path).map_err(system)?;
        let mut gif = Encoder::new(&mut file, WIDTH, HEIGHT, &palette.colours.concat()).map_err(written)?;
        gif.set_repeat(Repeat::Infinite).map_err(written)?;
        for last in 0..self.frames.len() {
            let dots = palette.applied(&rgb(&Shot { animation: self, stage: &stage, last }, 1)?);
            let frame = gif::Frame {
                width: WIDTH,
                height: HEIGHT,
                delay: (self.frame_milliseconds / 10).try_into().unwrap_or(u16::MAX),
                buffer: Cow::Owned(dots),
                ..gif::Frame::default()
            };
            gif.write_frame(&frame).map_err(written)?;
        }
        gif.into_inner().map_err(written)?;
        file.finish().map_err(system)
    }

    /// Writes each frame as a PNG of 1440×880 dots into a folder: `00000.png`, `00001.png` and so on. Tells the number of each
    /// that is written.
    ///
    /// # Errors
    /// As [`Animation::save_gif`].
    pub fn save_pictures(&self, folder: &Path, mut written: impl FnMut(usize)) -> Result<Vec<PathBuf>, FigureError> {
        self.check()?;
        let stage = self.stage();
        let picture = |last| {
            let path = folder.join(format!("{last:05}.png"));
            png_file(&Shot { animation: self, stage: &stage, last }, &path)?;
            written(last);
            Ok(path)
        };
        (0..self.frames.len()).map(picture).collect()
    }

    fn check(&self) -> Result<(), FigureError> {
        let figure = self.title.as_str();
        let Some(first) = self.frames.first() else {
            return Err(FigureError::empty(figure, "frame"));
        };
        let count = first.points.len();
        check_indices(figure, "a triangle", self.triangles, count)?;
        check_indices(figure, "a triangle", self.plain_triangles, count)?;
        check_indices(figure, "an edge", self.edges, count)?;
        check_index(figure, "the trace", self.traced_point, count)?;
        for (i, frame) in self.frames.iter().enumerate() {
            check_points(figure, &format!("frame {i}"), count, &frame.points, &frame.values)?;
        }
        Ok(())
    }

    /// The parts that stay the same in all frames.
    fn stage(&self) -> Stage {
        let ground = if self.ground { self.ground_lines() } else { Vec::new() };
        let points = self.frames.iter().flat_map(|frame| &frame.points);
        let all = points.chain(ground.iter().flatten()).map(|point| self.view.see(point));
        let window = Window::around(all);
        let top = self.body_top();
        let room = [f64::from(WIDTH) - 2.0 * MARGIN, f64::from(HEIGHT) - top - KEY];
        let fit = |axis: usize| room[axis] / window.size()[axis];
        let scale = Some(fit(0).min(fit(1))).filter(|scale| scale.is_finite()).unwrap_or(1.0);

        let values = self.frames.iter().flat_map(|frame| frame.values.iter().copied());
        Stage { ground, scale, centre: window.centre(), values: colour_axis(values) }
    }

    fn body_top(&self) -> f64 {
        MARGIN + if self.title.is_empty() { 0.0 } else { 1.6 * TITLE_EM } + 1.6 * LABEL_EM
    }

    /// Lines a round distance apart in the plane of the lowest point, a little below it.
    fn ground_lines(&self) -> Vec<[[f64; 3]; 2]> {
        let points = || self.frames.iter().flat_map(|frame| &frame.points);
        let range = |axis: usize| {
            points().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[axis]), h.max(p[axis])))
        };
        let (x, y, z) = (range(0), range(1), range(2));
        let largest = (x.1 - x.0).max(y.1 - y.0);
        if largest <= 0.0 {
            return Vec::new();
        }
        let step = round_step(largest / 10.0);
        let level = z.0 - 0.02 * largest;
        let whole = |(low, high): (f64, f64)| ((low / step).floor() as i64, (high / step).ceil() as i64);
        let ((x0, x1), (y0, y1)) = (whole(x), whole(y));
        let place = |i: i64, j: i64| [i as f64 * step, j as f64 * step, level];
        let along_y = (x0..=x1).map(|i| [place(i, y0), place(i, y1)]);
        along_y.chain((y0..=y1).map(|j| [place(x0, j), place(x1, j)])).collect()
    }
}

/// One frame to be drawn, with the trace up to it.
struct Shot<'a> {
    animation: &'a Animation<'a>,
    stage: &'a Stage,
    last: usize,
}

impl Figure for Shot<'_> {
    fn size(&self) -> [u32; 2] {
        [WIDTH, HEIGHT].map(u32::from)
    }

    fn draw<DB: DrawingBackend>(&self, picture: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
        let &Shot {
            animation: &Animation { ref title, triangles, plain_triangles, edges, frames, view, .. },
            stage,
            last,
        } = self;
        let frame = &frames[last];
        let fine = unit.per_pixel();
        let (_, area) = picture.split_vertically(unit.px(self.animation.body_top()));
        let (area, key) = area.split_vertically(area.dim_in_pixel().1 as i32 - unit.px(KEY));
        draw_key(
            &key.margin(unit.px(KEY_MARGIN), unit.px(KEY_MARGIN), 0, 0),
            &view,
            &stage.values,
            &self.animation.value_label,
            unit,
        )?;
        let mut canvas = Canvas::new(area.dim_in_pixel().into(), stage.scale * fine, stage.centre, GRADES);
        for line in &stage.ground {
            let [from, to] = line.map(|point| view.see(&point));
            canvas.line(&from, &to, fine, GROUND);
        }
        let values: Vec<f64> = frame.values.iter().map(|value| shade(&stage.values, *value)).collect();
        let points: Vec<_> = frame.points.iter().map(|point| view.see(point)).collect();
        canvas.surface(triangles, &points, &values);
        canvas.plain_surface(plain_triangles, &points);
        for edge in edges {
            let [from, to] = edge.map(|i| points[i as usize]);
            canvas.line(&from, &to, 0.9 * fine, EDGE);
        }
        if let Some(point) = self.animation.traced_point {
            let path: Vec<_> = frames[..=last].iter().map(|frame| view.see(&frame.points[point])).collect();
            for pair in path.windows(2) {
                canvas.line(&pair[0], &pair[1], 1.6 * fine, TRACE);
            }
        }
        canvas.draw(&area)?;

        let mut below = MARGIN;
        for (text, em) in [(title, TITLE_EM), (&frame.caption, LABEL_EM)] {
            if !text.is_empty() {
                picture.draw_text(text, &unit.text(em, HPos::Left, VPos::Top), (unit.px(MARGIN), unit.px(below)))?;
                below += 1.5 * em;
            }
        }
        Ok(())
    }
}

struct Stage {
    ground: Vec<[[f64; 3]; 2]>,
    scale: f64,
    centre: [f64; 2],
    /// The axis of the colours, for all frames.
    values: Axis,
}

/// At most 256 colours for all frames: a palette made anew for each would flicker.
struct Palette {
    colours: Vec<[u8; 3]>,
    /// Which of them is nearest to the colours met so far.
    nearest: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn new() -> Self {
        let mut colours = surface_colours(GRADES);
        let rgb = |RGBColor(r, g, b): RGBColor| [r, g, b];
        let mixed = |a: [u8; 3], b: [u8; 3], part: f64| {
            [0, 1, 2].map(|i| (f64::from(a[i]) * (1.0 - part) + f64::from(b[i]) * part).round() as u8)
        };
        let bright = colours[colours.len() - GRADES.values..].to_vec();
        // Smoothed edges: of the body against white and against its lines, of lines and texts against white.
        colours.extend(bright.iter().map(|&colour| mixed(colour, rgb(WHITE), 0.5)));
        colours.extend(bright.iter().map(|&colour| mixed(colour, rgb(EDGE), 0.5)));
        colours.extend((0..=16).map(|i| mixed(rgb(INK), rgb(WHITE), f64::from(i) / 16.0)));
        colours.extend((0..4).map(|i| mixed(rgb(TRACE), rgb(WHITE), f64::from(i) / 4.0)));
        colours.extend(plain_colours(GRADES.lights));
        colours.push(rgb(GROUND));
        Self { colours, nearest: HashMap::new() }
    }

    /// For each dot, which colour it has.
    fn applied(&mut self, rgb: &[u8]) -> Vec<u8> {
        let square = |a: u8, b: u8| u32::from(a.abs_diff(b)).pow(2);
        let nearest = |dot: &[u8; 3]| {
            let distance = |c: &[u8; 3]| square(c[0], dot[0]) + square(c[1], dot[1]) + square(c[2], dot[2]);
            (0..=u8::MAX).zip(&self.colours).min_by_key(|(_, colour)| distance(colour)).map_or(0, |(i, _)| i)
        };
        let dots = rgb.as_chunks::<3>().0;
        dots.iter().map(|dot| *self.nearest.entry(*dot).or_insert_with_key(nearest)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_palette_fits_a_gif_and_keeps_its_own_colours() {
        let mut palette = Palette::new();
        assert!(palette.colours.len() <= 256, "{}", palette.colours.len());
        let own = palette.colours.clone();
        let kept: Vec<_> = palette.applied(&own.concat()).iter().map(|i| own[usize::from(*i)]).collect();
        assert_eq!(kept, own);
        assert_eq!(own[usize::from(palette.applied(&[255, 254, 255])[0])], [255, 255, 255]);
    }
}
