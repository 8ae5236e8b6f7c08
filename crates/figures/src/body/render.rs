//! Surfaces and lines in space, drawn into a bitmap that knows the depth of each dot.
//!
//! The nearest of all things wins a dot, so that hidden parts are right for any shape, and the size
//! of a picture does not depend on the number of triangles.

use plotters::prelude::*;

use crate::FigureError;
use crate::body::view::Seen;
use crate::document::picture::Area;

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
    let of_light = |light| (0..values).map(move |value| lit(value_colour(grade(value, values)), light, lights));
    (0..lights).flat_map(of_light).collect()
}

/// The colours of a surface without values, by light.
pub(crate) fn plain_colours(lights: usize) -> impl Iterator<Item = [u8; 3]> {
    (0..lights).map(move |light| lit(PLAIN, light, lights))
}

/// A colour in one of some grades of light.
fn lit(RGBColor(r, g, b): RGBColor, light: usize, lights: usize) -> [u8; 3] {
    let light = DARKEST + (1.0 - DARKEST) * grade(light, lights);
    [r, g, b].map(|channel| (light * f64::from(channel)).round() as u8)
}

fn grade(i: usize, count: usize) -> f64 {
    i as f64 / (count - 1).max(1) as f64
}

/// The corners of a triangle: right and down in dots, and towards the viewer.
pub(crate) type Corners = [Seen; 3];

/// No triangle.
const NONE: u32 = u32::MAX;

