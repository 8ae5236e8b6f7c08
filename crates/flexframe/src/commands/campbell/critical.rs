//! Speeds at which branches meet engine orders, lose their stability, or begin to swing.

use std::cmp::Ordering;

use serde::Serialize;

/// Kinds of critical speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CriticalKind {
    /// A load that turns with an order meets a natural frequency.
    Crossing,
    /// A natural frequency is zero.
    ZeroFrequency,
    /// From here on, with rising speed, a vibration grows.
    GrowthBegins,
    /// From here on a vibration that grew does not.
    GrowthEnds,
}

impl CriticalKind {
    /// Name in tables for programs, as in JSON.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::ZeroFrequency => "zero_frequency",
            Self::GrowthBegins => "growth_begins",
            Self::GrowthEnds => "growth_ends",
        }
    }
}

/// A critical speed of the spin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Critical {
    /// Its kind.
    pub kind: CriticalKind,
    /// Times a turn; 0 where no load has a part in it.
    pub order: f64,
    /// Number of the mode whose branch it is.
    pub mode: usize,
    /// Spin speed, radians per time.
    pub speed: f64,
    /// Frequency, cycles per time.
    pub frequency: f64,
}

impl Critical {
    pub(super) fn by_order_and_speed(&self, other: &Self) -> Ordering {
        self.order.total_cmp(&other.order).then(self.speed.total_cmp(&other.speed))
    }
}

/// A speed at which a vibration that is damped so much that it only decays begins to swing, or stops to. It is stable on both sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SwingLimit {
    /// Number of the mode whose branch it is.
    pub mode: usize,
    /// Spin speed, radians per time.
    pub speed: f64,
    /// True if it swings above this speed, false if it swings below.
    pub swings_above: bool,
}
