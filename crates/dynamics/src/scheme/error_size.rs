//! How large the error of a step is beside the motion: what step control keeps within its tolerance.
//!
//! Three sizes, each the root of a sum over the whole body and relative to the largest so far: of the energy, of the
//! modal displacements, and of the accelerations. The energy alone, most of which may be that of the rigid motion, would
//! let a small vibration be wrong altogether; displacements alone would let high modes be, which make accelerations.

use serde::{Deserialize, Serialize};

use crate::conservative::{ConservativeBody, ConservativeState, Evaluation, get, part};
use crate::simulation::checkpoint::{CheckpointError, finite};
use crate::vibration::own_coupling::LoadCoupling;

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
        let natural = 0..self.natural_modes;
        let modal: f64 = natural.clone().map(|k| (e.momentum[k] + self.linear_rate(k, q[k], p[k])).powi(2)).sum();
        let forces: f64 = natural.map(|k| e.momentum[k].powi(2)).sum();
        Sizes {
            energy: self.internal_energy(state, e),
            displacement: q.iter().map(|q| q * q).sum(),
            acceleration: rigid + modal.max(forces),
        }
    }
}

/// By how much the difference of a step and two of half its length exceeds the error of the latter, at fourth order. A mode
/// that turns by many radians in a step follows its load with an error of first order, which is as large as the difference.
pub(crate) const ORDER_GAIN: f64 = 15.0;

/// Times 1/(ζ_k ω_k) after which a mode has forgotten its errors.
const FORGOTTEN: f64 = 3.0;

/// Measures the errors of steps of one body in one run, so that the errors of all steps add up to that at the end.
#[derive(Debug, Clone, Default)]
pub(crate) struct ErrorSize {
    /// How long each mode remembers an error, as a part of the run (nf).
    memory: Vec<f64>,
    load_coupling: Vec<LoadCoupling>,
    /// When the run ends.
    end: f64,
}

impl ErrorSize {
    /// Of a run until `end`.
    pub(crate) fn new(body: &ConservativeBody, end: f64) -> Self {
        let modes = body.circular_frequencies.iter().zip(&body.damping_ratios);
        let memory = modes.map(|(omega, zeta)| FORGOTTEN / (omega * zeta.min(zeta.recip()) * end)).collect();
        Self { memory, load_coupling: body.load_coupling(), end }
    }

    /// What an error that a `step` makes in a mode counts: only errors that the mode remembers add up.
    fn weight(&self, mode: usize, step: f64) -> f64 {
        self.memory[mode].max(step / self.end).min(1.0)
    }

    /// Sizes of the difference of two states at the end of a `step`.
    ///
    /// A static shape has no acceleration of its own: it stands for all that follows its load.
    pub(crate) fn of_difference(
        &self,
        body: &ConservativeBody,
        a: &ConservativeState,
        b: &ConservativeState,
        step: f64,
    ) -> Sizes {
        let slow = a.slow - b.slow;
        let rigid = body.rigid_energy(&get(&slow, part::MOMENTUM), &get(&slow, part::PI));
        let mut sizes = Sizes { energy: rigid, ..Sizes::default() };
        let q = a.modal_displacement.iter().zip(&b.modal_displacement).map(|(a, b)| a - b);
        let p = a.modal_momentum.iter().zip(&b.modal_momentum).map(|(a, b)| a - b);
        for (k, (q, p)) in q.zip(p).enumerate() {
            let weight = self.weight(k, step);
            let (q, p) = (weight * q, weight * p);
            sizes.energy += body.modal_energy(k, q, p);
            let displacement = if body.circular_frequencies[k] * step > SEEN { ORDER_GAIN * q } else { q };
            sizes.displacement += displacement * displacement;
            if k < body.natural_modes {
                sizes.acceleration += body.linear_rate(k, q, p).powi(2);
            }
        }
        sizes
    }

    /// Error of a `step` that half of it does not show: where modes turn by many radians in a step, its stages meet what
    /// couples them at any phase, and so do those of half the step, so that the two agree on a motion without it. Counted is
    /// what the coupling of such a mode to itself and to modes of like frequency does in the step to its swing, which is what
    /// does not follow its load.
    ///
    /// The stress of loads counts by displacement only: a body that is loaded slowly swings too little for anything else. So
    /// does a static shape, and by no more than its swing in the whole run.
    pub(crate) fn unseen(&self, body: &ConservativeBody, step: f64, end: &StepEnd<'_>) -> Sizes {
        let StepEnd { state, e, .. } = end;
        let spin = e.spin.norm();
        let mut sizes = Sizes::default();
        for (k, omega) in body.circular_frequencies.iter().enumerate() {
            if omega * step <= SEEN {
                continue;
            }
            let square = omega * omega;
            let held = e.momentum[k] / square;
            let moves = (e.momentum[k] - end.force_before[k]) / (end.since * square);
            let swing = (state.modal_displacement[k] - held).hypot((e.modal_velocity[k] - moves) / omega);
            let [softening, turning] = body.own_coupling[k];
            let factor = 0.5 * step * self.weight(k, step);
            let p = factor * spin * (spin * softening + omega * turning) * swing;
            let stress: f64 = self.load_coupling.iter().map(|load| load.stiffness(k, state.time)).sum();
            let displacement = (p + factor * stress * swing) / omega;
            if k < body.natural_modes {
                sizes.energy += 0.5 * p * p;
                sizes.displacement += displacement.powi(2);
                sizes.acceleration += (p * omega).powi(2);
            } else {
                sizes.displacement += displacement.min(2.0 * swing * step / self.end).powi(2);
            }
        }
        sizes
    }
}

/// The end of a step, and the forces on the modes some time before it.
pub(crate) struct StepEnd<'a> {
    pub state: &'a ConservativeState,
    /// Rates at the state, the linear part of the modes left out.
    pub e: &'a Evaluation,
    /// Forces on the modes before, without the linear part (nf).
    pub force_before: &'a [f64],
    /// How long before.
    pub since: f64,
}
