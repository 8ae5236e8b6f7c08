//! Ways to move the bodies of a scene: a method of bodies alone, or a scheme of tied ones.

use dynamics::{Method, SystemScheme};

/// A way to move the bodies of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// Each body alone, by this method.
    Alone(Method),
    /// Tied bodies by this scheme, and bodies that nothing ties by the default method.
    Tied(SystemScheme),
}

impl Way {
    /// The method of bodies alone.
    pub fn method(self) -> Method {
        match self {
            Self::Alone(method) => method,
            Self::Tied(_) => Method::EXPONENTIAL,
        }
    }

    /// Formulation, as in the scene.
    pub fn formulation(self) -> &'static str {
        self.method().formulation
    }

    /// Scheme, as in the scene.
    pub fn scheme(self) -> &'static str {
        match self {
            Self::Alone(method) => method.scheme,
            Self::Tied(scheme) => scheme.name(),
        }
    }

    /// Order of the scheme.
    pub fn order(self) -> u32 {
        match self {
            Self::Alone(method) => method.order,
            Self::Tied(scheme) => scheme.order(),
        }
    }

    /// True if its steps can go by a tolerance.
    pub fn estimates_error(self) -> bool {
        self.method().estimates_error
    }

    /// True if the frequencies of the modes limit its steps.
    pub fn is_limited_by_modes(self) -> bool {
        match self {
            Self::Alone(method) => method.is_limited_by_modes(),
            Self::Tied(scheme) => scheme.is_limited_by_modes(),
        }
    }
}
