//! `flexframe campbell`: natural frequencies of a scene's body against the speed of a spin that is held.
//!
//! The body spins steadily about an axis through its origin: the centre of mass of a free body, a fixed point of one
//! that is held (of a clamp or a slider the mean of its nodes). Frequencies are those that the body itself sees, so that
//! order n stands for a load that comes by n times a turn, such as one that stands still in space. Vibrations are about
//! the undeformed body or, where the spin bends it, about the rest of the full body at each speed ([`AboutRest`]), without damping and
//! without the scene's loads.

mod bent;
mod branches;
mod critical;
mod diagram;
mod family;
mod limits;
mod report;
mod system;

use ::report::Report;
use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Effect, SpinMode, SteadySpin};
use model::{BuildError, BuildProgress, Builder, Needs};
use nalgebra::Vector3;
use scene::{Body, Scene};

pub use bent::AboutRest;
pub use report::FILES;
use report::{Diagram, SpinEffects};

use crate::commands::modes::require_flexible;
use crate::report::MeshReport;
use bent::BentSpin;
use family::Family;

/// Each speed takes an eigenvalue problem, and a row of a table.
const MAX_SPEEDS: usize = 10_000;

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
    fn values(&self) -> Result<Vec<f64>, Failure> {
        let &Self { start, end, count } = self;
        if !(start >= 0.0 && end > start && end.is_finite() && (2..=MAX_SPEEDS).contains(&count)) {
            let expected =
                format!("start:end:count, radians per time, with 0 ≤ start < end and a count of 2 to {MAX_SPEEDS}");
            let wrong = Kind::Usage.alone().found(format!("{start}:{end}:{count}")).expected(&expected);
            let words = format!("speeds {start}:{end}:{count}: expected {expected}");
            return Err(wrong.help("give a range, such as 0:200:50").says(words));
        }
        let last = (count - 1) as f64;
        Ok((0..count).map(|i| ((last - i as f64) * start + i as f64 * end) / last).collect())
    }
}

/// Settings of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct CampbellSettings {
    /// Direction of the spin, any length but zero: of a body alone in the axes of the mesh; of bodies in joints global, through the center of
    /// mass. A body alone needs one.
    pub axis: Option<[f64; 3]>,
    /// A joint about whose axis bodies in joints spin. Without axis and joint it is the joint that a drive turns.
    pub joint: Option<String>,
    /// The spin speeds.
    pub speeds: Speeds,
    /// Engine orders: numbers of times a turn that loads come by.
    pub orders: Vec<f64>,
    /// About what the vibrations of a body alone are.
    pub about_rest: AboutRest,
}

/// The speeds, where they and the orders are in range.
fn checked(speeds: Speeds, orders: &[f64]) -> Result<Vec<f64>, Failure> {
    if let Some(&order) = orders.iter().find(|order| !(**order > 0.0 && order.is_finite())) {
        let wrong = Kind::Usage.alone().key("orders").found(order.to_string());
        return Err(wrong.expected("positive numbers of times a turn").help("give some, such as 1, 2 or 0.5").into());
    }
    speeds.values()
}

/// A unit vector along an axis.
fn unit(axis: [f64; 3]) -> Result<Vector3<f64>, Failure> {
    let unit = Vector3::from(axis).try_normalize(0.0).filter(|axis| (axis.norm() - 1.0).abs() < 1e-12);
    unit.ok_or_else(|| {
        let expected = "three finite numbers that are not all zero, in the axes of the mesh";
        Kind::Usage.alone().key("axis").found(format!("{axis:?}")).expected(expected).into()
    })
}

/// A body whose spin is held, about its undeformed shape.
struct Undeformed<'a> {
    spin: &'a SteadySpin,
    body: &'a Body,
}

impl Family for Undeformed<'_> {
    fn vibrations(&self, speed: f64) -> Result<Vec<SpinMode>, Failure> {
        self.spin.modes(speed).map_err(|source| source.in_file(&self.body.path))
    }

    fn resonances(&self, order: f64) -> Result<Option<Vec<f64>>, Failure> {
        self.spin.critical_speeds(order).map(Some).map_err(|source| source.in_file(&self.body.path))
    }
}

