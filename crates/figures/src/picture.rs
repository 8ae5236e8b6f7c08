//! A picture as a list of lines, areas, texts and bitmaps, and its writers.
//!
//! A figure is composed once, in pixels with y downwards; SVG and bitmap come from the same list. The
//! drawing library works in whole units, so both are drawn on a grid finer than the pixel: an SVG
//! keeps the fine coordinates, a bitmap is averaged down, which smooths all its edges.

use crate::{FigureError, font};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, RGBColor, ShapeStyle};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A place in the picture: pixels to the right, pixels down.
pub(crate) type Place = [f64; 2];

/// Which point of a text is given; vertically it is always the base line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Left,
    Centre,
    Right,
    /// Reads upwards, centred on the place, the base line to its right.
    Upwards,
}

#[derive(Debug)]
enum Item {
    Line {
        places: Vec<Place>,
        colour: RGBColor,
        width: f64,
    },
    Area {
        places: Vec<Place>,
        colour: RGBColor,
    },
    Text {
        place: Place,
        text: String,
        em: f64,
        anchor: Anchor,
        colour: RGBColor,
    },
    /// RGB bytes, row by row, at the picture's fine resolution.
    Bitmap {
        place: Place,
        width: u32,
        height: u32,
        rgb: Vec<u8>,
    },
}

#[derive(Debug)]
pub(crate) struct Picture {
    width: u32,
    height: u32,
    /// Fine units per pixel.
    fineness: u32,
    items: Vec<Item>,
}

impl Picture {
    pub(crate) fn new(width: u32, height: u32, fineness: u32) -> Self {
        Self { width, height, fineness, items: Vec::new() }
    }

    pub(crate) fn line(&mut self, places: Vec<Place>, colour: RGBColor, width: f64) {
        self.items.push(Item::Line { places, colour, width });
    }

    pub(crate) fn area(&mut self, places: Vec<Place>, colour: RGBColor) {
        self.items.push(Item::Area { places, colour });
    }

    pub(crate) fn text(&mut self, place: Place, text: &str, em: f64, anchor: Anchor, colour: RGBColor) {
        if text.is_empty() {
            return;
        }
        self.items.push(Item::Text { place, text: text.to_owned(), em, anchor, colour });
    }

    /// `width` and `height` in fine units.
    pub(crate) fn bitmap(&mut self, place: Place, width: u32, height: u32, rgb: Vec<u8>) {
        self.items.push(Item::Bitmap { place, width, height, rgb });
    }

    /// Writes `<stem>.svg` and `<stem>.png`, the latter with two dots per pixel, and returns the two paths.
    pub(crate) fn save(&self, stem: &Path) -> Result<[PathBuf; 2], FigureError> {
        let [svg, png] = ["svg", "png"].map(|extension| {
            let mut name = stem.as_os_str().to_owned();
            name.push(".");
            name.push(extension);
            PathBuf::from(name)
        });
        std::fs::write(&svg, self.svg()?).map_err(|error| FigureError::system(&svg, &error))?;

        let dots = 2;
        let size = (self.width * dots, self.height * dots);
        let rgb = self.rgb(dots)?;
        let mut backend = BitMapBackend::new(&png, size);
        backend.blit_bitmap((0, 0), size, &rgb).and_then(|()| backend.present()).map_err(write_error(&png))?;
        drop(backend);
        Ok([svg, png])
    }

    /// The picture as an SVG document.
    pub(crate) fn svg(&self) -> Result<String, FigureError> {
        let mut document = String::new();
        let mut backend = SVGBackend::with_string(&mut document, self.fine_size());
        self.draw(&mut backend, Target::Svg)?;
        backend.present().map_err(draw_error)?;
        drop(backend);

        let (fine_width, fine_height) = self.fine_size();
        let fine = format!("width=\"{fine_width}\" height=\"{fine_height}\" viewBox");
        let shown = format!("width=\"{}\" height=\"{}\" stroke-linejoin=\"round\" viewBox", self.width, self.height);
        // The drawing library leaves the word "image" out of the type of an embedded bitmap.
        Ok(document.replacen(&fine, &shown, 1).replace("\"data:png;", "\"data:image/png;"))
    }

    /// RGB bytes, row by row, with `dots` dots per pixel, a divisor of the fineness.
    pub(crate) fn rgb(&self, dots: u32) -> Result<Vec<u8>, FigureError> {
        let (width, height) = self.fine_size();
        let mut fine = vec![255; 3 * width as usize * height as usize];
        let mut backend = BitMapBackend::with_buffer(&mut fine, (width, height));
        self.draw(&mut backend, Target::Bitmap)?;
        drop(backend);
        Ok(averaged(&fine, width as usize, (self.fineness / dots) as usize))
    }

    fn fine_size(&self) -> (u32, u32) {
        (self.width * self.fineness, self.height * self.fineness)
    }

