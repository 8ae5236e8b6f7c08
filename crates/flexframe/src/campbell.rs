//! `flexframe campbell`: natural frequencies of a scene's body against the speed of a spin that is held.
//!
//! The body spins steadily about an axis through its origin: the centre of mass of a free body, a fixed point of one
//! that is held (of a clamp or a slider the mean of its nodes). Frequencies are those that the body itself sees, so that
//! order n stands for a load that comes by n times a turn, such as one that stands still in space. Vibrations are about
//! the undeformed body, without damping and without the scene's loads.

mod branches;
mod critical;
mod diagram;
mod files;
mod table;

use std::path::{Path, PathBuf};

use figures::FigureError;
use frames_rk4::{EigenError, SteadySpin};
use nalgebra::Vector3;
use scene::{BuildError, BuildProgress, Choice, Flexible, Model, Scene};
use serde::Serialize;

pub use critical::Critical;

use crate::json;
use crate::modes::{frequency_unit, require_flexible};
use crate::report::MeshReport;
use branches::Branches;

/// A diagram that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CampbellError {
    /// The scene cannot be built, or has no modes.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The vibrations cannot be found.
    #[error("{}: {source}", scene.display())]
    Eigen {
        /// The scene file.
        scene: PathBuf,
        /// Why.
        source: EigenError,
    },
    /// The axis has no direction.
    #[error("axis {axis:?}: expected three finite numbers that are not all zero, in the axes of the mesh")]
    Axis {
        /// The axis.
        axis: [f64; 3],
    },
    /// The speeds are no range.
    #[error(
        "speeds {start}:{end}:{count}: expected start:end:count, radians per time, with 0 ≤ start < end and a count of 2 \
         to {MOST_SPEEDS}, e.g. 0:200:50"
    )]
    Speeds {
        /// The lowest.
        start: f64,
        /// The highest.
        end: f64,
        /// How many.
        count: usize,
    },
    /// An engine order is not positive.
    #[error("order {order}: expected a positive number of times a turn, e.g. 1, 2 or 0.5")]
    Order {
        /// The order.
        order: f64,
    },
    /// The diagram cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// How far a diagram has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CampbellProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// The vibrations are followed from speed to speed.
    Speeds {
        /// Speeds that are done.
        done: usize,
        /// All of them.
        total: usize,
    },
}

/// Each speed takes an eigenvalue problem, and a row of a table.
const MOST_SPEEDS: usize = 10_000;

/// Equally spaced spin speeds, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// The lowest, radians per time, ≥ 0.
    pub start: f64,
    /// The highest, radians per time.
    pub end: f64,
    /// How many, 2 to 10 000.
    pub count: usize,
}

impl Speeds {
    fn values(&self) -> Result<Vec<f64>, CampbellError> {
        let &Self { start, end, count } = self;
        if !(start >= 0.0 && end > start && end.is_finite() && (2..=MOST_SPEEDS).contains(&count)) {
            return Err(CampbellError::Speeds { start, end, count });
        }
        let last = (count - 1) as f64;
        Ok((0..count).map(|i| ((last - i as f64) * start + i as f64 * end) / last).collect())
    }
}

/// What a diagram is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct CampbellSettings {
    /// Direction of the spin, axes of the mesh; any length but zero.
    pub axis: [f64; 3],
    /// The spin speeds.
    pub speeds: Speeds,
    /// Engine orders: loads that come by so many times a turn.
    pub orders: Vec<f64>,
}

