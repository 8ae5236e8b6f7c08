//! The files of a figure: SVG and PDF documents, and bitmaps.

use std::path::{Path, PathBuf};

use plotters::prelude::*;
use plotters::style::text_anchor::{Pos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind};
use whole_file::write_whole;

use crate::FigureError;
use crate::document::font;
use crate::document::pdf::pdf;
use crate::document::picture::{FINE, Figure, Unit, draw_error};

/// Units per dot of a bitmap.
const SMOOTHING: u32 = 2;

/// The three files of a figure: `<stem>.svg`, `<stem>.pdf` and `<stem>.png`.
pub fn files(stem: &Path) -> [PathBuf; 3] {
    ["svg", "pdf", "png"].map(|extension| {
        let mut name = stem.as_os_str().to_owned();
        name.push(".");
        name.push(extension);
        PathBuf::from(name)
    })
}

/// Writes the three [`files`] and returns their paths.
pub(crate) fn save(figure: &impl Figure, stem: &Path) -> Result<[PathBuf; 3], FigureError> {
    let paths = files(stem);
    let files = [svg(figure)?.into_bytes(), pdf(figure)?, png(figure)?];
    for (path, bytes) in paths.iter().zip(files) {
        write(path, &bytes)?;
    }
    Ok(paths)
}

/// Writes an SVG.
pub(crate) fn svg_file(figure: &impl Figure, path: &Path) -> Result<(), FigureError> {
    write(path, svg(figure)?.as_bytes())
}

/// Writes a PNG.
pub(crate) fn png_file(figure: &impl Figure, path: &Path) -> Result<(), FigureError> {
    write(path, &png(figure)?)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), FigureError> {
    write_whole(path, bytes).map_err(|error| FigureError::system(path, &error))
}

pub(crate) fn svg(figure: &impl Figure) -> Result<String, FigureError> {
    font::register()?;
    let [width, height] = figure.size();
    let mut document = String::new();
    let area = SVGBackend::with_string(&mut document, (width * FINE, height * FINE)).into_drawing_area();
    area.fill(&WHITE)?;
    figure.draw(&area, Unit::DOCUMENT)?;
    area.present()?;
    drop(area);

    let fine = format!("width=\"{}\" height=\"{}\" viewBox", width * FINE, height * FINE);
    let shown = format!("width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\" viewBox");
    // plotters leaves the word "image" out of the type of an embedded bitmap.
    Ok(document.replacen(&fine, &shown, 1).replace("\"data:png;", "\"data:image/png;"))
}

fn png(figure: &impl Figure) -> Result<Vec<u8>, FigureError> {
    let rgb = rgb(figure, figure.dots())?;
    let [width, height] = figure.size().map(|pixels| pixels * figure.dots());
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&rgb)).map_err(draw_error)?;
    Ok(file)
}

/// RGB bytes, row by row, with `dots` dots per pixel.
pub(crate) fn rgb(figure: &impl Figure, dots: u32) -> Result<Vec<u8>, FigureError> {
    font::register()?;
    let per_pixel = SMOOTHING * dots;
    let [width, height] = figure.size().map(|pixels| pixels * per_pixel);
    let mut fine = vec![255; 3 * width as usize * height as usize];
    let area = Bitmap(BitMapBackend::with_buffer(&mut fine, (width, height))).into_drawing_area();
    figure.draw(&area, Unit::of_bitmap(per_pixel))?;
    drop(area);
    Ok(averaged(&fine, width as usize))
}

/// Means over squares of [`SMOOTHING`] dots of an RGB bitmap.
fn averaged(rgb: &[u8], width: usize) -> Vec<u8> {
    let n = SMOOTHING as usize;
    let (row, count) = (3 * width, (n * n) as u32);
    let mut means = Vec::with_capacity(rgb.len() / (n * n));
    for band in rgb.chunks_exact(row * n) {
        for x in (0..width).step_by(n) {
            for channel in 0..3 {
                let dots = (0..n * n).map(|i| u32::from(band[row * (i / n) + 3 * (x + i % n) + channel]));
                means.push(((dots.sum::<u32>() + count / 2) / count) as u8);
            }
        }
    }
    means
}

/// plotters' bitmaps, with two things as they are in an SVG: a thick path has no holes where it crosses itself, and text
/// stands where it should.
struct Bitmap<'a>(BitMapBackend<'a>);

type Drawn<'a> = Result<(), DrawingErrorKind<<BitMapBackend<'a> as DrawingBackend>::ErrorType>>;

