//! The effects that a motion can have or leave out.

use keys::{Key, Keyed};

use std::ops::{Index, IndexMut};

/// Declares [`Effect`]: a line for each, with its name in a scene and what it is.
macro_rules! effects {
    ($($effect:ident $name:literal $description:literal,)*) => {
        /// Something that a motion can have or leave out.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Effect {
            $(#[doc = $description] $effect,)*
        }

        impl Effect {
            /// All of them.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$effect),*];

            /// A sentence that says what it is.
            pub const fn description(self) -> &'static str {
                match self {
                    $(Self::$effect => $description,)*
                }
            }

            /// Its name, as in a scene.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$effect => $name,)*
                }
            }
        }
    };
}

effects! {
    Flexibility "flexibility" "The body deforms.",
    Damping "damping" "The modes are damped.",
    Gravity "gravity" "Gravity acts.",
    DeformedInertia "deformed_inertia" "The inertia follows the deformation: c_ij and N_ij.",
    Coriolis "coriolis" "Coriolis forces couple the modes of a turning body: G_i.",
    GeometricStiffening "geometric_stiffening" "The stress of the spin stiffens the body: K_ij of [`reduced_body::Constants::stress_stiffness`], where it has any.",
    LargeDeflection "large_deflection" "Modes that bend the body far move on a curved manifold: [`Manifold`](crate::Manifold).",
    Translation "translation" "The body as a whole moves; a slide that is driven does so in any case.",
    Rotation "rotation" "The body as a whole turns; a turn that is driven does so in any case.",
}

/// A value for each effect, such as whether it is computed.
///
/// ```
/// use dynamics::{Effect, EffectMap};
///
/// let effects = EffectMap::all().without(Effect::Coriolis);
/// assert!(effects[Effect::DeformedInertia] && !effects[Effect::Coriolis]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct EffectMap<T>([T; Effect::ALL.len()]);

impl<T> EffectMap<T> {
    /// The value of each effect by a function.
    pub fn from_fn(value: impl FnMut(Effect) -> T) -> Self {
        Self(Effect::ALL.map(value))
    }
}

impl EffectMap<bool> {
    /// All effects are on.
    pub const fn all() -> Self {
        Self([true; Effect::ALL.len()])
    }

    /// The same with one effect off.
    pub const fn without(mut self, effect: Effect) -> Self {
        self.0[effect as usize] = false;
        self
    }
}

impl<T> Index<Effect> for EffectMap<T> {
    type Output = T;

    fn index(&self, effect: Effect) -> &T {
        &self.0[effect as usize]
    }
}

impl<T> IndexMut<Effect> for EffectMap<T> {
    fn index_mut(&mut self, effect: Effect) -> &mut T {
        &mut self.0[effect as usize]
    }
}

/// The names of those that are on.
impl Keyed for EffectMap<bool> {
    fn key(&self, key: Key) -> Key {
        let on = || Effect::ALL.into_iter().filter(|effect| self[*effect]);
        on().fold(key.of("effects", 1).with("count", &on().count()), |key, effect| effect.name().key(key))
    }
}
