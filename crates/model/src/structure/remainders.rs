//! Remainders of static responses beside the modes.

/// Remainders of static responses beside the modes, √(uᵀMu − Σ(Φ_kᵀMu)²).
#[derive(Debug, Clone, Default)]
pub(crate) struct Remainders {
    /// To the centrifugal field of each pair of spins (6); none where they are not known.
    pub of_spin: Vec<f64>,
    /// To the inertia of a unit acceleration of the drive.
    pub of_drive: Option<f64>,
}

impl Remainders {
    /// True if any is known.
    pub fn any(&self) -> bool {
        !self.of_spin.is_empty() || self.of_drive.is_some()
    }
}
