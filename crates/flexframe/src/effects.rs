//! Which effects a run has.

use advice::Effect;
use frames_rk4::DrivenMotion;
use scene::{Load, Model, Scene};

/// The effects that can be on or off in a run of the conservative form, and whether they are; none for the paper's
/// formulation, which has its own.
pub(crate) fn computed(scene: &Scene, model: &Model) -> Vec<(&'static str, bool)> {
    if scene.time.method.is_of_paper() {
        return Vec::new();
    }
    let scene_has = |effect| is_on(scene, model, effect).map(|on| (effect.name(), on));
    TOGGLED.into_iter().filter_map(scene_has).collect()
}

/// The effects that a scene can switch.
pub(crate) const TOGGLED: [Effect; 9] = [
    Effect::Flexibility,
    Effect::Damping,
    Effect::Gravity,
    Effect::DeformedInertia,
    Effect::Coriolis,
    Effect::GeometricStiffening,
    Effect::Translation,
    Effect::Rotation,
    Effect::StaticCorrection,
];

/// Whether an effect is in a model; `None` where the scene has nothing that it could act on.
pub(crate) fn is_on(scene: &Scene, model: &Model, effect: Effect) -> Option<bool> {
    let effects = &model.physics.effects;
    let flexible = model.body.flexible() > 0;
    let of_modes = |on: bool| flexible.then_some(on);
    match effect {
        Effect::Flexibility => Some(flexible),
        Effect::Damping => {
            let damped = |k: usize| scene.modes.damping.ratio(k, model.body.circular_frequencies[k]) > 0.0;
            (0..model.body.flexible()).any(damped).then(|| model.damping_ratios().iter().any(|zeta| *zeta > 0.0))
        }
        Effect::Gravity => {
            let falls = |load: &&Load| matches!(load, Load::Gravity(_));
            let others = scene.loads.len() - scene.loads.iter().filter(falls).count();
            (scene.loads.len() > others).then(|| model.loads().len() > others)
        }
        Effect::DeformedInertia => of_modes(effects.deformed_inertia),
        Effect::Coriolis => of_modes(effects.coriolis),
        Effect::GeometricStiffening => of_modes(effects.geometric_stiffening || model.is_stressed()),
        // What is driven cannot be switched.
        Effect::Translation => {
            (!drives(model, |m| matches!(m, DrivenMotion::Slide { .. }))).then_some(effects.translation)
        }
        Effect::Rotation => (!drives(model, |m| matches!(m, DrivenMotion::Turn { .. }))).then_some(effects.rotation),
        Effect::StaticCorrection => of_modes(model.static_shapes() > 0),
        Effect::Deflection | Effect::Foreshortening | Effect::Step => None,
    }
}

fn drives(model: &Model, is: impl Fn(&DrivenMotion) -> bool) -> bool {
    model.physics.drive.as_ref().is_some_and(|drive| is(&drive.motion))
}

/// "flexibility, damping; without coriolis".
pub(crate) fn in_words(effects: &[(&'static str, bool)]) -> String {
    let names = |on: bool| effects.iter().filter(|(_, is)| *is == on).map(|(name, _)| *name).collect::<Vec<_>>();
    let (with, without) = (names(true), names(false));
    match (with.is_empty(), without.is_empty()) {
        (_, true) => with.join(", "),
        (true, false) => format!("none of {}", without.join(", ")),
        (false, false) => format!("{}; without {}", with.join(", "), without.join(", ")),
    }
}
