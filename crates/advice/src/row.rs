//! What a row of the table says.

/// What a run can have or leave out, or goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Effect {
    /// The body deforms.
    Flexibility,
    /// The modes are damped.
    Damping,
    /// Gravity acts.
    Gravity,
    /// The inertia follows the deformation.
    DeformedInertia,
    /// Turning couples the modes.
    Coriolis,
    /// The stress of the spin stiffens the body.
    GeometricStiffening,
    /// The body as a whole moves.
    Translation,
    /// The body as a whole turns.
    Rotation,
    /// Static shapes beside the modes.
    StaticCorrection,
    /// Large deflection, which no setting cures: "on" from 10 % of the length, and a warning.
    Deflection,
    /// Foreshortening, which no setting cures: "on" warns.
    Foreshortening,
    /// The error of the step: "on" warns.
    Step,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Flexibility,
        Self::Damping,
        Self::Gravity,
        Self::DeformedInertia,
        Self::Coriolis,
        Self::GeometricStiffening,
        Self::Translation,
        Self::Rotation,
        Self::StaticCorrection,
        Self::Deflection,
        Self::Foreshortening,
        Self::Step,
    ];

    /// Its name, as in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flexibility => "flexibility",
            Self::Damping => "damping",
            Self::Gravity => "gravity",
            Self::DeformedInertia => "deformed_inertia",
            Self::Coriolis => "coriolis",
            Self::GeometricStiffening => "geometric_stiffening",
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::StaticCorrection => "static_correction",
            Self::Deflection => "deflection",
            Self::Foreshortening => "foreshortening",
            Self::Step => "step",
        }
    }

    /// The dimensionless number that governs it, as a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Flexibility => "|q̈|/|a_rigid|",
            Self::Damping => "ζ_k ω_k T",
            Self::Gravity => "m g T / (all impulses)",
            Self::DeformedInertia => "2c·q/J",
            Self::Coriolis => "2 Ω G_kl/ω_k",
            Self::GeometricStiffening => "Ω² K_σ,kk/ω_k²",
            Self::Translation => "∫F dt + m v > 0",
            Self::Rotation => "∫M dt + J ω / (all impulses)",
            Self::StaticCorrection => "1 − Σ(Φ_k·f)²/ω_k² / f·K⁻¹f",
            Self::Deflection => "u/L",
            Self::Foreshortening => "6.2 (u/L)²",
            Self::Step => "h ω_max, or h Ω",
        }
    }
}

/// An effect and what it means for a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The effect.
    pub effect: Effect,
    /// The number of [`Effect::formula`].
    pub value: f64,
    /// Relative influence on the answer, bounded above; at most 1.
    pub influence: f64,
    /// Whether that reaches the tolerance ([`Effect::Deflection`]: whether the deflection reaches 10 % of the length).
    pub on: bool,
    /// One sentence.
    pub why: String,
}

/// A mode, and what it is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worth {
    /// rad per time.
    pub circular_frequency: f64,
    /// Largest modal displacement, bounded above.
    pub displacement: f64,
    /// Its share in the deformation, bounded above; at most 1.
    pub share: f64,
    /// Whether that reaches the tolerance.
    pub worth_keeping: bool,
}
