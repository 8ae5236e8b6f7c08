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
mod settings;
mod system;

use ::report::Report;
use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Effect, SpinMode, SteadySpin};
use model::{BuildError, Builder, Needs};
use scene::{Body, Scene};

pub use bent::AboutRest;
pub use report::FILES;
use report::{Diagram, SpinEffects};
pub use settings::{CampbellProgress, CampbellSettings, Speeds};
use settings::{checked, unit};

use crate::commands::modes::require_flexible;
use crate::report::MeshReport;
use bent::BentSpin;
use family::Family;

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
