//! Where engine orders and branches cross.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use dynamics::{EigenError, SpinMode, SteadySpin};
use serde::Serialize;

use super::branches::Branches;

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
    /// The kind at which a branch has the frequency of an order.
    fn of_order(order: f64) -> Self {
        if order == 0.0 { Self::ZeroFrequency } else { Self::Crossing }
    }

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

/// All crossings within the speeds of the branches, not read off the branches but found as eigenvalues
/// ([`SteadySpin::critical_speeds`]).
pub(super) fn find(spin: &SteadySpin, branches: &Branches, orders: &[f64]) -> Result<Vec<Critical>, EigenError> {
    let (Some(&start), Some(&end)) = (branches.speeds.first(), branches.speeds.last()) else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for &order in std::iter::once(&0.0).chain(orders) {
        for speed in spin.critical_speeds(order)?.into_iter().filter(|speed| (start..=end).contains(speed)) {
            let off = |omega: f64| (omega - order * speed).abs();
            let modes = branches.at(&|speed| spin.modes(speed), speed)?;
            let nearest = modes
                .iter()
                .enumerate()
                .min_by(|(_, a), (_, b)| off(a.circular_frequency).total_cmp(&off(b.circular_frequency)));
            if let Some((k, _)) = nearest {
                let kind = CriticalKind::of_order(order);
                all.push(Critical { kind, order, mode: k + 1, speed, frequency: order * speed / TAU });
            }
        }
    }
    Ok(all)
}

/// All crossings of branches between their speeds, with the square of each frequency a straight line in that of the speed: so it goes
/// with stiffness that grows with the centrifugal force, and a crossing is off by far less than the step. Order 0 where a vibration
/// without damping stops to swing and grows.
pub(super) fn between(branches: &Branches, orders: &[f64]) -> Vec<Critical> {
    let mut all = Vec::new();
    for &order in std::iter::once(&0.0).chain(orders) {
        let kind = CriticalKind::of_order(order);
        let counted = if kind == CriticalKind::ZeroFrequency { 1.0 } else { 0.0 };
        let square = |mode: &SpinMode| mode.circular_frequency.powi(2) - counted * mode.growth.powi(2);
        for (i, pair) in branches.speeds.windows(2).enumerate() {
            let [from, to] = [pair[0] * pair[0], pair[1] * pair[1]];
            for k in 0..branches.modes[i].len() {
                let [before, after] =
                    [(i, from), (i + 1, to)].map(|(at, speed)| square(&branches.modes[at][k]) - order * order * speed);
                if (before > 0.0) == (after > 0.0) {
                    continue;
                }
                let speed = (from + (to - from) * before / (before - after)).sqrt();
                all.push(Critical { kind, order, mode: k + 1, speed, frequency: order * speed / TAU });
            }
        }
    }
    all.sort_by(Critical::by_order_and_speed);
    all
}
