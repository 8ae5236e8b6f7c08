//! The parts of a body that a command wants computed, beside its scene.

use std::ops::Deref;

use dynamics::{Effect, EffectMap, Method};
use scene::{Body, BodySource, Choice, Effects, Flexible, Large, Load, Modes};

/// Effects of bodies with modes and without; all others need modes.
const OF_ANY_BODY: [Effect; 3] = [Effect::Translation, Effect::Rotation, Effect::Gravity];
/// Effects that unknown forces may call for.
const UNDER_UNKNOWN_FORCES: [Effect; 6] = [
    Effect::Translation,
    Effect::Rotation,
    Effect::Gravity,
    Effect::Damping,
    Effect::DeformedInertia,
    Effect::Coriolis,
];

/// The parts of a body that a command wants computed. By default they are those of a run of its scene. No command changes a scene: where it
/// wants others, it says so here.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// True if the rows of a run are written: stress, and the reactions of each of several supports, are only in them.
    pub rows: bool,
    /// True if the stress of all nodes is wanted, in each coordinate, of a body with elements.
    pub stress_field: bool,
    /// True if forces act from elsewhere that nobody knows while the body is built. Effects that would be left out since the scene calls for
    /// none of them are on, as long as the scene does not say otherwise: translation, rotation, gravity, and of a body with modes damping,
    /// deformed inertia and Coriolis. The reactions of each of several supports are left out, since they would have to know these forces. So
    /// is the peak of the stress.
    pub external_inputs: bool,
    /// True if the loads of the scene act.
    pub loads: bool,
    /// True if the modes are about the bent body that the scene names.
    pub about: bool,
    /// True if the change of frequency with amplitude of modes that bend the body far is to be known, which takes static responses.
    pub backbones: bool,
    /// The method of the motion, in the place of the scene's.
    pub method: Option<Method>,
    /// The number of modes, in the place of the scene's.
    pub flexible: Option<ModeCount>,
    /// The modes that may bend the body far, numbered from 1, in the place of the scene's.
    pub large: Option<Vec<usize>>,
    /// The most modes that follow them, in the place of the scene's number.
    pub following: Option<usize>,
    /// True or false in the place of the scene's choice.
    pub static_correction: Option<bool>,
    /// Effects that are on or off whatever the scene says.
    pub effects: EffectMap<Option<bool>>,
    /// Effects that are on where the scene leaves them open.
    pub open_effects: &'static [Effect],
}

/// A number of flexible modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModeCount {
    /// The most that the scene may have.
    All,
    /// This number.
    Count(usize),
}

impl Default for Needs {
    fn default() -> Self {
        Self {
            rows: true,
            stress_field: false,
            external_inputs: false,
            loads: true,
            about: true,
            backbones: true,
            method: None,
            flexible: None,
            large: None,
            following: None,
            static_correction: None,
            effects: EffectMap::from_fn(|_| None),
            open_effects: &[],
        }
    }
}

impl Needs {
    /// A run whose rows nobody writes.
    pub fn without_rows() -> Self {
        Self { rows: false, ..Self::default() }
    }

    /// A run with forces from elsewhere that nobody knows while the body is built.
    pub fn external_inputs() -> Self {
        Self { external_inputs: true, ..Self::default() }
    }

    /// The method of the motion of a body.
    pub fn method_of(&self, body: &Body) -> Method {
        self.method.unwrap_or(*body.method())
    }

    /// Small vibrations that no load of the scene sets off: damping is on where the scene leaves it open.
    pub fn vibrations() -> Self {
        Self { open_effects: &[Effect::Damping], ..Self::default() }
    }

    /// The modes as they are, whatever the motion of the scene would call for.
    pub fn modes() -> Self {
        // Where modes are large, the static answer to a moment takes the place of one.
        let effects = EffectMap::from_fn(|effect| match effect {
            Effect::Damping => Some(true),
            Effect::GeometricStiffening | Effect::LargeDeflection => Some(false),
            _ => None,
        });
        let flexible = Some(ModeCount::All);
        Self { backbones: false, flexible, static_correction: Some(false), effects, ..Self::without_rows() }
    }

