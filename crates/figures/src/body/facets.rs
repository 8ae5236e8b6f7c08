//! Visible areas and lines of a surface, for documents that hold vectors.

use nalgebra::Vector2;
use plotters::prelude::*;
use plotters_backend::BackendCoord;

use crate::FigureError;
use crate::body::render::{Canvas, Corners};
use crate::body::view::Seen;
use crate::document::picture::{Area, Unit};

/// Documents with more areas and lines than this (about two megabytes, as bitmaps take) hold bitmaps of their bodies.
pub(crate) const MOST: usize = 20_000;
/// In pixels: how far an area reaches below the next one, so that no seam is seen between them.
const OVERLAP: f64 = 0.4;
/// A corner moves no further than this times that.
const SHARPEST: f64 = 4.0;
/// Areas are painted from the farthest to the nearest. A surface where this shows more than such a part of it wrongly, as
/// where long areas pass through each other, is no set of areas.
const WRONG: f64 = 2e-3;

/// Areas from the farthest to the nearest, and lines upon them.
pub(crate) struct Facets {
    areas: Vec<([BackendCoord; 3], RGBColor)>,
    lines: Vec<([BackendCoord; 2], ShapeStyle)>,
}

impl Facets {
    /// Visible facets of a surface that has been drawn on the canvas; `None` where painting would show it wrongly.
    pub(crate) fn of(
        canvas: &Canvas,
        triangles: &[[u32; 3]],
        points: &[Seen],
        values: &[f64],
        unit: Unit,
    ) -> Option<Self> {
        let nearness = |corners: &Corners| corners.iter().map(|corner| corner.z).sum::<f64>();
        let mut seen: Vec<(Corners, RGBColor)> = canvas
            .owners()
            .into_iter()
            .map(|i| {
                let triangle = triangles[i as usize];
                let corners = canvas.corners(&triangle, points);
                let value = triangle.iter().map(|i| values[*i as usize]).sum::<f64>() / 3.0;
                let [r, g, b] = canvas.colour(&corners, value);
                (corners, RGBColor(r, g, b))
            })
            .collect();
        seen.sort_by(|(a, _), (b, _)| nearness(a).total_cmp(&nearness(b)));
        if canvas.painted_wrongly(seen.iter().map(|(corners, _)| corners)) > WRONG {
            return None;
        }
        let overlap = OVERLAP * unit.per_pixel();
        let areas = seen.into_iter().map(|(corners, colour)| (grown(&corners, overlap), colour)).collect();
        Some(Self { areas, lines: Vec::new() })
    }

    /// Adds the parts of a line, with its width in units, that no surface hides.
    pub(crate) fn line(&mut self, canvas: &Canvas, from: &Seen, to: &Seen, width: f64, colour: RGBColor) {
        let style = colour.stroke_width(width.round().max(1.0) as u32);
        self.lines.extend(canvas.unhidden(from, to, width).into_iter().map(|ends| (ends.map(|p| rounded(&p)), style)));
    }

    pub(crate) fn count(&self) -> usize {
        self.areas.len() + self.lines.len()
    }

    pub(crate) fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Result<(), FigureError> {
        for (corners, colour) in &self.areas {
            area.draw(&Polygon::new(corners.to_vec(), colour.filled()))?;
        }
        for (ends, style) in &self.lines {
            area.draw(&PathElement::new(ends.to_vec(), *style))?;
        }
        Ok(())
    }
}

/// A triangle whose sides lie farther out by this much; sharp corners are cut short.
fn grown(corners: &Corners, by: f64) -> [BackendCoord; 3] {
    let side = |i: usize| (corners[(i + 1) % 3] - corners[i]).xy();
    let turn = side(0).perp(&side(1)).signum();
    // Outwards from the side that begins at a corner.
    let normal = |i: usize| {
        let side = side(i);
        Vector2::new(side.y, -side.x) * (turn / side.norm().max(f64::MIN_POSITIVE))
    };
    [0, 1, 2].map(|i| {
        let (before, after) = (normal((i + 2) % 3), normal(i));
        let out = (before + after) * (by / (1.0 + before.dot(&after)).max(1e-12));
        let out = out * (SHARPEST * by / out.norm().max(SHARPEST * by));
        rounded(&Seen::new(corners[i].x + out.x, corners[i].y + out.y, 0.0))
    })
}

fn rounded(point: &Seen) -> BackendCoord {
    (point.x.round() as i32, point.y.round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a triangle with sides of 3, 4 and 5.
    #[test]
    fn a_grown_triangle_has_its_sides_moved_outwards_whichever_way_it_turns() {
        let corners = [(0.0, 0.0), (30.0, 0.0), (0.0, 40.0)].map(|(x, y)| Seen::new(x, y, 1.0));
        let [a, b, c] = corners;
        // Sides of 3, 4 and 5: the offset moves the slanted one by (0.8, 0.6) of it, and the acute corners by more along it.
        assert_eq!(grown(&corners, 10.0), [(-10, -10), (50, -10), (-10, 60 + 10)]);
        assert_eq!(grown(&[a, c, b], 10.0), [(-10, -10), (-10, 70), (50, -10)]);
        let needle = [(0.0, 0.0), (1000.0, 1.0), (1000.0, -1.0)].map(|(x, y)| Seen::new(x, y, 0.0));
        assert_eq!(grown(&needle, 2.0)[0], (-8, 0));
    }
}
