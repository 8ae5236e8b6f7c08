//! Kinds of the coordinates of a body, in the words that files and reports have.

/// A natural mode.
pub const NATURAL_MODE: &str = "natural mode";
/// A static shape, whose frequency is no natural one.
pub const STATIC_SHAPE: &str = "static shape";
/// The static answer to the moments of a body that bends far.
pub const STATIC_ANSWER: &str = "static answer";
/// A combination of natural modes, beside a static answer.
pub const COMBINATION: &str = "combination of modes";
