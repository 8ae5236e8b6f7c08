//! The diagram of bodies that joints tie together: all of them spin about one axis, or a rotor on a support.

use std::f64::consts::TAU;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Effect, Rotor, RotorError, SteadyError, SystemMotion};
use model::{Builder, Needs};
use nalgebra::Vector3;
use report::Report;
use scene::Scene;

use super::diagram::diagram;
use super::report::{Diagram, SpinEffects};
use super::settings::{CampbellProgress, CampbellSettings, checked, unit};
use crate::commands::system_modes::{Rotors, TiedMotion, body_names, tied_motions};

/// Computes the diagram of the first system of a scene.
///
/// At each speed the bodies are deformed as the spin asks, and drives hold still what they turn. Loads are left out; dampers and the
/// damping of modes count. Where other joints keep the bodies from that spin, the body beyond the joint spins alone: a rotor on a support.
/// Other rotors spin as they do at the start of the scene.
///
/// # Errors
/// [`Failure`].
pub(super) fn campbell_of_system(
    scene: &Scene,
    builder: &Builder,
    settings: &CampbellSettings,
    mut progress: impl FnMut(CampbellProgress),
) -> Result<Report, Failure> {
    let speeds = checked(settings.speeds, &settings.orders)?;
    let models = builder.needing(Needs::spin()).models(scene, |p| progress(CampbellProgress::Build(p)))?;
    let motions = tied_motions(scene, &models)?;
    let Some(motion) = motions.first() else {
        let alone = Kind::Usage.of(&scene.path).found("bodies that nothing ties together");
        return Err(alone.expected("joints, springs or bushings").help("name one body: --body NAME").into());
    };
    let of_motion = motion.run.motion();
    let Axis { direction: axis, point, joint } = axis_of(motion, settings).map_err(|found| match found {
        Found::Nothing(found) => no_axis(scene, &found, of_motion.system().joints()),
        Found::NoDirection(error) => error,
    })?;
    let rotor = joint.map(|joint| rotor_of(of_motion, joint)).transpose().map_err(|source| {
        let joint = joint.map_or_else(String::new, |joint| of_motion.system().joints()[joint].name.clone());
        let known = source.diagnosis().in_file(&scene.path);
        known.says(format!("joint {joint:?}, whose other bodies are held: {source}"))
    })?;
    let rotor = rotor.flatten();
    // Rotors beside the one that is asked for spin as the scene has them; in a common spin, joints on the ground turn by it.
    let others = Rotors::of(of_motion, |other| {
        let of = &of_motion.system().joints()[other];
        let bodies = of.markers.each_ref().map(|marker| marker.body());
        let is_meant = rotor.map_or(bodies.contains(&None), |rotor| bodies.contains(&Some(rotor.body)));
        joint == Some(other) || is_meant
    });
    let find = |speed: f64| {
        let failed = |source: SteadyError| {
            source.diagnosis().in_file(&scene.path).says(format!("at {speed} rad per time: {source}"))
        };
        let modes = match &rotor {
            Some(rotor) => of_motion.rotor_modes(rotor, speed, &others.spinning),
            None => of_motion.spin_modes(&axis, point, speed, &others.spinning),
        };
        modes.map_err(failed)
    };
    let total = speeds.len();
    let is_on = |effect: Effect| {
        let mut flexible = motion.bodies.iter().map(|body| &models[*body]).filter(|model| model.body.flexible() > 0);
        flexible.all(|model| model.physics.effects[effect])
    };
    let static_shapes: usize = motion.bodies.iter().map(|body| models[*body].static_shapes()).sum();
    let done = |done| progress(CampbellProgress::Speeds { done, total });
    let diagram = diagram(&find, static_shapes, speeds, &settings.orders, done)?;
    let circular_frequencies =
        diagram.branches.iter().flat_map(|branch| &branch.frequency).map(|frequency| frequency * TAU);
    let diagram = Diagram {
        bodies: body_names(scene, &motion.bodies),
        rotor: rotor.map(|rotor| body_names(scene, &motion.bodies).swap_remove(rotor.body)),
        warnings: others.warnings(circular_frequencies),
        rotors: others.found,
        axis: axis.into(),
        origin: point.into(),
        effects: rotor.is_none().then(|| SpinEffects {
            coriolis: is_on(Effect::Coriolis),
            softening: is_on(Effect::DeformedInertia),
            stiffening: is_on(Effect::GeometricStiffening),
        }),
        ..diagram
    };
    Ok(diagram.report(&scene.title, [&scene.units.length, &scene.units.time], &settings.orders))
}

/// The refusal of a system whose axis of the spin is not known.
fn no_axis(scene: &Scene, found: &str, joints: &[dynamics::Joint]) -> Failure {
    let names: Vec<&str> = joints.iter().map(|joint| &*joint.name).collect();
    let expected = format!(
        "--axis, an axis through the center of mass, or --joint, whose axis it is: one of {}",
        names.join(", ")
    );
    Kind::Usage.of(&scene.path).found(found).expected(expected).help("name one").into()
}

/// Reason that there is no axis.
enum Found {
    Nothing(String),
    NoDirection(Failure),
}

/// The body that a joint spins alone, where something keeps the bodies from a common spin about its axis.
fn rotor_of(motion: &SystemMotion, joint: usize) -> Result<Option<Rotor>, RotorError> {
    if motion.spins_together(joint)? { Ok(None) } else { motion.rotor(joint).map(Some) }
}

/// An axis of a spin.
struct Axis {
    /// Unit vector and a point, global.
    direction: Vector3<f64>,
    point: Vector3<f64>,
    /// The joint whose axis it is.
    joint: Option<usize>,
}

/// The axis of the spin.
fn axis_of(motion: &TiedMotion, settings: &CampbellSettings) -> Result<Axis, Found> {
    let of_motion = motion.run.motion();
    let joints = of_motion.system().joints();
    let is_meant = |joint: &dynamics::Joint| match &settings.joint {
        Some(name) => joint.name == *name,
        None => joint.is_turned_by_drive(),
    };
    let meant: Vec<usize> = (0..joints.len()).filter(|number| is_meant(&joints[*number])).collect();
    match (&settings.axis, &settings.joint, &meant[..]) {
        (Some(axis), None, _) => Ok(Axis {
            direction: unit(*axis).map_err(Found::NoDirection)?,
            point: of_motion.center_of_mass(),
            joint: None,
        }),
        (_, _, [joint]) => {
            let (point, direction) = of_motion.joint_axis(*joint);
            Ok(Axis { direction, point, joint: Some(*joint) })
        }
        (_, Some(name), _) => Err(Found::Nothing(format!("there is no joint {name:?}"))),
        (_, None, []) => Err(Found::Nothing("no joint is turned by a drive".to_owned())),
        (_, None, _) => Err(Found::Nothing("several joints are turned by drives".to_owned())),
    }
}