impl<'a> DrawingBackend for Bitmap<'a> {
    type ErrorType = <BitMapBackend<'a> as DrawingBackend>::ErrorType;

    /// Segment by segment with round joints.
    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn<'a> {
        let mut path: Vec<_> = path.into_iter().collect();
        path.dedup();
        for segment in path.windows(2) {
            self.0.draw_line(segment[0], segment[1], style)?;
        }
        for joint in path.get(1..path.len().saturating_sub(1)).unwrap_or_default() {
            self.0.draw_circle(*joint, style.stroke_width() / 2, style, true)?;
        }
        Ok(())
    }

    /// By the base line, at the distances from the anchor that plotters writes into an SVG.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn<'a> {
        let em = style.size() / font::SIZE_PER_EM;
        let base_line = em * font::base_line(style.anchor().v_pos);
        // plotters' bitmaps have the base line half a line below the top.
        let line = em * font::LINE_PER_EM;
        let (x, y) = style.transform().transform(0, (base_line - 0.5 * line).round() as i32);
        let mut shifted = font::of_size(line).pos(Pos::new(style.anchor().h_pos, VPos::Top));
        shifted.font = shifted.font.transform(style.transform());
        shifted.color = style.color();
        self.0.draw_text(text, &shifted, (at.0 + x, at.1 + y))
    }

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Drawn<'a> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Drawn<'a> {
        self.0.present()
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Drawn<'a> {
        self.0.draw_pixel(at, colour)
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn<'a> {
        self.0.draw_rect(from, to, style, fill)
    }

    fn blit_bitmap(&mut self, at: BackendCoord, size: (u32, u32), rgb: &[u8]) -> Drawn<'a> {
        self.0.blit_bitmap(at, size, rgb)
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::document::picture::Area;
    use plotters::style::text_anchor::HPos;

    struct Letters(&'static str, VPos);

    impl Figure for Letters {
        fn size(&self) -> [u32; 2] {
            [100, 60]
        }

        fn draw<DB: DrawingBackend>(&self, area: &Area<DB>, unit: Unit) -> Result<(), FigureError> {
            area.draw_text(self.0, &unit.text(20.0, HPos::Center, self.1), (unit.px(50.0), unit.px(30.0)))?;
            let bitmap: Option<BitMapElement<_>> = BitMapElement::with_owned_buffer((0, 0), (4, 4), vec![255; 48]);
            area.draw(&bitmap.unwrap())?;
            Ok(())
        }
    }

    /// Conserved: the mean.
    #[test]
    fn averaging_keeps_the_mean() {
        let rgb: Vec<u8> = (0..4 * 4).flat_map(|i| [i * 2, 7, 255]).collect();
        let means = averaged(&rgb, 4);
        // Dots 0, 1, 4, 5 of the first channel are 0, 2, 8, 10.
        assert_eq!(means[..3], [5, 7, 255]);
        assert_eq!(means.len(), 3 * 4);
    }

    /// Independent reference: the base lines that plotters writes into an SVG.
    #[test]
    fn text_stands_in_a_bitmap_where_it_stands_in_an_svg() {
        // Distances of the base line from the anchor, in ems, as plotters writes them into an SVG.
        for (vertical, below) in [(VPos::Top, 0.76), (VPos::Center, 0.27), (VPos::Bottom, -0.27)] {
            let rgb = rgb(&Letters("HEH", vertical), 1).unwrap();
            let dark = |row: usize| (0..100).any(|x| rgb[3 * (100 * row + x)] < 160);
            let rows: Vec<_> = (0..60).filter(|&row| dark(row)).collect();
            let (top, bottom) = (rows[0] as f64, *rows.last().unwrap() as f64 + 1.0);
            let base_line = 30.0 + 20.0 * below;
            // Capitals of DejaVu Sans are 0.729 em high.
            assert!((top - (base_line - 0.729 * 20.0)).abs() <= 1.0, "{top} {base_line}");
            assert!((bottom - base_line).abs() <= 1.0, "{bottom} {base_line}");
        }
    }

    #[test]
    fn an_svg_is_as_large_as_the_picture_and_escapes_text() {
        let svg = svg(&Letters("a < b", VPos::Top)).unwrap();
        assert!(svg.contains("width=\"100\" height=\"60\"") && svg.contains("viewBox=\"0 0 400 240\""), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains("data:image/png;base64,"), "{svg}");
    }
}
