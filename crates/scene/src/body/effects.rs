//! Which effects are simulated.

use std::fmt;

use dynamics::{Effect, EffectMap};
use serde::de::{Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// A choice: `true`, `false` or `"auto"`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// `true`.
    On,
    /// `false`.
    Off,
    /// `"auto"`: where the scene calls for it. The default.
    #[default]
    Auto,
}

/// The effects: `[effects]`. Every key is optional; what is off is not computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects {
    /// Which are simulated: a key for each, by its name.
    pub choices: EffectMap<Choice>,
    /// Relative influence on the answer, between 0 and 1, below which `"auto"` leaves an effect out; default 1e-3.
    pub tolerance: f64,
    /// True if a model that is known to be wrong is refused, which is the default.
    pub refuse: bool,
}

impl Effects {
    /// The keys: the names of the effects, and the others.
    const KEYS: [&str; Effect::ALL.len() + 2] = {
        let mut keys = ["tolerance"; Effect::ALL.len() + 2];
        let mut i = 0;
        while i < Effect::ALL.len() {
            keys[i] = Effect::ALL[i].name();
            i += 1;
        }
        keys[i + 1] = "refuse";
        keys
    };
}

impl Default for Effects {
    fn default() -> Self {
        Self { choices: EffectMap::from_fn(|_| Choice::Auto), tolerance: 1e-3, refuse: true }
    }
}

impl<'de> Deserialize<'de> for Effects {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EffectsVisitor;
        impl<'de> Visitor<'de> for EffectsVisitor {
            type Value = Effects;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of effects")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Effects, A::Error> {
                let mut effects = Effects::default();
                while let Some(key) = map.next_key::<String>()? {
                    match (Effect::ALL.into_iter().find(|effect| effect.name() == key), key.as_str()) {
                        (Some(effect), _) => effects.choices[effect] = map.next_value()?,
                        (None, "tolerance") => effects.tolerance = map.next_value()?,
                        (None, "refuse") => effects.refuse = map.next_value()?,
                        (None, _) => return Err(A::Error::unknown_field(&key, &Effects::KEYS)),
                    }
                }
                Ok(effects)
            }
        }
        deserializer.deserialize_struct("Effects", &Self::KEYS, EffectsVisitor)
    }
}

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ChoiceVisitor;
        impl Visitor<'_> for ChoiceVisitor {
            type Value = Choice;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false or \"auto\"")
            }

            fn visit_bool<E: Error>(self, on: bool) -> Result<Choice, E> {
                Ok(if on { Choice::On } else { Choice::Off })
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Choice, E> {
                auto(text, &self).map(|()| Choice::Auto)
            }
        }
        deserializer.deserialize_any(ChoiceVisitor)
    }
}

/// Accepts the text `auto`; a misspelt one is an unknown name, another one not what the visitor expects.
pub(crate) fn auto<'v, E: Error>(text: &str, visitor: &impl Visitor<'v>) -> Result<(), E> {
    const NAMES: &[&str] = &["auto"];
    match text {
        "auto" => Ok(()),
        _ if crate::text::suggest::nearest(text, NAMES).is_some() => Err(E::unknown_variant(text, NAMES)),
        _ => Err(E::invalid_type(Unexpected::Str(text), visitor)),
    }
}