/// Computes the diagram of a scene of one body, or of the first bodies in joints of a scene.
///
/// Effects are those of the scene's `[effects]`, where `"auto"` is on. All modes are kept (`flexible = "auto"`: the
/// most there may be).
///
/// # Errors
/// [`Failure`].
pub fn campbell(
    scene: &Scene,
    builder: &Builder,
    settings: &CampbellSettings,
    progress: impl FnMut(CampbellProgress),
) -> Result<Report, Failure> {
    match scene.has_connections() {
        true => system::campbell_of_system(scene, builder, settings, progress),
        false => campbell_of_body(scene, builder, settings, progress),
    }
}

fn campbell_of_body(
    scene: &Scene,
    builder: &Builder,
    settings: &CampbellSettings,
    mut progress: impl FnMut(CampbellProgress),
) -> Result<Report, Failure> {
    let axis = settings.axis.ok_or_else(|| {
        let wrong = Kind::Usage.alone().key("--axis").found("none");
        let wrong = wrong.expected("the axis of the spin, in the axes of the mesh");
        Failure::from(wrong.help("give x, y, z, or three numbers such as 0,0.6,0.8"))
    })?;
    let (axis, body) = (unit(axis)?, scene.only_body()?);
    let speeds = checked(settings.speeds, &settings.orders)?;
    // The rest at each speed is found here.
    let builder = builder.needing(Needs::spin());
    let model = builder.build(body, |p| progress(CampbellProgress::Build(p)))?;
    require_flexible(body, &model).map_err(BuildError::from)?;

    let effects = &model.physics.effects;
    let effects = SpinEffects {
        coriolis: effects[Effect::Coriolis],
        softening: effects[Effect::DeformedInertia],
        stiffening: effects[Effect::GeometricStiffening],
    };
    if settings.about_rest == AboutRest::Always && !effects.all() {
        let found =
            "an effect of the spin that is off, `coriolis`, `deformed_inertia` or `geometric_stiffening` in [effects]";
        let expected = "all of them with `--about-rest always`, since the full body has them";
        let wrong = Kind::Usage.of(&body.path).found(found).expected(expected);
        return Err(wrong.help("leave them on, or give `--about-rest never`").into());
    }
    let spin = SteadySpin::new(&model.body, &axis, &model.physics.effects);
    let total = speeds.len();
    let done = |done| progress(CampbellProgress::Speeds { done, total });
    let highest = settings.speeds.end;
    let deflection = || bent::deflection(&model, &axis, highest);
    let may_be_bent = match settings.about_rest {
        AboutRest::Never => false,
        AboutRest::Always => true,
        AboutRest::Auto => effects.all() && body.source.bends_far() && deflection().is_some(),
    };
    let no_rest = body.source.not_by_elements().map(|found| match deflection() {
        None => format!("not found of {found}"),
        Some(part) => format!("not found of {found}, which the highest speed bends by about {part:.1e} of its length"),
    });
    let full = may_be_bent.then(|| bent::full(body, &builder)).transpose()?;
    let bent = full.as_ref().map(|full| BentSpin::new(body, full, &model, &axis)).transpose()?;
    let bent = match bent {
        Some(bent) if settings.about_rest == AboutRest::Always || bent.differs(&spin, highest)? => Some(bent),
        _ => None,
    };
    let (family, static_shapes): (&dyn Family, _) = match &bent {
        None => (&Undeformed { spin: &spin, body }, model.static_shapes()),
        Some(bent) => (bent, 0),
    };
    let diagram = diagram::diagram(family, static_shapes, speeds, &settings.orders, done)?;
    let diagram = Diagram {
        mesh: MeshReport::new(&model),
        axis: axis.into(),
        origin: model.body.origin.into(),
        effects: Some(effects),
        no_rest,
        deflection: bent.iter().flat_map(|bent| diagram.speeds.iter().map(|speed| bent.deflection(*speed))).collect(),
        ..diagram
    };
    Ok(diagram.report(&body.title, [&body.units.length, &body.units.time], &settings.orders))
}
