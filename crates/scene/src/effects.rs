//! Which effects are simulated.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// Whether something is done: `true`, `false` or `"auto"`.
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
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Effects {
    /// The body deforms.
    pub flexibility: Choice,
    /// Its modes are damped.
    pub damping: Choice,
    /// The loads `kind = "gravity"` act.
    pub gravity: Choice,
    /// The inertia follows the deformation.
    pub deformed_inertia: Choice,
    /// Coriolis forces couple the modes of a turning body.
    pub coriolis: Choice,
    /// The stresses of the centrifugal field, and of steady loads and accelerations, stiffen or soften the body.
    pub geometric_stiffening: Choice,
    /// The body as a whole moves from its place.
    pub translation: Choice,
    /// The body as a whole turns.
    pub rotation: Choice,
    /// Relative influence on the answer, between 0 and 1, below which `"auto"` leaves an effect out; default 1e-3.
    pub tolerance: f64,
    /// Whether a model that is known to be wrong is refused, which is the default.
    pub refuse: bool,
}

impl Default for Effects {
    fn default() -> Self {
        let auto = Choice::Auto;
        Self {
            flexibility: auto,
            damping: auto,
            gravity: auto,
            deformed_inertia: auto,
            coriolis: auto,
            geometric_stiffening: auto,
            translation: auto,
            rotation: auto,
            tolerance: 1e-3,
            refuse: true,
        }
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
        _ if crate::suggest::nearest(text, NAMES).is_some() => Err(E::unknown_variant(text, NAMES)),
        _ => Err(E::invalid_type(Unexpected::Str(text), visitor)),
    }
}
