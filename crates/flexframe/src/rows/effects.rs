//! Which effects a run has.

use advice::Subject;
use dynamics::{DrivenMotion, Effect};
use model::Model;
use results::EffectProperties;
use scene::{Body, Load};

use crate::report::quantity;

/// The effects and static shapes that can be on or off in a run of the conservative form, and whether they are; none for
/// the paper's formulation, which has its own.
pub(crate) fn computed(body: &Body, model: &Model) -> Vec<(&'static str, bool)> {
    if !body.method().abilities.switches_effects {
        return Vec::new();
    }
    let subjects = model.advice.rows().map(|(subject, _)| subject);
    subjects.filter_map(|subject| Some((subject.name(), is_on(body, model, subject)?))).collect()
}

/// All effects of the conservative form in words, as a page about the run shows them; none for the paper's formulation.
pub(crate) fn described(body: &Body, model: &Model) -> Vec<EffectProperties> {
    if !body.method().abilities.switches_effects {
        return Vec::new();
    }
    let effect = |(subject, row): (Subject, &advice::Row)| EffectProperties {
        name: subject.name().replace('_', " "),
        state: match is_on(body, model, subject) {
            Some(true) => "on",
            Some(false) => "off",
            None => "–",
        }
        .to_owned(),
        measure: format!("{} = {}", subject.formula(), quantity(row.value)),
        reason: row.why.clone(),
    };
    model.advice.rows().map(effect).collect()
}

/// True if a scene can switch the subject of a row.
pub(crate) fn is_switch(subject: Subject) -> bool {
    matches!(subject, Subject::Effect(_) | Subject::StaticCorrection)
}

/// True if a model has the subject of a row; `None` where that cannot be switched, or the scene has nothing that it could
/// act on.
pub(crate) fn is_on(body: &Body, model: &Model, subject: Subject) -> Option<bool> {
    let flexible = model.body.flexible();
    match subject {
        Subject::Effect(effect) => {
            let by_stress = effect == Effect::GeometricStiffening && model.is_stressed();
            let on = model.physics.effects[effect] || by_stress;
            let can_act = match effect {
                Effect::Flexibility => true,
                Effect::Damping => {
                    let damped = |k: usize| body.modes.damping.ratio(k, model.body.circular_frequencies[k]) > 0.0;
                    (0..flexible).any(damped)
                }
                Effect::Gravity => body.loads.iter().any(Load::is_gravity),
                Effect::DeformedInertia | Effect::Coriolis | Effect::GeometricStiffening | Effect::LargeDeflection => {
                    flexible > 0
                }
                // What is driven cannot be switched.
                Effect::Translation => !drives(model, |m| matches!(m, DrivenMotion::Slide { .. })),
                Effect::Rotation => !drives(model, |m| matches!(m, DrivenMotion::Turn { .. })),
            };
            can_act.then_some(on)
        }
        Subject::StaticCorrection => (flexible > 0).then(|| model.static_shapes() > 0),
        Subject::Deflection | Subject::Step => None,
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
