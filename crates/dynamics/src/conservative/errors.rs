//! The error of a step of the conservative form beside the motion.
//!
//! Three sizes, each the root of a sum over the whole body and relative to the largest so far: of the energy, of the
//! modal displacements, and of the accelerations. The energy alone, most of which may be that of the rigid motion, would
//! let a small vibration be wrong altogether; displacements alone would let high modes be, which make accelerations.

use crate::conservative::{ConservativeBody, Evaluation, get, part};
use crate::equations::sizes::Sizes;
use crate::equations::{ErrorNorm, StepDone};
use crate::state::State;
use crate::vibration::own_coupling::LoadCoupling;

/// Largest turn of a mode in a step, rad, at which half of the step tells what the step gets wrong.
const SEEN: f64 = 8.0;

impl ConservativeBody {
    /// The sizes of a motion whose rates, the linear part of the modes left out, are in `e`.
    fn sizes(&self, state: &State, e: &Evaluation) -> Sizes {
        let (force, moment) = (get(e.rates.slow(), part::MOMENTUM), get(e.rates.slow(), part::PI));
        // Tangential accelerations by π' ≈ J₀ α, and those towards the axis.
        let rigid = 2.0 * self.rigid_energy(&force, &moment)
            + e.spin.norm_squared() * e.spin.dot(&(self.deformed_inertia(pulp::Scalar::new(), e) * e.spin));
        let list = self.list(state);
        let (q, p, rates) = (list.q(), list.p(), e.rates.p());
        let natural = 0..self.natural_modes;
        let modal: f64 = natural.clone().map(|k| (rates[k] + self.linear_rate(k, q[k], p[k])).powi(2)).sum();
        let forces: f64 = natural.map(|k| rates[k].powi(2)).sum();
        // What laws of the motion push has no scale but the motion that they have given it.
        let given =
            if self.has_own_loads() { 0.5 * get(list.slow(), part::IMPULSE).norm_squared() / self.mass } else { 0.0 };
        Sizes {
            energy: self.internal_energy(state, e) + given,
            displacement: q.iter().map(|q| q * q).sum(),
            acceleration: rigid + modal.max(forces),
        }
    }
}

/// Times 1/(ζ_k ω_k) after which a mode has forgotten its errors.
const FORGOTTEN: f64 = 3.0;

/// Measures the errors of steps of one body in one run, so that the errors of all steps add up to that at the end.
#[derive(Debug)]
pub(super) struct ErrorSize {
    /// How long each mode remembers an error, as a part of the run (nf).
    memory: Vec<f64>,
    load_coupling: Vec<LoadCoupling>,
    /// When the run ends.
    end: f64,
}

impl ErrorSize {
    /// Measure for a run until `end`.
    pub(super) fn new(body: &ConservativeBody, end: f64) -> Self {
        let modes = body.circular_frequencies.iter().zip(&body.damping_ratios);
        let memory = modes.map(|(omega, zeta)| FORGOTTEN / (omega * zeta.min(zeta.recip()) * end)).collect();
        Self { memory, load_coupling: body.load_coupling(), end }
    }

    /// Weight of an error that a `step` makes in a mode: only errors that the mode remembers add up.
    fn weight(&self, mode: usize, step: f64) -> f64 {
        self.memory[mode].max(step / self.end).min(1.0)
    }
}

impl ErrorNorm<ConservativeBody> for ErrorSize {
    fn motion(&self, body: &ConservativeBody, state: &State, e: &Evaluation) -> Sizes {
        body.sizes(state, e)
    }

    fn lowest_frequency(&self, body: &ConservativeBody) -> f64 {
        body.lowest_frequency()
    }

    /// A mode that turns by many radians in a step follows its load with an error of first order, which is as large as the
    /// difference. A static shape has no acceleration of its own: it stands for all that follows its load.
    fn difference(&self, body: &ConservativeBody, states: [&State; 2], step: f64, gain: f64) -> Sizes {
        let [a, b] = states.map(|state| body.list(state));
        let [force, moment] = [part::MOMENTUM, part::PI].map(|part| get(a.slow(), part) - get(b.slow(), part));
        let rigid = body.rigid_energy(&force, &moment);
        let mut sizes = Sizes { energy: rigid, ..Sizes::default() };
        let q = a.q().iter().zip(b.q()).map(|(a, b)| a - b);
        let p = a.p().iter().zip(b.p()).map(|(a, b)| a - b);
        for (k, (q, p)) in q.zip(p).enumerate() {
            let weight = self.weight(k, step);
            let (q, p) = (weight * q, weight * p);
            sizes.energy += body.modal_energy(k, q, p);
            let displacement = if body.circular_frequencies[k] * step > SEEN { gain * q } else { q };
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
    fn unseen(&self, body: &ConservativeBody, step: f64, end: &StepDone<'_, ConservativeBody>) -> Sizes {
        let StepDone { state, e, .. } = end;
        let list = body.list(state);
        let (q, forces, before) = (list.q(), e.rates.p(), end.before.rates.p());
        let spin = e.spin.norm();
        let mut sizes = Sizes::default();
        for (k, omega) in body.circular_frequencies.iter().enumerate() {
            if omega * step <= SEEN {
                continue;
            }
            let square = omega * omega;
            let held = forces[k] / square;
            let moves = (forces[k] - before[k]) / (end.since * square);
            let swing = (q[k] - held).hypot((e.modal_velocity[k] - moves) / omega);
            let [softening, turning] = body.own_coupling[k];
            let factor = 0.5 * step * self.weight(k, step);
            let p = factor * spin * (spin * softening + omega * turning) * swing;
            let stress: f64 = self.load_coupling.iter().map(|load| load.stiffness(k, end.state.time)).sum();
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
