//! How large the error of a step is beside the motion: what step control keeps within its tolerance.
//!
//! Three sizes, each the root of a sum over the whole body and relative to the largest so far: of the energy, of the
//! modal displacements, and of the accelerations. The energy alone, most of which may be that of the rigid motion, would
//! let a small vibration be wrong altogether; displacements alone would let high modes be, which make accelerations.

use serde::{Deserialize, Serialize};

use crate::checkpoint::{CheckpointError, finite};
use crate::conservative::{ConservativeBody, ConservativeState, Evaluation, get, part};

/// Squares of the sizes of a motion, or of the difference of two states.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sizes {
    /// Energy, that of the origin's motion left out where it is a motion's.
    pub energy: f64,
    /// Σ q², which is ∫ ρ |u|² dV.
    pub displacement: f64,
    /// ∫ ρ |a|² dV of the rigid motion and of the modes.
    pub acceleration: f64,
}

/// Part of the motion, as a ratio of amplitudes, below which a vibration is taken as rounding.
const STILL: f64 = 1e-6;

/// Largest turn of a mode in a step, rad, at which half of the step tells what the step gets wrong.
const SEEN: f64 = 8.0;

impl Sizes {
    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            energy: self.energy.max(other.energy),
            displacement: self.displacement.max(other.displacement),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("the size of the motion", [&self.energy, &self.displacement, &self.acceleration])
    }

    /// The largest of the three beside those of a motion of a body with this lowest ω_k.
    pub(crate) fn relative_to(self, motion: Self, lowest: f64) -> f64 {
        // What vibrates with less is rounding.
        let still = STILL * STILL * motion.energy;
        let square = lowest * lowest;
        let pairs = [
            (self.energy, motion.energy),
            (self.displacement, motion.displacement.max(still / square)),
            (self.acceleration, motion.acceleration.max(still * square)),
        ];
        let ratios = pairs.map(|(error, whole)| if error == 0.0 { 0.0 } else { (error / whole).sqrt() });
        // A NaN stays one.
        ratios.into_iter().fold(0.0, |most, ratio| if ratio <= most { most } else { ratio })
    }
}

impl ConservativeBody {
    /// The sizes of a motion whose rates, the linear part of the modes left out, are in `e`.
    pub(crate) fn sizes(&self, state: &ConservativeState, e: &Evaluation) -> Sizes {
        let (force, moment) = (get(&e.slow, part::MOMENTUM), get(&e.slow, part::PI));
        // Tangential accelerations by π' ≈ J₀ α, and those towards the axis.
        let rigid = 2.0 * self.rigid_energy(&force, &moment)
            + e.spin.norm_squared() * e.spin.dot(&(self.deformed_inertia(pulp::Scalar::new(), e) * e.spin));
        let (q, p) = (&state.modal_displacement, &state.modal_momentum);
        let modal: f64 = (0..q.len()).map(|k| (e.momentum[k] + self.linear_rate(k, q[k], p[k])).powi(2)).sum();
        Sizes {
            energy: self.internal_energy(state, e),
            displacement: q.iter().map(|q| q * q).sum(),
            acceleration: rigid + modal,
        }
    }

    /// The sizes of the difference of two states at one time.
    pub(crate) fn sizes_of_difference(&self, a: &ConservativeState, b: &ConservativeState) -> Sizes {
        let q = a.modal_displacement.iter().zip(&b.modal_displacement).map(|(a, b)| a - b);
        let p = a.modal_momentum.iter().zip(&b.modal_momentum).map(|(a, b)| a - b);
        let mut sizes = Sizes { energy: self.energy_of_difference(a, b), ..Sizes::default() };
        for (k, (q, p)) in q.zip(p).enumerate() {
            sizes.displacement += q * q;
            sizes.acceleration += self.linear_rate(k, q, p).powi(2);
        }
        sizes
    }

    /// What a `step` leaves out unseen: where modes turn by many radians in a step, its stages meet their coupling to the
    /// spin at any phase, and so do those of half the step, so that the two agree on a motion without it. Counted is what
    /// the coupling of such a mode to itself and to modes of like frequency does to what swings of it, in the step.
    pub(crate) fn unseen(&self, step: f64, state: &ConservativeState, e: &Evaluation) -> Sizes {
        let spin = e.spin.norm();
        let mut sizes = Sizes::default();
        for (k, omega) in self.circular_frequencies.iter().enumerate() {
            if omega * step <= SEEN {
                continue;
            }
            // What follows its load is no swing.
            let swing =
                (state.modal_displacement[k] - e.momentum[k] / (omega * omega)).hypot(e.modal_velocity[k] / omega);
            let [softening, turning] = self.own_coupling[k];
            let p = 0.5 * step * spin * (spin * softening + omega * turning) * swing;
            sizes.energy += 0.5 * p * p;
            sizes.displacement += (p / omega).powi(2);
            sizes.acceleration += (p * omega).powi(2);
        }
        sizes
    }
}
