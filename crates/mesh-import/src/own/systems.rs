//! Positions in the systems of a deck: of Abaqus `*SYSTEM`, `SYSTEM=C` of `*NODE`, and the two lines that move an `*INSTANCE`; of Nastran
//! `CORD1x` and `CORD2x`.

/// A point or a vector.
type Vector = [f64; 3];

/// A motion without deformation: a rotation, then a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// Rows of the rotation.
    rotation: [Vector; 3],
    translation: Vector,
}

impl Placement {
    /// No motion.
    pub(crate) const NONE: Self =
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// Position of a point after it.
    pub(crate) fn of(&self, point: Vector) -> Vector {
        std::array::from_fn(|i| dot(self.rotation[i], point) + self.translation[i])
    }

    /// The system of the points `a` (its origin), `b` on its x axis and `c` in its xy plane: none where they are on a line.
    pub(crate) fn system(a: Vector, b: Vector, c: Vector) -> Option<Self> {
        let x = unit(minus(b, a))?;
        let z = unit(cross(x, minus(c, a)))?;
        let y = cross(z, x);
        Some(Self { rotation: std::array::from_fn(|i| [x[i], y[i], z[i]]), translation: a })
    }

    /// The system of the points `a` (its origin), `b` on its z axis and `c` in its xz plane: none where they are on a line.
    pub(crate) fn of_z_axis(a: Vector, b: Vector, c: Vector) -> Option<Self> {
        let z = unit(minus(b, a))?;
        let y = unit(cross(z, minus(c, a)))?;
        let x = cross(y, z);
        Some(Self { rotation: std::array::from_fn(|i| [x[i], y[i], z[i]]), translation: a })
    }

    /// A vector after its rotation.
    pub(crate) fn turned(&self, vector: Vector) -> Vector {
        std::array::from_fn(|i| dot(self.rotation[i], vector))
    }

    /// A translation.
    pub(crate) fn to(translation: Vector) -> Self {
        Self { translation, ..Self::NONE }
    }

    /// This one, and after it a turn about the line from `a` to `b` by an angle in degrees. None where there is no line.
    pub(crate) fn then_turned(&self, a: Vector, b: Vector, degrees: f64) -> Option<Self> {
        let axis = unit(minus(b, a))?;
        let (sine, cosine) = sine_and_cosine(degrees);
        let turned = |v: Vector| -> Vector {
            let (across, along) = (cross(axis, v), dot(axis, v) * (1.0 - cosine));
            std::array::from_fn(|i| v[i] * cosine + across[i] * sine + axis[i] * along)
        };
        let columns: [Vector; 3] = std::array::from_fn(|j| turned(std::array::from_fn(|i| self.rotation[i][j])));
        let moved = turned(minus(self.translation, a));
        Some(Self {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])),
            translation: std::array::from_fn(|i| moved[i] + a[i]),
        })
    }
}

/// Position in rectangular coordinates of a radius, an angle in degrees and a height.
pub(crate) fn cylindrical([radius, degrees, height]: Vector) -> Vector {
    let (sine, cosine) = sine_and_cosine(degrees);
    [radius * cosine, radius * sine, height]
}

/// Position in rectangular coordinates of a radius, the angle from the z axis and the one about it, in degrees.
pub(crate) fn spherical([radius, from_z, about_z]: Vector) -> Vector {
    let ((s, c), (sine, cosine)) = (sine_and_cosine(from_z), sine_and_cosine(about_z));
    [radius * s * cosine, radius * s * sine, radius * c]
}

/// Exact at quarters of a turn, so that nodes of two parts meet.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    let quarters = degrees / 90.0;
    if quarters.fract() == 0.0 {
        return [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters.rem_euclid(4.0) as usize % 4];
    }
    degrees.to_radians().sin_cos()
}

/// The length between two points, or the area between three or four.
pub(crate) fn size(corners: &[Vector]) -> Option<f64> {
    let area = |a: Vector, b: Vector| {
        let across = cross(a, b);
        dot(across, across).sqrt() / 2.0
    };
    match *corners {
        [a, b] => Some(dot(minus(b, a), minus(b, a)).sqrt()),
        [a, b, c] => Some(area(minus(b, a), minus(c, a))),
        [a, b, c, d] => Some(area(minus(c, a), minus(d, b))),
        _ => None,
    }
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: Vector) -> Option<Vector> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vector, b: Vector) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    /// Closed form: turns by a quarter, and axes that are named.
    #[test]
    fn points_are_moved_and_turned() {
        assert!(near(cylindrical([2.0, 90.0, 3.0]), [0.0, 2.0, 3.0]));
        assert!(near(cylindrical([2.0, 30.0, 3.0]), [3.0_f64.sqrt(), 1.0, 3.0]));
        assert!(near(spherical([2.0, 90.0, 90.0]), [0.0, 2.0, 0.0]));
        assert!(near(spherical([2.0, 60.0, 0.0]), [3.0_f64.sqrt(), 0.0, 1.0]));
        // z of the system is along X, x along Y.
        let system = Placement::of_z_axis([1.0, 2.0, 3.0], [5.0, 2.0, 3.0], [7.0, 8.0, 3.0]).unwrap();
        assert!(near(system.of([1.0, 10.0, 100.0]), [101.0, 3.0, 13.0]));
        assert!(near(system.turned([1.0, 10.0, 100.0]), [100.0, 1.0, 10.0]));
        // x of the system is along Z, y along X.
        let system = Placement::system([1.0, 2.0, 3.0], [1.0, 2.0, 5.0], [4.0, 2.0, 3.0]).unwrap();
        assert!(near(system.of([1.0, 10.0, 100.0]), [11.0, 102.0, 4.0]));
        assert_eq!(Placement::system([0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]), None);
        // Moved first, then turned about the line x = 1, y = 0.
        let moved = Placement::to([1.0, 0.0, 0.0]).then_turned([1.0, 0.0, 0.0], [1.0, 0.0, 7.0], 90.0).unwrap();
        assert!(near(moved.of([2.0, 0.0, 5.0]), [1.0, 2.0, 5.0]));
    }
}
