//! Surfaces and lines in space, drawn into a bitmap that knows the depth of each dot.
//!
//! The nearest of all things wins a dot, so that hidden parts are right for any shape, and the size
//! of a picture does not depend on the number of triangles.

use plotters::prelude::*;

use crate::FigureError;
use crate::picture::Area;
use crate::view::Seen;

/// How finely the colours of a surface are graded: by value and by the light on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Grades {
    pub(crate) values: usize,
    pub(crate) lights: usize,
}

/// A perceptually uniform colour for a value from 0 to 1.
pub(crate) fn value_colour(value: f64) -> RGBColor {
    ViridisRGB.get_color(value.clamp(0.0, 1.0) as f32)
}

/// The colours of a surface: row by row of equal light, each by value.
pub(crate) fn surface_colours(Grades { values, lights }: Grades) -> Vec<[u8; 3]> {
    let grade = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    let of_light = |light: usize| {
        let light = DARKEST + (1.0 - DARKEST) * grade(light, lights);
        (0..values).map(move |value| {
            let RGBColor(r, g, b) = value_colour(grade(value, values));
            [r, g, b].map(|channel| (light * f64::from(channel)).round() as u8)
        })
    };
    (0..lights).flat_map(of_light).collect()
}

/// Brightness of a surface that is seen edge-on.
const DARKEST: f64 = 0.6;

pub(crate) struct Canvas {
    width: usize,
    height: usize,
    /// Dots per unit of length, and the place in space at the middle of the canvas.
    scale: f64,
    centre: [f64; 2],
    rgb: Vec<u8>,
    /// Nearness of each dot to the viewer.
    depth: Vec<f64>,
    grades: Grades,
    colours: Vec<[u8; 3]>,
}

impl Canvas {
    pub(crate) fn new(size: [u32; 2], scale: f64, centre: [f64; 2], grades: Grades) -> Self {
        let [width, height] = size.map(|n| n as usize);
        Self {
            width,
            height,
            scale,
            centre,
            rgb: vec![255; 3 * width * height],
            depth: vec![f64::NEG_INFINITY; width * height],
            grades,
            colours: surface_colours(grades),
        }
    }

    /// Draws the bitmap into an area of its size.
    pub(crate) fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Result<(), FigureError> {
        let size = (self.width as u32, self.height as u32);
        let bitmap: Option<BitMapElement<_>> = BitMapElement::with_ref((0, 0), size, &self.rgb);
        bitmap.map_or(Ok(()), |bitmap| Ok(area.draw(&bitmap)?))
    }

    /// A point in dots: right, down, and towards the viewer.
    fn dots(&self, point: &Seen) -> Seen {
        let (half_width, half_height) = (0.5 * self.width as f64, 0.5 * self.height as f64);
        Seen::new(
            half_width + self.scale * (point.x - self.centre[0]),
            half_height - self.scale * (point.y - self.centre[1]),
            self.scale * point.z,
        )
    }

    fn put(&mut self, x: usize, y: usize, depth: f64, colour: impl FnOnce(&Self) -> [u8; 3]) {
        let i = self.width * y + x;
        if depth > self.depth[i] {
            self.depth[i] = depth;
            let colour = colour(self);
            self.rgb[3 * i..3 * i + 3].copy_from_slice(&colour);
        }
    }

    /// A surface coloured by `values` between 0 and 1, lit from the viewer's side.
    pub(crate) fn surface(&mut self, triangles: &[[u32; 3]], points: &[Seen], values: &[f64]) {
        for triangle in triangles {
            let [a, b, c] = triangle.map(|i| self.dots(&points[i as usize]));
            let [va, vb, vc] = triangle.map(|i| values[i as usize]);
            let normal = (b - a).cross(&(c - a));
            // Twice the area on the screen, negative for a triangle that is seen from its back.
            let area = normal.z;
            if area == 0.0 {
                continue;
            }
            let light = (normal / normal.norm() * area.signum()).dot(&Seen::new(-0.35, -0.45, 0.82)).max(0.0);
            let row = (light * (self.grades.lights - 1) as f64).round() as usize * self.grades.values;
            let range = |low: f64, high: f64, end: usize| {
                (low - 0.5).ceil().max(0.0) as usize..((high - 0.5).floor() + 1.0).clamp(0.0, end as f64) as usize
            };
            let (xs, ys) = ([a.x, b.x, c.x], [a.y, b.y, c.y]);
            let least = |v: [f64; 3]| v[0].min(v[1]).min(v[2]);
            let most = |v: [f64; 3]| v[0].max(v[1]).max(v[2]);
            for y in range(least(ys), most(ys), self.height) {
                for x in range(least(xs), most(xs), self.width) {
                    let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                    // Barycentric coordinates of the dot.
                    let wa = ((b.x - px) * (c.y - py) - (c.x - px) * (b.y - py)) / area;
                    let wb = ((c.x - px) * (a.y - py) - (a.x - px) * (c.y - py)) / area;
                    let wc = 1.0 - wa - wb;
                    if wa < 0.0 || wb < 0.0 || wc < 0.0 {
                        continue;
                    }
                    let value = (wa * va + wb * vb + wc * vc).clamp(0.0, 1.0);
                    self.put(x, y, wa * a.z + wb * b.z + wc * c.z, |canvas| {
                        canvas.colours[row + (value * (canvas.grades.values - 1) as f64).round() as usize]
                    });
                }
            }
        }
    }