/// A surface without values.
const PLAIN: RGBColor = RGBColor(190, 194, 200);

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
    /// Which triangle of the surface is seen at each dot.
    owner: Vec<u32>,
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
            owner: vec![NONE; width * height],
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

    fn put(&mut self, x: usize, y: usize, depth: f64, colour: impl FnOnce(&Self) -> [u8; 3]) -> bool {
        let i = self.width * y + x;
        let is_nearest = depth > self.depth[i];
        if is_nearest {
            self.depth[i] = depth;
            let colour = colour(self);
            self.rgb[3 * i..3 * i + 3].copy_from_slice(&colour);
        }
        is_nearest
    }

    pub(crate) fn corners(&self, triangle: &[u32; 3], points: &[Seen]) -> Corners {
        triangle.map(|i| self.dots(&points[i as usize]))
    }

    /// The grade of the light on a triangle, from the viewer's side.
    fn light(&self, [a, b, c]: &Corners) -> usize {
        let normal = (b - a).cross(&(c - a));
        let light = (normal / normal.norm() * normal.z.signum()).dot(&Seen::new(-0.35, -0.45, 0.82)).max(0.0);
        (light * (self.grades.lights - 1) as f64).round() as usize
    }

    /// Where the colours of a triangle begin, which are those of its light.
    fn row(&self, corners: &Corners) -> usize {
        self.light(corners) * self.grades.values
    }

    fn graded(&self, value: f64) -> usize {
        (value.clamp(0.0, 1.0) * (self.grades.values - 1) as f64).round() as usize
    }

    /// The colour of a triangle with one value from 0 to 1.
    pub(crate) fn colour(&self, corners: &Corners, value: f64) -> [u8; 3] {
        self.colours[self.row(corners) + self.graded(value)]
    }

    /// A surface coloured by `values` between 0 and 1, lit from the viewer's side.
    pub(crate) fn surface(&mut self, triangles: &[[u32; 3]], points: &[Seen], values: &[f64]) {
        let size = [self.width, self.height];
        for (number, triangle) in (0_u32..).zip(triangles) {
            let corners = self.corners(triangle, points);
            let [va, vb, vc] = triangle.map(|i| values[i as usize]);
            let row = self.row(&corners);
            each_dot(&corners, size, |x, y, [wa, wb, wc], depth| {
                let value = wa * va + wb * vb + wc * vc;
                if self.put(x, y, depth, |canvas| canvas.colours[row + canvas.graded(value)]) {
                    self.owner[size[0] * y + x] = number;
                }
            });
        }
    }

    /// A surface without values, lit in the same way.
    pub(crate) fn plain_surface(&mut self, triangles: &[[u32; 3]], points: &[Seen]) {
        let size = [self.width, self.height];
        for triangle in triangles {
            let corners = self.corners(triangle, points);
            let colour = lit(PLAIN, self.light(&corners), self.grades.lights);
            each_dot(&corners, size, |x, y, _, depth| {
                self.put(x, y, depth, |_| colour);
            });
        }
    }

    /// The triangles of the surface that are seen at one dot or more, in their order.
    pub(crate) fn owners(&self) -> Vec<u32> {
        let mut owners: Vec<u32> = self.owner.iter().copied().filter(|owner| *owner != NONE).collect();
        owners.sort_unstable();
        owners.dedup();
        owners
    }

    /// Which part of the dots would show something too far away if triangles were painted in this order.
    pub(crate) fn painted_wrongly<'a>(&self, order: impl Iterator<Item = &'a Corners>) -> f64 {
        let mut painted = vec![f64::NEG_INFINITY; self.depth.len()];
        for corners in order {
            each_dot(corners, [self.width, self.height], |x, y, _, depth| painted[self.width * y + x] = depth);
        }
        let seen = || self.depth.iter().zip(&painted).filter(|(depth, _)| **depth > f64::NEG_INFINITY);
        let wrong = seen().filter(|(depth, painted)| **painted < **depth - 2.0).count();
        wrong as f64 / seen().count().max(1) as f64
    }

    /// The parts of a line between two points that no surface hides by more than its width, in dots.
    pub(crate) fn unhidden(&self, from: &Seen, to: &Seen, width: f64) -> Vec<[Seen; 2]> {
        let (from, to) = (self.dots(from), self.dots(to));
        let steps = (to - from).xy().amax().ceil().max(1.0);
        let at = |step: usize| from + (to - from) * (step as f64 / steps);
        let is_seen = |step: &usize| {
            let point = at(*step);
            let is_on = (0.0..self.width as f64).contains(&point.x) && (0.0..self.height as f64).contains(&point.y);
            is_on && self.depth[self.width * point.y as usize + point.x as usize] < point.z + 1.5 * width
        };
        let all: Vec<usize> = (0..=steps as usize).collect();
        let parts = all.chunk_by(|a, b| is_seen(a) == is_seen(b)).filter(|part| part.len() > 1 && is_seen(&part[0]));
        parts.map(|part| [at(part[0]), at(part[part.len() - 1])]).collect()
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

/// Calls with each dot of a triangle, within a canvas of this width and height: its place, the weights of the corners, and
/// how near it is.
fn each_dot(corners: &Corners, [width, height]: [usize; 2], mut call: impl FnMut(usize, usize, [f64; 3], f64)) {
    let [a, b, c] = corners;
    // Twice the area on the screen, negative for a triangle that is seen from its back.
    let area = (b - a).cross(&(c - a)).z;
    if area == 0.0 {
        return;
    }
    let range = |low: f64, high: f64, end: usize| {
        (low - 0.5).ceil().max(0.0) as usize..((high - 0.5).floor() + 1.0).clamp(0.0, end as f64) as usize
    };
    let (xs, ys) = ([a.x, b.x, c.x], [a.y, b.y, c.y]);
    let least = |v: [f64; 3]| v[0].min(v[1]).min(v[2]);
    let most = |v: [f64; 3]| v[0].max(v[1]).max(v[2]);
    for y in range(least(ys), most(ys), height) {
        for x in range(least(xs), most(xs), width) {
            let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
            // Barycentric coordinates of the dot.
            let wa = ((b.x - px) * (c.y - py) - (c.x - px) * (b.y - py)) / area;
            let wb = ((c.x - px) * (a.y - py) - (a.x - px) * (c.y - py)) / area;
            let wc = 1.0 - wa - wb;
            if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 {
                call(x, y, [wa, wb, wc], wa * a.z + wb * b.z + wc * c.z);
            }
        }
    }
}

/// Refuses a surface whose indices do not fit, before it is drawn.
pub(crate) fn check_indices<const N: usize>(
    figure: &str,
    what: &str,
    cells: &[[u32; N]],
    count: usize,
) -> Result<(), FigureError> {
    check_index(figure, what, cells.iter().flatten().map(|&i| i as usize), count)
}

/// Refuses the numbers of points that are not there.
pub(crate) fn check_index(
    figure: &str,
    what: &str,
    indices: impl IntoIterator<Item = usize>,
    count: usize,
) -> Result<(), FigureError> {
    match indices.into_iter().find(|index| *index >= count) {
        None => Ok(()),
        Some(index) => Err(FigureError::unfit(
            figure,
            format!("has {what} that names point {index}, but there are {count} points"),
        )),
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
            let words = format!("has {what}: {list} with {found} entries where {count} are expected");
            return Err(FigureError::unfit(figure, words));
        }
    }
    let finite = |i: &usize| points[*i].iter().all(|x| x.is_finite()) && values[*i].is_finite();
    match (0..count).find(|i| !finite(i)) {
        None => Ok(()),
        Some(index) => {
            Err(FigureError::unfit(figure, format!("has a value that is not finite: {what}, entry {index}")))
        }
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
