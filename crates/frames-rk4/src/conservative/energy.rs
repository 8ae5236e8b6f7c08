//! Energies of a motion, and the energy scale of what acts on it.

use nalgebra::{Matrix3, Vector3};

use crate::column_major::{dot, weighted_squares};
use crate::conservative::body::{ConservativeBody, Translation, along};
use crate::conservative::evaluation::Evaluation;
use crate::conservative::state::{ConservativeState, Slow, get, part};
use crate::energies::Energies;
use crate::history::History;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};

impl ConservativeBody {
    /// The energies of a motion whose rates are in `e`; none of a driven body, to which a jump of its drive gives energy
    /// at an instant.
    pub(crate) fn energies_of(&self, time: f64, slow: &Slow, e: &Evaluation) -> Option<Energies> {
        if self.drive.is_some() {
            return None;
        }
        let internal =
            0.5 * (get(slow, part::PI).dot(&e.spin) + dot(&e.p, &e.modal_velocity)) + self.strain_energy(&e.q);
        let translation = 0.5 * get(slow, part::MOMENTUM).norm_squared() / self.mass;
        let (work, dissipation) = (slow[part::WORK], slow[part::DISSIPATION]);
        Some(Energies { time, internal, translation, work, dissipation })
    }

    /// Energy of rotation, vibration and strain of a state whose rates are in `e`: all but that of the origin's motion.
    pub(crate) fn internal_energy(&self, state: &ConservativeState, e: &Evaluation) -> f64 {
        let (kinetic, strain) = self.energies(state, e);
        kinetic + strain - 0.5 * get(&state.slow, part::MOMENTUM).norm_squared() / self.mass
    }

    /// Energy that the difference of two states at one time would have: ½ P²/m + ½ π·J0⁻¹π + ½ Σ (ω_k² q² + p²).
    pub(crate) fn energy_of_difference(&self, a: &ConservativeState, b: &ConservativeState) -> f64 {
        let slow = a.slow - b.slow;
        let rigid = self.rigid_energy(&get(&slow, part::MOMENTUM), &get(&slow, part::PI));
        let q = a.modal_displacement.iter().zip(&b.modal_displacement);
        let p = a.modal_momentum.iter().zip(&b.modal_momentum);
        rigid + q.zip(p).enumerate().map(|(k, (q, p))| self.modal_energy(k, q.0 - q.1, p.0 - p.1)).sum::<f64>()
    }

    /// Energies that the loads, one by one, would give the body from rest within the longest period or until `end`: by
    /// their impulse the rigid body, by their largest force the modes. The scale of a motion that begins without any.
    pub(crate) fn energy_of_loads(&self, end: f64) -> f64 {
        let lowest = self.circular_frequencies.iter().copied().reduce(f64::min);
        let period = lowest.map_or(end, |omega| (std::f64::consts::TAU / omega).min(end));
        let still = vec![0.0; self.extended()];
        let modes = &still[..self.flexible()];
        let on_manifold = self.manifold.as_ref().map(|_| [modes, modes]);
        let coordinates = Coordinates { first: 6, displacement: &still, velocity: &still, on_manifold };
        // At rest, in the body's own axes: a dead load does as much in any attitude, but for how its modes see it.
        let motion = Kinematics {
            time: 0.0,
            branch_time: 0.0,
            body_from_global: &Matrix3::identity(),
            origin_global: self.origin,
            frame_origin_global: self.origin,
            origin_velocity_global: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            coordinates,
            unit: true,
        };
        // A load without a history is a law of the motion: from rest it has no scale of its own.
        let energy = |(load, history): (&SharedLoad, &History)| {
            let largest = history.largest(end);
            let impulse = history.magnitude_integral(end).min(largest * period);
            let mut force = still.clone();
            let mut applied = Applied::new(coordinates, Vector3::zeros(), &mut force);
            load.apply(&motion, &mut applied);
            let Applied { force_body, moment_body, .. } = applied;
            let moment =
                Vector3::from_iterator((0..3).map(|i| self.axes.get(i).map_or(0.0, |axis| axis.dot(&moment_body))));
            let pushed = match self.translation {
                Translation::Free => force_body,
                Translation::Along(direction) => along(&direction, &force_body),
                Translation::None | Translation::Driven(_) => Vector3::zeros(),
            };
            let strain: f64 =
                force.iter().zip(&self.circular_frequencies).map(|(f, w)| 0.5 * (largest * f / w).powi(2)).sum();
            self.rigid_energy(&(pushed * impulse), &(moment * impulse)) + strain
        };
        let driven = self.drive.as_ref().map_or(0.0, |drive| {
            let speed = drive.speed.largest(end);
            let inertia = if self.turn_driven { self.inertia[(0, 0)] } else { self.mass };
            0.5 * inertia * speed * speed
        });
        let with_history = self.loads.iter().filter_map(|load| Some((load, load.history()?)));
        with_history.map(energy).sum::<f64>() + driven
    }

    /// ½ P²/m + ½ π·J0⁻¹π
    pub(crate) fn rigid_energy(&self, momentum: &Vector3<f64>, pi: &Vector3<f64>) -> f64 {
        0.5 * (momentum.norm_squared() / self.mass + pi.dot(&(self.inverse_inertia * pi)))
    }

    /// ½ (ω_k² q² + p²)
    fn modal_energy(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega_q = self.circular_frequencies[k] * q;
        0.5 * (omega_q * omega_q + p * p)
    }

    /// Energies of a state whose rates are in `e`: (kinetic, strain).
    pub(super) fn energies(&self, state: &ConservativeState, e: &Evaluation) -> (f64, f64) {
        let q = &state.modal_displacement;
        let moving = match (&self.drive, self.translation) {
            (Some(_), Translation::Driven(direction)) => {
                e.driven_momentum * state.attitude.to_global(&direction).dot(&get(&e.slow, part::POSITION))
            }
            (Some(_), _) => e.driven_momentum * e.spin[0],
            (None, _) => {
                get(&state.slow, part::MOMENTUM).norm_squared() / self.mass + get(&state.slow, part::PI).dot(&e.spin)
            }
        };
        // What of the driven momentum is not in p.
        let stressed = e.driven_speed * dot(&e.drive_stress, &e.modal_velocity);
        let kinetic = 0.5 * (moving + dot(&state.modal_momentum, &e.modal_velocity) - stressed);
        (kinetic, self.strain_energy(q))
    }

    /// ½ qᵀΛq + V_n
    fn strain_energy(&self, q: &[f64]) -> f64 {
        0.5 * weighted_squares(&self.stiffness, q) + self.manifold.as_ref().map_or(0.0, |manifold| manifold.energy(q))
    }

    /// Lowest ω_k; infinite without modes.
    pub(crate) fn lowest_frequency(&self) -> f64 {
        self.circular_frequencies.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Largest of ω_k and 2 ζ_k ω_k.
    pub(crate) fn fastest_rate(&self) -> f64 {
        self.fastest_rate
    }
}
