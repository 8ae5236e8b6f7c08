//! Energies of a motion.

use nalgebra::Vector3;

use crate::conservative::body::{ConservativeBody, Translation};
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::{get, part};
use crate::matrix::lists::{dot, weighted_squares};
use crate::observation::energies::Energies;
use crate::state::State;

impl ConservativeBody {
    /// The energies of a motion whose rates are in `e`; none of a driven body, to which a jump of its drive gives energy
    /// at an instant.
    pub(super) fn energies_at(&self, time: f64, e: &Evaluation) -> Option<Energies> {
        if self.drive.is_some() {
            return None;
        }
        let (slow, q, p) = (e.at.slow(), e.at.q(), e.at.p());
        let internal = 0.5 * (get(slow, part::PI).dot(&e.spin) + dot(p, &e.modal_velocity)) + self.strain_energy(q);
        let translation = 0.5 * get(slow, part::MOMENTUM).norm_squared() / self.mass;
        let (work, dissipation) = (slow[part::WORK], slow[part::DISSIPATION]);
        Some(Energies { time, internal, translation, work, dissipation })
    }

    /// Energy of rotation, vibration and strain of a state whose rates are in `e`: all but that of the origin's motion.
    pub(crate) fn internal_energy(&self, state: &State, e: &Evaluation) -> f64 {
        let [_, kinetic, strain] = self.energies(state, e);
        kinetic + strain
    }

    /// Kinetic energy that the motion of its frame adds to a momentum in it: U·P + ½ m U².
    pub(crate) fn energy_of_frame(&self, momentum: &Vector3<f64>) -> f64 {
        let velocity = self.frame.velocity();
        velocity.dot(momentum) + 0.5 * self.mass * velocity.norm_squared()
    }

    /// Work of the loads and energy that damping has taken, since the beginning, of a state.
    pub(crate) fn work_and_dissipation_of(&self, state: &State) -> [f64; 2] {
        let list = self.list(state);
        let slow = list.slow();
        [slow[part::WORK] + self.frame.velocity().dot(&get(slow, part::IMPULSE)), slow[part::DISSIPATION]]
    }

    /// ½ P²/m + ½ π·J0⁻¹π
    pub(crate) fn rigid_energy(&self, momentum: &Vector3<f64>, pi: &Vector3<f64>) -> f64 {
        0.5 * (momentum.norm_squared() / self.mass + pi.dot(&(self.inverse_inertia * pi)))
    }

    /// ½ (ω_k² q² + p²)
    pub(crate) fn modal_energy(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega_q = self.circular_frequencies[k] * q;
        0.5 * (omega_q * omega_q + p * p)
    }

    /// Energies of a state whose rates are in `e`, in the frame: of the motion of the origin as the momentum takes it, kinetic beside
    /// that, and strain.
    pub(super) fn energies(&self, state: &State, e: &Evaluation) -> [f64; 3] {
        let state = self.list(state);
        let moving = match (&self.drive, self.translation) {
            (Some(_), Translation::Driven(direction)) => {
                e.driven_momentum * state.attitude().to_global(&direction).dot(&get(e.rates.slow(), part::POSITION))
            }
            (Some(_), _) => e.driven_momentum * e.spin[0],
            (None, _) => get(state.slow(), part::PI).dot(&e.spin),
        };
        let translation = match &self.drive {
            Some(_) => 0.0,
            None => 0.5 * get(state.slow(), part::MOMENTUM).norm_squared() / self.mass,
        };
        // What of the driven momentum is not in p.
        let stressed = e.driven_speed * dot(&e.drive_stress, &e.modal_velocity);
        let kinetic = 0.5 * (moving + dot(state.p(), &e.modal_velocity) - stressed);
        [translation, kinetic, self.strain_energy(state.q())]
    }

    /// ½ qᵀΛq + V_n, and g·q + ½ qᵀBq about a reference.
    fn strain_energy(&self, q: &[f64]) -> f64 {
        0.5 * weighted_squares(&self.stiffness, q)
            + self.manifold.as_ref().map_or(0.0, |manifold| manifold.energy(q))
            + self.reference.as_ref().map_or(0.0, |reference| reference.energy(q))
    }

    /// Lowest ω_k; infinite without modes.
    pub(crate) fn lowest_frequency(&self) -> f64 {
        self.circular_frequencies.iter().copied().fold(f64::INFINITY, f64::min)
    }
}
