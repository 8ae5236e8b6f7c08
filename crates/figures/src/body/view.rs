//! A parallel projection and how it is fitted to a picture.

use nalgebra::Vector3;

/// The direction from which a body is seen, the global z axis upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Angle of the viewer about z from the x axis, in degrees; −90 looks along +y.
    pub azimuth: f64,
    /// Angle of the viewer above the xy plane, in degrees.
    pub elevation: f64,
}

impl Default for View {
    fn default() -> Self {
        Self { azimuth: -60.0, elevation: 25.0 }
    }
}

/// Seen from the viewer: to the right, up, and towards them.
pub(crate) type Seen = Vector3<f64>;

impl View {
    /// Components of a point along right, up and towards the viewer.
    pub(crate) fn see(&self, point: &[f64; 3]) -> Seen {
        let (sin_a, cos_a) = self.azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation.to_radians().sin_cos();
        let [x, y, z] = *point;
        let outwards = cos_a * x + sin_a * y;
        Vector3::new(cos_a * y - sin_a * x, cos_e * z - sin_e * outwards, cos_e * outwards + sin_e * z)
    }
}

/// The smallest upright rectangle around points as seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    low: [f64; 2],
    high: [f64; 2],
}

impl Window {
    pub(crate) fn around(points: impl Iterator<Item = Seen>) -> Self {
        let empty = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        points.fold(empty, |Self { low, high }, p| Self {
            low: [low[0].min(p.x), low[1].min(p.y)],
            high: [high[0].max(p.x), high[1].max(p.y)],
        })
    }

    pub(crate) fn size(&self) -> [f64; 2] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1]]
    }

    pub(crate) fn centre(&self) -> [f64; 2] {
        [0.5 * (self.low[0] + self.high[0]), 0.5 * (self.low[1] + self.high[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: the projection keeps lengths and handedness.
    #[test]
    fn the_projection_is_a_rotation() {
        let view = View { azimuth: 37.0, elevation: -22.0 };
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| view.see(&axis));
        assert!((x.cross(&y) - z).norm() < 1e-15 && (x.norm() - 1.0).abs() < 1e-15);
    }

    /// Closed form: views along the axes.
    #[test]
    fn from_the_front_x_is_right_and_z_is_up() {
        let view = View { azimuth: -90.0, elevation: 0.0 };
        assert!((view.see(&[1.0, 2.0, 3.0]) - Vector3::new(1.0, 3.0, -2.0)).norm() < 1e-15);
        let above = View { azimuth: -90.0, elevation: 90.0 };
        assert!((above.see(&[1.0, 2.0, 3.0]) - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-15);
    }
}
