//! The scale of the motion that the loads will cause, known before it begins.

use nalgebra::{Matrix3, Vector3};

use crate::conservative::body::{ConservativeBody, Translation, along};
use crate::equations::sizes::Sizes;
use crate::history::History;
use crate::load::{Applied, Coordinates, Kinematics, Load, SharedLoad};
use crate::vibration::own_coupling::{LoadCoupling, largest_alike};

impl ConservativeBody {
    /// Sizes of the motions that the loads, one by one, would cause from rest until `end`: the scale of a motion that begins
    /// without any.
    ///
    /// * Energy: by their impulse within the longest period that of the rigid body, by their largest force that of the modes.
    /// * Displacement: of each mode what its largest force holds, or its impulse throws, whichever is less.
    /// * Acceleration: that of the largest force.
    pub(super) fn largest_by_loads(&self, end: f64) -> Sizes {
        let lowest = self.circular_frequencies.iter().copied().reduce(f64::min);
        let period = lowest.map_or(end, |omega| (std::f64::consts::TAU / omega).min(end));
        let energy = self.energy_of_drive(end) + self.least_energy(end);
        let mut sizes = Sizes { energy, ..Sizes::default() };
        // The forces of a bent reference act all the time, like a load.
        let forces = self.reference.iter().flat_map(|reference| reference.force());
        for (k, (g, omega)) in forces.zip(&self.circular_frequencies).enumerate() {
            sizes.energy += 0.5 * (g / omega).powi(2);
            sizes.displacement += (g * (omega * omega).recip().min(2.0 * end / omega)).powi(2);
            if k < self.natural_modes {
                sizes.acceleration += g * g;
            }
        }
        for (load, history) in self.with_history() {
            let largest = history.largest(end);
            let whole_impulse = history.magnitude_integral(end);
            let impulse = whole_impulse.min(largest * period);
            let UnitLoad { modal, force_body, moment_body } = self.unit_load(&**load, &vec![0.0; self.flexible()]);
            let moment =
                Vector3::from_iterator((0..3).map(|i| self.axes.get(i).map_or(0.0, |axis| axis.dot(&moment_body))));
            let pushed = match self.translation {
                Translation::Free => force_body,
                Translation::Along(direction) => along(&direction, &force_body),
                Translation::None | Translation::Driven(_) => Vector3::zeros(),
            };
            let rigid = self.rigid_energy(&pushed, &moment);
            sizes.energy += rigid * impulse * impulse;
            sizes.acceleration += 2.0 * rigid * largest * largest;
            for (k, (f, omega)) in modal.iter().zip(&self.circular_frequencies).enumerate() {
                sizes.energy += 0.5 * (largest * f / omega).powi(2);
                let held = largest / (omega * omega);
                sizes.displacement += (f * held.min(2.0 * whole_impulse / omega)).powi(2);
                if k < self.natural_modes {
                    sizes.acceleration += (largest * f).powi(2);
                }
            }
        }
        sizes
    }

    /// How the stress of each load couples the modes; nothing of loads without stress.
    pub(crate) fn load_coupling(&self) -> Vec<LoadCoupling> {
        let nf = self.flexible();
        let stressed = self.with_history().filter(|(load, _)| load.matrix_entries() > 0);
        let coupling = |(load, history): (&SharedLoad, &History)| {
            let force = |q: &[f64]| self.unit_load(&**load, q).modal;
            let still = force(&vec![0.0; nf]);
            // The stiffness, column by column: forces are linear in the modes.
            let columns: Vec<Vec<f64>> = (0..nf)
                .map(|k| {
                    let unit: Vec<f64> = (0..nf).map(|l| f64::from(u8::from(k == l))).collect();
                    force(&unit).iter().zip(&still).map(|(a, b)| (a - b).abs()).collect()
                })
                .collect();
            let omega = &self.circular_frequencies;
            let of_modes = (0..nf).map(|k| largest_alike(omega, k, |l| columns[k][l].max(columns[l][k]))).collect();
            LoadCoupling::new(history.clone(), of_modes)
        };
        stressed.map(coupling).collect()
    }

    /// True if a load is a law of the motion.
    pub(super) fn has_own_loads(&self) -> bool {
        self.loads.iter().any(|load| load.history().is_none())
    }

    /// The energy of a body that moves by its radius of gyration until `end`, or turns by as much: where laws of the motion may push it, what
    /// is less than the tolerance of it is not seen.
    fn least_energy(&self, end: f64) -> f64 {
        if !self.is_free() || !self.has_own_loads() {
            return 0.0;
        }
        0.5 * self.mass * (self.radius_of_gyration() / end).powi(2)
    }

    /// Loads with a history: one without is a law of the motion, and from rest has no scale of its own.
    fn with_history(&self) -> impl Iterator<Item = (&SharedLoad, &History)> {
        self.loads.iter().filter_map(|load| Some((load, load.history()?)))
    }

    /// The energy that a drive gives the body.
    fn energy_of_drive(&self, end: f64) -> f64 {
        self.drive.as_ref().map_or(0.0, |drive| {
            let speed = drive.speed.largest(end);
            let inertia = if self.turn_driven { self.inertia[(0, 0)] } else { self.mass };
            0.5 * inertia * speed * speed
        })
    }

    /// A load whose history is 1, on a body that rests in the axes of its mesh with these modal displacements: a dead load
    /// does as much in any attitude, but for how its modes see it.
    fn unit_load(&self, load: &dyn Load, q: &[f64]) -> UnitLoad {
        let still = vec![0.0; self.extended()];
        let rest = &still[..self.flexible()];
        let mut displacement = still.clone();
        displacement.iter_mut().zip(q).for_each(|(to, q)| *to = *q);
        let on_manifold = self.manifold.as_ref().map(|_| [q, rest]);
        let coordinates = Coordinates { first: 6, displacement: &displacement, velocity: &still, on_manifold };
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
        let (mut force, mut on_modes) = (still.clone(), rest.to_vec());
        let mut applied = Applied::new(coordinates, Vector3::zeros(), &mut force);
        if self.manifold.is_some() {
            applied = applied.on_manifold(&mut on_modes);
        }
        load.apply(&motion, &mut applied);
        let Applied { force_body, moment_body, .. } = applied;
        force.truncate(self.flexible());
        force.iter_mut().zip(&on_modes).for_each(|(f, on_mode)| *f += on_mode);
        UnitLoad { modal: force, force_body, moment_body }
    }
}

/// A load whose history is 1, at rest.
struct UnitLoad {
    /// Forces on the flexible modes (nf).
    modal: Vec<f64>,
    /// Resultant, body components.
    force_body: Vector3<f64>,
    /// Moment about the origin, body components.
    moment_body: Vector3<f64>,
}