    /// All modes without loads, in a spin that is given, whatever the motion of the scene would call for: its effects are on unless the scene
    /// says otherwise, and the modes are about the undeformed body.
    pub fn spin() -> Self {
        Self {
            loads: false,
            about: false,
            flexible: Some(ModeCount::All),
            open_effects: &[Effect::DeformedInertia, Effect::Coriolis, Effect::GeometricStiffening],
            ..Self::without_rows()
        }
    }
}

/// The body of a scene with the needs of a command: the same names tell what is wanted where that may be other than the scene says.
#[derive(Debug, Clone)]
pub(crate) struct Needed<'a> {
    scene: &'a Body,
    method: Method,
    pub modes: Modes,
    pub effects: Effects,
    pub loads: &'a [Load],
    /// True if the stress at the points of the output is wanted, its peak, and the stress of all nodes.
    pub stress: bool,
    pub peak_stress: bool,
    pub stress_field: bool,
    /// True if each of several supports gets reactions of its own.
    pub support_reactions: bool,
    pub backbones: bool,
}

impl Deref for Needed<'_> {
    type Target = Body;

    fn deref(&self) -> &Body {
        self.scene
    }
}

impl<'a> Needed<'a> {
    pub fn new(body: &'a Body, needs: &Needs) -> Self {
        let mut modes = body.modes.clone();
        modes.flexible = match needs.flexible {
            Some(ModeCount::All) => Flexible::Count(modes.flexible.most()),
            Some(ModeCount::Count(count)) => Flexible::Count(count),
            None => modes.flexible,
        };
        modes.about = modes.about.filter(|_| needs.about);
        modes.large = needs.large.clone().map(Large::List).or(modes.large);
        modes.following = needs.following.unwrap_or(modes.following);
        modes.static_correction = needs.static_correction.map_or(modes.static_correction, choice);
        let mut effects = body.effects;
        for effect in Effect::ALL {
            effects.choices[effect] = needs.effects[effect].map_or(effects.choices[effect], choice);
        }
        let mut needed = Self {
            scene: body,
            method: needs.method_of(body),
            modes,
            effects,
            loads: if needs.loads { &body.loads } else { &[] },
            stress: needs.rows && body.output.stress,
            peak_stress: needs.rows && !needs.external_inputs && body.output.peak_stress,
            stress_field: needs.stress_field && body.source.has_elements(),
            support_reactions: needs.rows && !needs.external_inputs,
            backbones: needs.backbones,
        };
        if needs.external_inputs {
            needed.turn_on(&UNDER_UNKNOWN_FORCES);
        }
        needed.turn_on(needs.open_effects);
        needed
    }

    pub fn method(&self) -> &Method {
        &self.method
    }

    /// True if anything of the stress is wanted.
    pub fn any_stress(&self) -> bool {
        self.stress || self.peak_stress || self.stress_field
    }

    /// Turns effects on that are left open.
    pub fn turn_on(&mut self, effects: &[Effect]) {
        for effect in self.left_open(effects) {
            self.effects.choices[effect] = Choice::On;
        }
    }

    /// The effects that are on under forces that nobody knows, and are left open.
    pub fn on_under_unknown_forces(&self) -> Vec<Effect> {
        self.left_open(&UNDER_UNKNOWN_FORCES)
    }

    /// The effects that the body can have and the scene neither switches on nor off.
    fn left_open(&self, effects: &[Effect]) -> Vec<Effect> {
        let has_modes = !matches!(self.source, BodySource::Rigid(_))
            && self.modes.flexible.most() > 0
            && self.effects.choices[Effect::Flexibility] != Choice::Off;
        let can_be = |effect: Effect| has_modes || OF_ANY_BODY.contains(&effect);
        let is_open = |effect: &Effect| can_be(*effect) && self.effects.choices[*effect] == Choice::Auto;
        effects.iter().copied().filter(is_open).collect()
    }
}

fn choice(on: bool) -> Choice {
    if on { Choice::On } else { Choice::Off }
}
