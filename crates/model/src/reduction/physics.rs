//! Which effects a scene gets.

use advice::Advice;
use dynamics::{Drive, Effect, EffectMap, Method};
use reduced_body::{ReducedBody, RigidMotion};
use scene::{Choice, Large, Load, LoadKind};

use crate::load::mesh_load::MeshLoad;
use crate::load::turning::{Turning, turning};
use crate::needs::Needed;
use crate::reduction::bent::Bent;

/// The needs of a body about a bent reference: where the scene leaves that open, the stress that changes stiffens it, and modes are
/// large.
pub(crate) fn about_reference<'a>(scene: &Needed<'a>) -> Needed<'a> {
    let mut scene = scene.clone();
    scene.turn_on(&[Effect::GeometricStiffening, Effect::DeformedInertia, Effect::Coriolis, Effect::LargeDeflection]);
    scene
}

/// True if anything may set the body spinning.
pub(crate) fn may_spin(scene: &Needed<'_>, motion: RigidMotion, drive: Option<&Drive>) -> bool {
    let by_others = !scene.loads.is_empty() || !scene.markers.is_empty();
    let set_off = drive.is_some() || scene.initial.angular_velocity != [0.0; 3] || by_others;
    turns(scene, motion, drive) && set_off
}

/// True if the stress of loads and drives may stiffen the body.
pub(crate) fn may_stress(scene: &Needed<'_>) -> bool {
    scene.source.has_elements()
        && scene.effects.choices[Effect::GeometricStiffening] != Choice::Off
        && scene.method().abilities.geometric_stiffening
}

/// True if a load stays as it is, seen from the body.
pub(crate) fn is_steady(scene: &Needed<'_>, motion: RigidMotion, drive: Option<&Drive>, load: &MeshLoad) -> bool {
    matches!(load.history, dynamics::History::Constant) && (load.follows || !turns(scene, motion, drive))
}

/// True if the body may turn.
pub(crate) fn turns(scene: &Needed<'_>, motion: RigidMotion, drive: Option<&Drive>) -> bool {
    turning(scene, motion, drive) != Turning::Not
}

/// The choice to add static shapes to the `flexible` modes that there are.
pub(crate) fn static_correction(scene: &Needed<'_>, flexible: usize) -> Choice {
    match scene.modes.static_correction {
        _ if flexible == 0 => Choice::Off,
        // The shapes are stiff, which only this scheme does not mind.
        Choice::Auto if *scene.method().without_joints() != Method::EXPONENTIAL => Choice::Off,
        choice => choice,
    }
}

/// The effects of the motion of a body of which `keep` modes are kept: what the scene leaves open is as advised.
pub(crate) fn effects(scene: &Needed<'_>, advice: &Advice, body: &ReducedBody, keep: usize) -> EffectMap<bool> {
    // The paper's formulation has the effects that it has; gravity is a load like others.
    let in_any_case = |effect: Effect| !scene.method().abilities.switches_effects && effect != Effect::Gravity;
    let has_weight = !body.motion.is_free() && bears_weight(scene, body.mass);
    let mut effects = EffectMap::from_fn(|effect| match scene.effects.choices[effect] {
        Choice::On => true,
        Choice::Off => false,
        Choice::Auto => in_any_case(effect) || advice.effects[effect].on || (effect == Effect::Gravity && has_weight),
    });
    effects[Effect::Flexibility] = keep > 0;
    effects[Effect::GeometricStiffening] &=
        keep > 0 && body.stress_stiffness.is_some() && effects[Effect::DeformedInertia];
    effects
}

/// Sentence about what forces of joints may call for.
const IN_JOINTS: &str = "The body has markers: what joints will put on it is not known while it is built.";

