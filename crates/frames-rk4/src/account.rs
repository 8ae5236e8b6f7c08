//! Whether the energy that a motion has is the one that it should have.
//!
//! The start, the work of the loads and the dissipation account for the energy of every state. A scheme whose steps are
//! too long breaks this long before a number overflows.

use crate::error::StepError;

/// The energy of a state, and what has been done to it since the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reckoning {
    /// Time.
    pub time: f64,
    /// Energy without that of the motion of the origin.
    pub internal: f64,
    /// Energy of the motion of the origin.
    pub translation: f64,
    /// Work of the loads.
    pub work: f64,
    /// Energy that damping has taken.
    pub dissipation: f64,
}

/// The account of a run.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct EnergyAccount {
    start: Option<Reckoning>,
    /// Largest of the energies at the start, put in and taken out so far.
    scale: f64,
    /// Largest sum of the work and the dissipation of one step: where a load sets in, they are no better known than that.
    largest_exchange: f64,
    last: Option<Reckoning>,
    /// What the loads are good for: the scale of modes that follow them within a step, where no stage sees it.
    of_loads: f64,
}

/// A step of this many radians of every mode, and with this much damping, lets the stages see the work and the
/// dissipation as they are.
const RESOLVED: f64 = 0.5;
/// Part of the energies that may be missing or too much where steps are resolved: far beyond what is of any use.
const OFF: f64 = 0.5;
/// The same where they are not, for too much alone: work and dissipation are then known in their size only.
const OFF_UNRESOLVED: f64 = 4.0;
/// Rounding in the energy of the origin's motion.
const ROUNDING: f64 = 1e-9;

/// Whether steps are short enough for the stages to see work and dissipation; the `rate` is the largest of ω_k and
/// 2 ζ_k ω_k.
pub(crate) fn is_resolved(rate: f64, step: f64) -> bool {
    rate * step <= RESOLVED
}

impl EnergyAccount {
    /// An empty account of loads that would, one by one, give the body this energy.
    pub(crate) fn new(of_loads: f64) -> Self {
        Self { of_loads, ..Self::default() }
    }

    /// Whether nothing has been checked yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.start.is_none()
    }

    /// Checks the energy at a time; the `step` is the longest so far, the `rate` the largest of ω_k and 2 ζ_k ω_k.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] and [`StepError::Energy`].
    pub(crate) fn check(&mut self, now: &Reckoning, rate: f64, step: f64) -> Result<(), StepError> {
        let Reckoning { time, internal, .. } = *now;
        let start = *self.start.get_or_insert(*now);
        let put_in = (now.work - start.work) - (now.translation - start.translation);
        let taken_out = now.dissipation - start.dissipation;
        let accounted = start.internal + put_in - taken_out;
        let excess = internal - accounted;
        if !excess.is_finite() {
            return Err(StepError::NotFinite { time, what: "the energy" });
        }
        self.scale = self.scale.max(start.internal.abs()).max(put_in.abs()).max(taken_out);
        let rounding = ROUNDING * (now.translation + start.translation);
        let last = self.last.replace(*now).unwrap_or(start);
        let exchange = (now.work - last.work).abs() + (now.dissipation - last.dissipation).abs();
        self.largest_exchange = self.largest_exchange.max(exchange);
        let unknown = self.largest_exchange + rounding;
        let is_off = if is_resolved(rate, step) {
            excess.abs() > OFF * self.scale + unknown
        } else {
            excess > OFF_UNRESOLVED * (self.scale + self.of_loads) + unknown
        };
        if is_off { Err(StepError::Energy { time, energy: internal, accounted, step }) } else { Ok(()) }
    }
}