    fn draw<DB: DrawingBackend>(&self, backend: &mut DB, target: Target) -> Result<(), FigureError> {
        let fineness = f64::from(self.fineness);
        let unit = |length: f64| (length * fineness).round() as i32;
        let fine = |place: &Place| (unit(place[0]), unit(place[1]));
        let (width, height) = self.fine_size();
        backend
            .draw_rect((0, 0), (width as i32, height as i32), &RGBColor(255, 255, 255).filled(), true)
            .map_err(draw_error)?;
        for item in &self.items {
            match item {
                Item::Line { places, colour, width } => {
                    let width = unit(*width).max(1) as u32;
                    let style = ShapeStyle::from(colour).stroke_width(width);
                    let mut path: Vec<_> = places.iter().map(fine).collect();
                    path.dedup();
                    match target {
                        Target::Svg => backend.draw_path(path, &style).map_err(draw_error),
                        Target::Bitmap => draw_thick_path(backend, &path, &style),
                    }
                }
                Item::Area { places, colour } => {
                    backend.fill_polygon(places.iter().map(fine), colour).map_err(draw_error)
                }
                Item::Bitmap { place, width, height, rgb } => {
                    backend.blit_bitmap(fine(place), (*width, *height), rgb).map_err(draw_error)
                }
                Item::Text { place, text, em, anchor, colour } => {
                    // Where each writer has its reference height, seen from the base line, and how
                    // many of its units make an em.
                    let (below_base, units_per_em) = match target {
                        Target::Svg => (font::HALF_X_HEIGHT * em, 1.24),
                        Target::Bitmap => (-0.5 * font::LINE_PER_EM * em, font::LINE_PER_EM),
                    };
                    let (horizontal, [x, y]) = match anchor {
                        Anchor::Left => (HPos::Left, [place[0], place[1] + below_base]),
                        Anchor::Centre => (HPos::Center, [place[0], place[1] + below_base]),
                        Anchor::Right => (HPos::Right, [place[0], place[1] + below_base]),
                        Anchor::Upwards => (HPos::Center, [place[0] + below_base, place[1]]),
                    };
                    let vertical = match target {
                        Target::Svg => VPos::Bottom,
                        Target::Bitmap => VPos::Top,
                    };
                    let mut style = font::style(em * units_per_em * fineness)?;
                    if *anchor == Anchor::Upwards {
                        style = style.transform(FontTransform::Rotate270);
                    }
                    let style = style.color(colour).pos(Pos::new(horizontal, vertical));
                    backend.draw_text(text, &style, (unit(x), unit(y))).map_err(draw_error)
                }
            }?;
        }
        Ok(())
    }
}

#[derive(Debug, Clone, Copy)]
enum Target {
    Svg,
    Bitmap,
}

/// Segment by segment with round joints: the library's own thick path leaves holes where it crosses itself.
fn draw_thick_path<DB: DrawingBackend>(
    backend: &mut DB,
    path: &[(i32, i32)],
    style: &ShapeStyle,
) -> Result<(), FigureError> {
    for segment in path.windows(2) {
        backend.draw_line(segment[0], segment[1], style).map_err(draw_error)?;
    }
    let joints = path.get(1..path.len().saturating_sub(1)).unwrap_or_default();
    for &joint in joints {
        backend.draw_circle(joint, style.stroke_width / 2, &style.color, true).map_err(draw_error)?;
    }
    Ok(())
}

/// Means over squares of `n`×`n` dots of an RGB bitmap.
fn averaged(rgb: &[u8], width: usize, n: usize) -> Vec<u8> {
    if n == 1 {
        return rgb.to_vec();
    }
    let (row, count) = (3 * width, (n * n) as u32);
    let mut means = Vec::with_capacity(rgb.len() / (n * n));
    let mut sums = vec![0_u32; row / n];
    for band in rgb.chunks_exact(row * n) {
        sums.fill(0);
        for line in band.chunks_exact(row) {
            for (sum, square) in sums.chunks_exact_mut(3).zip(line.chunks_exact(3 * n)) {
                for dot in square.chunks_exact(3) {
                    sum[0] += u32::from(dot[0]);
                    sum[1] += u32::from(dot[1]);
                    sum[2] += u32::from(dot[2]);
                }
            }
        }
        means.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    means
}

fn draw_error(error: impl Display) -> FigureError {
    FigureError::Draw { reason: error.to_string() }
}

pub(crate) fn write_error<E: Display>(path: &Path) -> impl FnOnce(E) -> FigureError {
    let path = path.to_path_buf();
    move |error| FigureError::Write { path, reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averaging_keeps_the_mean() {
        let rgb: Vec<u8> = (0..4 * 4).flat_map(|i| [i * 2, 7, 255]).collect();
        let means = averaged(&rgb, 4, 2);
        // Dots 0, 1, 4, 5 of the first channel are 0, 2, 8, 10.
        assert_eq!(means[..3], [5, 7, 255]);
        assert_eq!(means.len(), 3 * 4);
    }

    #[test]
    fn text_stands_on_its_base_line_in_a_bitmap() {
        let mut picture = Picture::new(100, 60, 4);
        picture.text([50.0, 40.0], "HEH", 20.0, Anchor::Centre, RGBColor(0, 0, 0));
        let rgb = picture.rgb(1).unwrap();
        let dark = |row: usize| (0..100).any(|x| rgb[3 * (100 * row + x)] < 100);
        let rows: Vec<_> = (0..60).filter(|&row| dark(row)).collect();
        // Capitals of DejaVu Sans are 0.729 em high.
        assert!(rows[0].abs_diff(40 - 15) <= 1 && rows.last().unwrap().abs_diff(39) <= 1, "{rows:?}");
    }

    #[test]
    fn an_svg_is_as_large_as_the_picture_and_escapes_text() {
        let mut picture = Picture::new(100, 60, 4);
        picture.text([50.0, 40.0], "a < b", 20.0, Anchor::Centre, RGBColor(0, 0, 0));
        picture.bitmap([10.0, 10.0], 4, 4, vec![9; 48]);
        let svg = picture.svg().unwrap();
        assert!(svg.contains("width=\"100\" height=\"60\"") && svg.contains("viewBox=\"0 0 400 240\""), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains("data:image/png;base64,"), "{svg}");
    }
}