    /// A line between two points, `width` dots wide; hidden where a surface is nearer by more than that.
    pub(crate) fn line(&mut self, from: &Seen, to: &Seen, width: f64, colour: RGBColor) {
        let (from, to) = (self.dots(from), self.dots(to));
        let steps = (to - from).xy().amax().ceil().max(1.0);
        let radius = 0.5 * width;
        for step in 0..=steps as usize {
            let at = from + (to - from) * (step as f64 / steps);
            let reach = |middle: f64, end: usize| {
                let low = (middle - radius).ceil().clamp(0.0, end as f64) as usize;
                let high = ((middle + radius).floor() + 1.0).clamp(0.0, end as f64) as usize;
                low..high
            };
            for y in reach(at.y, self.height) {
                for x in reach(at.x, self.width) {
                    let RGBColor(r, g, b) = colour;
                    self.put(x, y, at.z + 1.5 * width, |_| [r, g, b]);
                }
            }
        }
    }
}

/// What is wrong with a surface before it is drawn.
pub(crate) fn check_indices<const N: usize>(
    figure: &str,
    what: &'static str,
    cells: &[[u32; N]],
    count: usize,
) -> Result<(), FigureError> {
    match cells.iter().flatten().map(|&i| i as usize).find(|&i| i >= count) {
        None => Ok(()),
        Some(index) => Err(FigureError::NoSuchPoint { figure: figure.into(), what, index, count }),
    }
}

/// The same for points and the values on them.
pub(crate) fn check_points(
    figure: &str,
    what: &str,
    count: usize,
    points: &[[f64; 3]],
    values: &[f64],
) -> Result<(), FigureError> {
    for (list, found) in [("points", points.len()), ("values", values.len())] {
        if found != count {
            let what = format!("{what}: {list}");
            return Err(FigureError::WrongLength { figure: figure.into(), what, expected: count, found });
        }
    }
    let finite = |i: &usize| points[*i].iter().all(|x| x.is_finite()) && values[*i].is_finite();
    match (0..count).find(|i| !finite(i)) {
        None => Ok(()),
        Some(index) => Err(FigureError::NotFinite { figure: figure.into(), what: what.into(), index }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADES: Grades = Grades { values: 16, lights: 4 };

    fn square(low: f64, high: f64, depth: f64) -> Vec<Seen> {
        [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Seen::new(x, y, depth)).to_vec()
    }

    #[test]
    fn the_nearer_surface_hides_the_other_in_either_order() {
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let (near, far) = (square(-1.0, 0.0, 1.0), square(-1.0, 1.0, 0.0));
        let draw = |order: [(&[Seen], f64); 2]| {
            let mut canvas = Canvas::new([40, 40], 20.0, [0.0, 0.0], GRADES);
            for (points, value) in order {
                canvas.surface(&triangles, points, &[value; 4]);
            }
            canvas.rgb
        };
        let rgb = draw([(&near, 0.0), (&far, 1.0)]);
        assert_eq!(rgb, draw([(&far, 1.0), (&near, 0.0)]));
        // The near square covers the lower left quarter, the far one the rest, and nothing is left white.
        let dark = rgb.chunks(3).filter(|dot| dot[1] < 60).count();
        assert_eq!((dark, rgb.chunks(3).filter(|dot| **dot == [255; 3]).count()), (400, 0));
    }

    #[test]
    fn a_line_behind_a_surface_is_hidden_and_one_on_it_is_not() {
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let mut canvas = Canvas::new([40, 40], 20.0, [0.0, 0.0], GRADES);
        canvas.surface(&triangles, &square(-1.0, 1.0, 0.0), &[1.0; 4]);
        let clean = canvas.rgb.clone();
        let red = RGBColor(255, 0, 0);
        canvas.line(&Seen::new(-1.0, 0.0, -1.0), &Seen::new(1.0, 0.0, -1.0), 2.0, red);
        assert_eq!(canvas.rgb, clean);
        canvas.line(&Seen::new(-1.0, 0.0, 0.0), &Seen::new(1.0, 0.0, 0.0), 2.0, red);
        assert!(canvas.rgb.chunks(3).filter(|dot| **dot == [255, 0, 0]).count() >= 80);
    }
}
