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

impl View {
    /// A standard view: `iso`, where the axes look equally long; `xy`, `xz` or `yz`, the first axis to the right and the second
    /// one up; `x`, `y`, `z`, `-x`, `-y` or `-z`, from where the viewer is. `None` for any other word.
    pub fn named(name: &str) -> Option<Self> {
        let (azimuth, elevation) = match name {
            // The height of a cube's diagonal above its base.
            "iso" => (-45.0, 0.5_f64.sqrt().atan().to_degrees()),
            "x" | "yz" => (0.0, 0.0),
            "y" => (90.0, 0.0),
            // With x to the right and y up.
            "z" | "xy" => (-90.0, 90.0),
            "-x" => (180.0, 0.0),
            "-y" | "xz" => (-90.0, 0.0),
            "-z" => (-90.0, -90.0),
            _ => return None,
        };
        Some(Self { azimuth, elevation })
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

    /// Closed form: axes to the right, up and towards the viewer; in the isometric view all are √(2/3) long.
    #[test]
    fn standard_views_look_along_the_axes() {
        let seen = |name: &str| {
            let view = View::named(name).unwrap();
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| view.see(&axis))
        };
        for (name, right, up) in [("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2)] {
            let axes = seen(name);
            assert!((axes[right].x - 1.0).abs() < 1e-15 && (axes[up].y - 1.0).abs() < 1e-15, "{name}");
        }
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            assert!((seen(name)[i].z - 1.0).abs() < 1e-15, "{name}");
            assert!((seen(&format!("-{name}"))[i].z + 1.0).abs() < 1e-15, "-{name}");
        }
        let lengths = seen("iso").map(|axis| axis.x.hypot(axis.y));
        assert!(lengths.iter().all(|length| (length - (2.0_f64 / 3.0).sqrt()).abs() < 1e-15), "{lengths:?}");
        assert!(seen("iso")[2].y > 0.8 && seen("iso").iter().all(|axis| axis.z.abs() > 0.5));
        assert_eq!(View::named("front"), None);
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
