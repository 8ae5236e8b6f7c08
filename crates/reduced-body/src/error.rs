//! Errors of reduced bodies.

/// Constants, or a rigid motion, that no body can have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum BodyError {
    /// A number that is NaN or infinite.
    #[error("{what}: {value} in entry {index} (counted from 0); every number must be finite")]
    NotFinite { what: &'static str, index: usize, value: f64 },
    /// Lists or matrices whose sizes do not fit together.
    #[error("the size of {what} is {found}; expected {expected}")]
    Length { what: &'static str, found: usize, expected: usize },
    /// A number that has to be positive.
    #[error("{what} is {value}; expected a positive number")]
    NotPositive { what: &'static str, value: f64 },
    /// An inertia that is not its own transpose.
    #[error(
        "the inertia is not symmetric: entry ({row}, {column}) is {value:.3e}, its mirror image {mirrored:.3e}; store both triangles"
    )]
    NotSymmetric { row: usize, column: usize, value: f64, mirrored: f64 },
    /// The body has no mass, or none to resist a rotation. `inertia`: its diagonal about the origin.
    #[error(
        "the body has mass {mass:.3e} and moments of inertia {inertia:?} about its origin, which no rigid body can have: the mass and all three moments must be positive (of a hinge, that about its axis), and large enough to divide by: are they in the units of the mesh?"
    )]
    NoInertia { mass: f64, inertia: [f64; 3] },
    /// A direction that is not a unit vector.
    #[error("the direction {direction:?} of the support is not a unit vector; divide it by its length")]
    NotUnit { direction: [f64; 3] },
}

/// Refuses numbers that are not finite.
pub(crate) fn check_finite(what: &'static str, values: impl IntoIterator<Item = f64>) -> Result<(), BodyError> {
    match values.into_iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((index, value)) => Err(BodyError::NotFinite { what, index, value }),
        None => Ok(()),
    }
}

/// Refuses a list of another length.
pub(crate) fn check_size(what: &'static str, found: usize, expected: usize) -> Result<(), BodyError> {
    if found == expected { Ok(()) } else { Err(BodyError::Length { what, found, expected }) }
}
