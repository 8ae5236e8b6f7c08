//! The modes kept and their damping.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::body::effects::Choice;
use crate::body::measured::Measured;

/// The modes kept and their damping: `[modes]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// How many flexible modes, the lowest first.
    pub flexible: Flexible,
    /// Damping of the flexible modes; default none. Rigid modes are never damped.
    pub damping: Damping,
    /// The choice to add static shapes of the loads and of the centrifugal field to the modes.
    pub static_correction: Choice,
    /// Which modes may bend the body far.
    pub large: Option<Large>,
    /// Most modes that follow the large ones.
    pub following: usize,
    /// The bent body that all modes are about; without, the undeformed one.
    pub about: Option<About>,
    /// Measured frequencies and damping, which replace those of the model.
    pub measured: Option<Measured>,
}

/// The steady state that the modes of a body are about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum About {
    /// `"spin"`: its rest in the largest spin of its drive.
    Spin,
    /// `"loads"`: its rest under its steady loads.
    Loads,
    /// `"auto"`: its rest under both, where they bend it far.
    Auto,
    /// Its rest in this spin, under its steady loads or without.
    Given {
        /// The spin, radians per time, axes of the body.
        angular_velocity: [f64; 3],
        /// True if the steady loads act.
        loads: bool,
    },
}

/// Which modes may bend the body far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Large {
    /// The number of first modes, 1 to 4.
    Count(usize),
    /// These, numbered from 1, ascending, 1 to 4 of them.
    List(Vec<usize>),
}

/// How many flexible modes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flexible {
    /// Their number; 0 is a body that does not deform.
    Count(usize),
    /// `"auto"`: as many as the loads call for.
    Auto {
        /// Key `most`: not more than these, ≥ 1; default 40.
        most: usize,
    },
}

impl Flexible {
    /// The largest number of modes that this can be.
    pub fn most(self) -> usize {
        match self {
            Self::Count(count) => count,
            Self::Auto { most } => most,
        }
    }
}

/// Damping ratios ζ ≥ 0 of the flexible modes (1 is critical): the scene has at most one of the three keys.
#[derive(Clone, Debug, PartialEq)]
pub enum Damping {
    /// Key `damping_ratio`, a number: the same for every mode.
    Uniform(f64),
    /// Key `damping_ratio`, a list: one a mode, the lowest first, at least one; the last holds for the rest.
    List(Vec<f64>),
    /// Key `damping_table`: pairs of frequency (cycles per time, rising) and ratio, at least one; straight lines
    /// between them, the first and the last ratio held outside.
    Table(Vec<[f64; 2]>),
    /// Key `rayleigh`: C = α M + β K, ζ = α / (2 ω) + β ω / 2.
    Rayleigh(Rayleigh),
}

/// Damping in proportion to mass and stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rayleigh {
    /// Factor α ≥ 0 of the mass matrix, 1 per time.
    pub alpha: f64,
    /// Factor β ≥ 0 of the stiffness matrix, time.
    pub beta: f64,
}

impl Damping {
    /// Damping ratio of a flexible mode by its number from 0 and its angular frequency > 0, radians per time.
    pub fn ratio(&self, mode: usize, omega: f64) -> f64 {
        match self {
            Self::Uniform(ratio) => *ratio,
            Self::List(ratios) => ratios.get(mode).or(ratios.last()).copied().unwrap_or_default(),
            Self::Table(points) => interpolated(points, omega / std::f64::consts::TAU),
            Self::Rayleigh(Rayleigh { alpha, beta }) => alpha / (2.0 * omega) + beta * omega / 2.0,
        }
    }
}

/// The value at `x` on the straight lines between points of rising first coordinate, held outside.
fn interpolated(points: &[[f64; 2]], x: f64) -> f64 {
    match points.partition_point(|[at, _]| *at <= x) {
        0 => points.first().map_or(0.0, |[_, value]| *value),
        after if after == points.len() => points[after - 1][1],
        after => {
            let ([x0, y0], [x1, y1]) = (points[after - 1], points[after]);
            y0 + (y1 - y0) * ((x - x0) / (x1 - x0))
        }
    }
}