/// The advice on a body with markers, on which joints put forces that nobody knows while it is built: what such forces may call
/// for is on, and all modes are kept. That on another body is as it was.
pub(crate) fn in_joints(scene: &Needed<'_>, mut advice: Advice) -> Advice {
    if scene.markers.is_empty() {
        return advice;
    }
    let is_missing = |effect: &Effect| *effect == Effect::Gravity && !scene.loads.iter().any(Load::is_gravity);
    let has_modes = !advice.modes.is_empty();
    let flexibility = Some(Effect::Flexibility).filter(|_| has_modes);
    let stiffening = Some(Effect::GeometricStiffening).filter(|_| has_modes && scene.source.has_elements());
    let called_for = scene.on_under_unknown_forces().into_iter().filter(|effect| !is_missing(effect));
    for effect in called_for.chain(flexibility).chain(stiffening) {
        let row = &mut advice.effects[effect];
        if !row.on {
            (row.on, row.why) = (true, IN_JOINTS.to_owned());
        }
    }
    advice.keep = advice.modes.len();
    advice.modes.iter_mut().for_each(|mode| mode.worth_keeping = true);
    advice
}

/// True if the constraint bears the weight of the body, however little that moves it: it is no less than `tolerance` of each
/// force.
fn bears_weight(scene: &Needed<'_>, mass: f64) -> bool {
    let largest = |kind| {
        let of_kind = scene.loads.iter().filter(|load| load.kind == kind);
        of_kind.map(|load| load.amplitude.abs()).reduce(f64::max)
    };
    let force = largest(LoadKind::Force);
    largest(LoadKind::Gravity).is_some_and(|gravity| mass * gravity >= scene.effects.tolerance * force.unwrap_or(0.0))
}

/// How many modes are large where the scene asks for large deflection and does not say of which.
const DEFAULT_LARGE: usize = 1;
/// The multiple of the lowest frequency up to which modes follow the large ones.
const FOLLOWING: f64 = 25.0;

/// Which of the modes that are kept bend the body far: those that the scene names, or what is advised. The paper's formulation
/// has none, and nothing is advised for a body that is not to stiffen: the manifold stiffens its modes.
pub(crate) fn bent_modes(scene: &Needed<'_>, advice: &Advice, keep: usize, natural: usize) -> Bent {
    let first = |count: usize| (0..keep.min(count)).collect();
    let large: Vec<usize> = match (scene.effects.choices[Effect::LargeDeflection], &scene.modes.large) {
        (Choice::Off, _) => Vec::new(),
        _ if !scene.source.bends_far() => Vec::new(),
        (Choice::Auto, _) if !scene.method().abilities.large_deflection => Vec::new(),
        (_, Some(Large::Count(count))) => first(*count),
        (_, Some(Large::List(list))) => list.iter().map(|mode| mode - 1).filter(|k| *k < keep).collect(),
        (Choice::On, None) => match advice.furthest_modes(keep) {
            none if none.is_empty() => first(DEFAULT_LARGE),
            furthest => furthest,
        },
        (Choice::Auto, None) if scene.effects.choices[Effect::GeometricStiffening] == Choice::Off => Vec::new(),
        (Choice::Auto, None) if !scene.markers.is_empty() => Vec::new(),
        (Choice::Auto, None) => advice.large_modes(keep),
    };
    if large.is_empty() {
        return Bent::default();
    }
    let count = advice.modes.len().min(keep).min(natural);
    let squares: Vec<f64> = advice.modes[..count].iter().map(|mode| mode.circular_frequency.powi(2)).collect();
    Bent { following: following(scene, &squares, &large), large }
}

/// Which coordinates follow the large ones, by the squares of their circular frequencies.
pub(crate) fn following(scene: &Needed<'_>, squares: &[f64], large: &[usize]) -> Vec<usize> {
    let lowest = squares.iter().copied().fold(f64::INFINITY, f64::min);
    let follows = |k: &usize| !large.contains(k) && squares[*k] <= FOLLOWING * FOLLOWING * lowest;
    (0..squares.len()).filter(follows).take(scene.modes.following).collect()
}

/// The effects with what large modes need: what follows them moves along the body, where turning acts on it.
pub(crate) fn with_large_modes(scene: &Needed<'_>, mut effects: EffectMap<bool>, bent: &Bent) -> EffectMap<bool> {
    for effect in [Effect::Coriolis, Effect::DeformedInertia] {
        effects[effect] |= !bent.large.is_empty() && scene.effects.choices[effect] == Choice::Auto;
    }
    effects
}
