//! Error of linear strain in a mode: numbers.

/// Error of linear strain in a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainError {
    /// The expected amplitude: largest displacement of a node, over the length of the body.
    pub deflection: f64,
    /// Ω/ω − 1 at that amplitude: negative where the linear frequency is too high.
    pub frequency: f64,
    /// Phase by which the mode is out at the end of the time that it rings, rad.
    pub phase: f64,
    /// Error of the force that holds the mode at that amplitude, relative.
    pub statics: f64,
}

impl StrainError {
    /// The largest error.
    pub(crate) fn largest(&self) -> f64 {
        self.frequency.abs().max(self.phase).max(self.statics)
    }
}