/// Natural frequencies against spin speed.
#[derive(Debug, Clone, Serialize)]
pub struct CampbellReport {
    /// Title of the scene.
    pub title: String,
    /// Label of the unit of time.
    pub time_unit: String,
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// The finite-element model.
    pub mesh: Option<MeshReport>,
    /// The spin axis: unit vector, axes of the mesh.
    pub axis: [f64; 3],
    /// The point that the axis goes through, mesh axes.
    pub origin: [f64; 3],
    /// The effects of the spin that are computed.
    pub effects: SpinEffects,
    /// Spin speeds, radians per time.
    pub speeds: Vec<f64>,
    /// The lines of the diagram, in the order of their frequencies at the lowest speed.
    pub branches: Vec<Branch>,
    /// The spin speed at which the body loses its stability because K + Ω²(K_σ − N) is no longer positive definite; none
    /// if it never does.
    pub stable_below: Option<f64>,
    /// Where orders and branches cross, by order and speed; order 0 where a frequency is zero.
    pub critical_speeds: Vec<Critical>,
    /// Files written.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}

/// Effects of the spin that are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SpinEffects {
    /// Coriolis forces, G.
    pub coriolis: bool,
    /// The centrifugal forces of the deformation, N.
    pub softening: bool,
    /// The stress of the centrifugal field, K_σ.
    pub stiffening: bool,
}

/// A vibration followed through all spin speeds by its shape.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Branch {
    /// Its number as `flexframe modes` counts, at the lowest speed.
    pub mode: usize,
    /// Frequency at each speed, cycles per time.
    pub frequency: Vec<f64>,
    /// Growth at each speed, 1 per time: positive where the vibration is unstable.
    pub growth: Vec<f64>,
    /// Sense of the vibration at each speed: 1 forwards round the axis, −1 backwards, 0 to and fro.
    pub whirl: Vec<f64>,
}

/// Computes the diagram of a scene, and writes `campbell.csv`, `critical_speeds.csv`, `campbell.svg` and `campbell.png`
/// to `folder`.
///
/// Effects are those of the scene's `[effects]`, where `"auto"` is on. All its modes are kept (`flexible = "auto"`: the
/// most there may be).
///
/// # Errors
/// [`CampbellError`].
pub fn campbell(
    scene: &Scene,
    folder: &Path,
    settings: &CampbellSettings,
    mut progress: impl FnMut(CampbellProgress),
) -> Result<CampbellReport, CampbellError> {
    let axis = Vector3::from(settings.axis);
    let axis = axis.try_normalize(0.0).filter(|axis| (axis.norm() - 1.0).abs() < 1e-12);
    let axis = axis.ok_or(CampbellError::Axis { axis: settings.axis })?;
    let speeds = settings.speeds.values()?;
    if let Some(&order) = settings.orders.iter().find(|order| !(**order > 0.0 && order.is_finite())) {
        return Err(CampbellError::Order { order });
    }
    let mut scene = scene.clone();
    scene.loads.clear();
    scene.modes.flexible = Flexible::Count(scene.modes.flexible.most());
    // The spin is given here, whatever the scene's own motion would call for.
    let effects = &mut scene.effects;
    for choice in [&mut effects.deformed_inertia, &mut effects.coriolis, &mut effects.geometric_stiffening] {
        if *choice == Choice::Auto {
            *choice = Choice::On;
        }
    }
    let model = Model::build(&scene, |p| progress(CampbellProgress::Build(p)))?;
    require_flexible(&scene, &model).map_err(BuildError::from)?;

    let effects = &model.physics.effects;
    let spin = SteadySpin::new(&model.body, &axis, effects);
    let total = speeds.len();
    let failed = |source| CampbellError::Eigen { scene: scene.path.clone(), source };
    let branches =
        Branches::follow(&spin, speeds, |done| progress(CampbellProgress::Speeds { done, total })).map_err(failed)?;
    let critical_speed = spin.critical_speed().map_err(failed)?;
    let mut report = CampbellReport {
        title: scene.title.clone(),
        time_unit: scene.units.time.clone(),
        frequency_unit: frequency_unit(&scene.units.time),
        mesh: MeshReport::new(&model),
        axis: axis.into(),
        origin: model.body.origin.into(),
        effects: SpinEffects {
            coriolis: effects.coriolis,
            softening: effects.deformed_inertia,
            stiffening: effects.geometric_stiffening,
        },
        stable_below: critical_speed.is_finite().then_some(critical_speed),
        critical_speeds: critical::find(&spin, &branches, &settings.orders).map_err(failed)?,
        branches: branches.lines(),
        speeds: branches.speeds,
        files: Vec::new(),
    };
    report.files = files::write(&report, folder, &settings.orders)?;
    Ok(report)
}
