//! A figure as a PDF of one page, with the letters that it uses.

use ab_glyph::{Font as _, FontRef};
use krilla::Document;
use krilla::color::rgb;
use krilla::geom::{Path, PathBuilder, Point, Size, Transform};
use krilla::image::Image;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, LineJoin, Stroke};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind};

use crate::FigureError;
use crate::document::font;
use crate::document::picture::{FINE, Figure, Unit, draw_error};

/// Points of 1/72 inch per unit: 96 pixels are an inch, as in an SVG.
const POINTS: f32 = 72.0 / 96.0 / FINE as f32;
/// Distance of the control points of a quarter circle from its ends, in radii.
const QUARTER: f32 = 0.552_284_8;

pub(crate) fn pdf(figure: &impl Figure) -> Result<Vec<u8>, FigureError> {
    font::register()?;
    let [width, height] = figure.size().map(|pixels| pixels * FINE);
    let unreadable = || draw_error("the built-in font could not be read");
    let letters = FontRef::try_from_slice(font::FILE).map_err(draw_error)?;
    let face = Font::new(font::FILE.into(), 0).ok_or_else(unreadable)?;
    let page = PageSettings::from_wh(width as f32 * POINTS, height as f32 * POINTS);
    let mut document = Document::new();
    let mut page = document.start_page_with(page.ok_or_else(|| draw_error("the figure has no size"))?);
    let area = Pdf { surface: page.surface(), size: (width, height), letters, face }.into_drawing_area();
    figure.draw(&area, Unit::DOCUMENT)?;
    drop(area);
    page.finish();
    document.finish().map_err(|error| draw_error(format!("{error:?}")))
}

/// A page that plotters can draw on.
struct Pdf<'a> {
    surface: Surface<'a>,
    size: (u32, u32),
    /// The font, to find the letters of a text and their widths.
    letters: FontRef<'static>,
    face: Font,
}

type Drawn = Result<(), DrawingErrorKind<std::convert::Infallible>>;

/// A place on the page, in points.
fn place((x, y): BackendCoord) -> Point {
    Point::from_xy(x as f32 * POINTS, y as f32 * POINTS)
}

fn path(points: impl IntoIterator<Item = BackendCoord>, closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, at) in points.into_iter().map(place).enumerate() {
        if i == 0 { path.move_to(at.x, at.y) } else { path.line_to(at.x, at.y) }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn opacity(colour: BackendColor) -> NormalizedF32 {
    NormalizedF32::new(colour.alpha as f32).unwrap_or(NormalizedF32::ONE)
}

fn paint(colour: BackendColor) -> rgb::Color {
    let (r, g, b) = colour.rgb;
    rgb::Color::new(r, g, b)
}

fn fill_of(colour: BackendColor) -> Fill {
    Fill { paint: paint(colour).into(), opacity: opacity(colour), ..Fill::default() }
}

impl Pdf<'_> {
    fn stroked(&mut self, path: Option<Path>, style: &impl BackendStyle) -> Drawn {
        let colour = style.color();
        self.surface.set_fill(None);
        self.surface.set_stroke(Some(Stroke {
            paint: paint(colour).into(),
            opacity: opacity(colour),
            width: style.stroke_width() as f32 * POINTS,
            line_join: LineJoin::Round,
            ..Stroke::default()
        }));
        path.iter().for_each(|path| self.surface.draw_path(path));
        Ok(())
    }

    fn filled(&mut self, path: Option<Path>, colour: BackendColor) -> Drawn {
        self.surface.set_stroke(None);
        self.surface.set_fill(Some(fill_of(colour)));
        path.iter().for_each(|path| self.surface.draw_path(path));
        Ok(())
    }

    fn painted(&mut self, path: Option<Path>, style: &impl BackendStyle, fill: bool) -> Drawn {
        if fill { self.filled(path, style.color()) } else { self.stroked(path, style) }
    }
}

impl DrawingBackend for Pdf<'_> {
    type ErrorType = std::convert::Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.filled(path([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], true), colour)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.stroked(path([from, to], false), style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn {
        self.painted(path([from, (to.0, from.1), to, (from.0, to.1)], true), style, fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, points: I, style: &S) -> Drawn {
        self.stroked(path(points, false), style)
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, fill: bool) -> Drawn {
        let (Point { x, y }, r) = (place(centre), radius as f32 * POINTS);
        let k = QUARTER * r;
        let mut circle = PathBuilder::new();
        circle.move_to(x + r, y);
        circle.cubic_to(x + r, y + k, x + k, y + r, x, y + r);
        circle.cubic_to(x - k, y + r, x - r, y + k, x - r, y);
        circle.cubic_to(x - r, y - k, x - k, y - r, x, y - r);
        circle.cubic_to(x + k, y - r, x + r, y - k, x + r, y);
        circle.close();
        self.painted(circle.finish(), style, fill)
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, points: I, style: &S) -> Drawn {
        self.filled(path(points, true), style.color())
    }

    /// Letter by letter from the font's own widths, at the distances from the anchor that plotters writes into an SVG.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Drawn {
        let em = (style.size() / font::SIZE_PER_EM) as f32 * POINTS;
        let per_em = self.letters.units_per_em().unwrap_or(1.0);
        let glyphs: Vec<KrillaGlyph> = text
            .char_indices()
            .map(|(start, letter)| {
                let glyph = self.letters.glyph_id(letter);
                let advance = self.letters.h_advance_unscaled(glyph) / per_em;
                let range = start..start + letter.len_utf8();
                KrillaGlyph::new(GlyphId::new(glyph.0.into()), advance, 0.0, 0.0, 0.0, range, None)
            })
            .collect();
        let width = em * glyphs.iter().map(|glyph| glyph.x_advance).sum::<f32>();
        let anchor = place(at);
        let left = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => 0.5 * width,
            HPos::Right => width,
        };
        let start = Point::from_xy(anchor.x - left, anchor.y + em * font::base_line(style.anchor().v_pos) as f32);
        let turn = match style.transform() {
            FontTransform::None => 0.0,
            FontTransform::Rotate90 => 90.0,
            FontTransform::Rotate180 => 180.0,
            FontTransform::Rotate270 => 270.0,
        };
        self.surface.push_transform(&Transform::from_rotate_at(turn, anchor.x, anchor.y));
        self.surface.set_stroke(None);
        self.surface.set_fill(Some(fill_of(style.color())));
        self.surface.draw_glyphs(start, &glyphs, self.face.clone(), text, em, false);
        self.surface.pop();
        Ok(())
    }

    fn blit_bitmap(&mut self, at: BackendCoord, (width, height): (u32, u32), rgb: &[u8]) -> Drawn {
        let rgba = rgb.as_chunks::<3>().0.iter().flat_map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
        let Some(size) = Size::from_wh(width as f32 * POINTS, height as f32 * POINTS) else { return Ok(()) };
        let corner = place(at);
        self.surface.push_transform(&Transform::from_translate(corner.x, corner.y));
        self.surface.draw_image(Image::from_rgba8(rgba, width, height), size);
        self.surface.pop();
        Ok(())
    }
}
