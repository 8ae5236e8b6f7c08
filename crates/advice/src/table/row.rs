//! Rows of the table.

use dynamics::Effect;

use crate::strain::error::StrainError;

/// The subject of a row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Subject {
    /// An effect.
    Effect(Effect),
    /// Static shapes beside the modes.
    StaticCorrection,
    /// Large deflection, which no setting helps: "on" from 10 % of the length, and a warning.
    Deflection,
    /// The error of the step: "on" warns.
    Step,
}

impl Subject {
    /// Its name; that of what a scene can switch is its key there.
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect(effect) => effect.name(),
            Self::StaticCorrection => "static_correction",
            Self::Deflection => "deflection",
            Self::Step => "step",
        }
    }

    /// The dimensionless number that governs it, as a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Effect(effect) => match effect {
                Effect::Flexibility => "|q̈|/|a_rigid|",
                Effect::Damping => "ζ_k ω_k T",
                Effect::Gravity => "m g T / (all impulses), or g T²/L",
                Effect::DeformedInertia => "2c·q/J",
                Effect::Coriolis => "2 Ω G_kl/ω_k",
                Effect::GeometricStiffening => "Ω² K_σ,kk/ω_k²",
                Effect::LargeDeflection => "|Δω_k|/ω_k of linear strain",
                Effect::Translation => "∫F dt + m v > 0",
                Effect::Rotation => "∫M dt + J ω / (all impulses)",
            },
            Self::StaticCorrection => "1 − Σ(Φ_k·f)²/ω_k² / f·K⁻¹f",
            Self::Deflection => "u/L",
            Self::Step => "h ω_max, or h Ω",
        }
    }
}

/// The influence of a subject on a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The number of [`Subject::formula`].
    pub value: f64,
    /// Relative influence on the answer, bounded above; at most 1.
    pub influence: f64,
    /// True if that reaches the tolerance ([`Subject::Deflection`]: if the deflection reaches 10 % of the length).
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
    /// True if that reaches the tolerance.
    pub worth_keeping: bool,
    /// Influence on the answer of what linear strain may get wrong of it at most, as far as that is known without its
    /// [`Backbone`](crate::Backbone); at most 1.
    pub strain_bound: f64,
    /// Error of linear strain, where its backbone is known.
    pub strain: Option<StrainError>,
}
