//! Second stage: what the scene leaves open is decided.

use dynamics::{Effect, EffectMap};
use scene::{Choice, Flexible};

use crate::needs::Needed;
use crate::reduction::bent::Bent;
use crate::reduction::physics;
use crate::reduction::survey::Survey;
use crate::structure::remainders::Remainders;

/// The parts that a body is to have.
pub(crate) struct Decision {
    /// How many of the modes are kept.
    pub keep: usize,
    /// True if static shapes are added to them.
    pub has_static_shapes: bool,
    /// The part that the modes leave out, where static shapes for it are missing.
    pub lacks: Option<Remainders>,
    pub effects: EffectMap<bool>,
    /// Which of the modes that are kept bend the body far.
    pub bent: Bent,
}

impl Decision {
    pub fn new(scene: &Needed<'_>, survey: &Survey) -> Self {
        let Survey { modal, advice, statics, .. } = survey;
        let flexible = modal.body.flexible();
        let keep = match (scene.modes.flexible, scene.effects.choices[Effect::Flexibility]) {
            (Flexible::Auto { .. }, Choice::On) => advice.keep.max(1).min(flexible),
            // Shapes go after modes: where none moves, one is there for them.
            (Flexible::Auto { .. }, Choice::Auto) if advice.static_correction.on => advice.keep.max(1).min(flexible),
            (Flexible::Auto { .. }, Choice::Auto) => advice.keep,
            _ => flexible,
        };
        let has_static_shapes = keep > 0
            && match physics::static_correction(scene, flexible) {
                Choice::On => true,
                Choice::Off => false,
                // How fast joints let it turn is not known.
                Choice::Auto => advice.static_correction.on || !scene.markers.is_empty() && statics.of_spin.is_some(),
            };
        let lacks = (keep > 0 && !has_static_shapes && statics.remainders.any()).then(|| statics.remainders.clone());
        let bent = physics::bent_modes(scene, advice, keep, modal.body.natural_modes);
        Self {
            keep,
            has_static_shapes,
            lacks,
            effects: physics::with_large_modes(scene, physics::effects(scene, advice, &modal.body, keep), &bent),
            bent,
        }
    }
}
