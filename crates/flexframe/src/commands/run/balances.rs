//! How well what exact motion conserves is conserved.

use dynamics::Observation;
use nalgebra::Vector3;
use serde::Serialize;

use crate::files::json;

/// Largest changes, over the rows, of what should be constants of the motion, relative to the largest value of the
/// quantity itself; of the energy, or to what has come and gone by work and dissipation, if that is more; of the linear momentum of a
/// body in joints, or to that which its mass has with its largest kinetic energy, if that is more.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Balances {
    /// Energy − work of the loads + dissipation.
    #[serde(serialize_with = "json::number")]
    pub energy: f64,
    /// Linear momentum less the impulse of the loads.
    #[serde(serialize_with = "json::number")]
    pub linear_momentum: f64,
    /// Angular momentum about the centre of mass less the angular impulse of the loads.
    #[serde(serialize_with = "json::number")]
    pub angular_momentum: f64,
}

impl Balances {
    /// The larger of each.
    pub(crate) fn or_larger(&self, other: &Self) -> Self {
        Self {
            energy: self.energy.max(other.energy),
            linear_momentum: self.linear_momentum.max(other.linear_momentum),
            angular_momentum: self.angular_momentum.max(other.angular_momentum),
        }
    }
}

/// Energy, and linear and angular momentum.
pub(super) type Momenta = (f64, Vector3<f64>, Vector3<f64>);

/// Quantities that exact motion conserves, and what is left of them without what the loads and damping have done.
pub(super) struct Conserved {
    pub quantities: Momenta,
    pub balances: Momenta,
    /// The kinetic part of the energy.
    pub kinetic: f64,
}

/// The largest values of what exact motion conserves, and the largest kinetic energy.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Largest {
    pub of: Balances,
    pub kinetic: f64,
}

impl Largest {
    /// The larger of each.
    pub fn or_larger(&self, other: &Self) -> Self {
        Self { of: self.of.or_larger(&other.of), kinetic: self.kinetic.max(other.kinetic) }
    }
}

/// Watches the constants of the motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Monitor {
    start: Option<Momenta>,
    changes: Balances,
    scales: Largest,
}

impl Monitor {
    /// Takes one more observation into account.
    pub(crate) fn watch(&mut self, now: &Observation) {
        self.take(&Conserved {
            quantities: (now.energy(), now.linear_momentum_global, now.angular_momentum_global),
            balances: (now.energy_balance(), now.linear_balance_global(), now.angular_balance_global()),
            kinetic: now.kinetic_energy,
        });
    }

    pub(super) fn take(&mut self, Conserved { quantities, balances, kinetic }: &Conserved) {
        let start = self.start.get_or_insert(*balances);
        let grow = |largest: &mut f64, value: f64| *largest = largest.max(value.abs());
        grow(&mut self.changes.energy, balances.0 - start.0);
        grow(&mut self.changes.linear_momentum, (balances.1 - start.1).norm());
        grow(&mut self.changes.angular_momentum, (balances.2 - start.2).norm());
        grow(&mut self.scales.of.energy, quantities.0);
        grow(&mut self.scales.of.linear_momentum, quantities.1.norm());
        grow(&mut self.scales.of.angular_momentum, quantities.2.norm());
        grow(&mut self.scales.kinetic, *kinetic);
    }

    /// Takes into account how much energy has come and gone between the rows: they may all fall where there is none.
    pub(super) fn exchanged(&mut self, energy: f64) {
        self.scales.of.energy = self.scales.of.energy.max(energy);
    }

    /// The largest values so far.
    pub(super) fn scales(&self) -> Largest {
        self.scales
    }

    /// Lets the changes of tied bodies, which pass momentum and energy to each other, be relative to the largest values of all of them:
    /// `of` gives the monitor of a body by its number.
    pub(crate) fn widen_together<M>(monitors: &mut [M], bodies: &[usize], of: impl Fn(&mut M) -> &mut Self) {
        let scales = bodies.iter().map(|body| of(&mut monitors[*body]).scales);
        if let Some(scales) = scales.reduce(|most, scales| most.or_larger(&scales)) {
            bodies.iter().for_each(|body| of(&mut monitors[*body]).widen(&scales));
        }
    }

    /// Takes larger values as those that changes are relative to.
    fn widen(&mut self, scales: &Largest) {
        self.scales = self.scales.or_larger(scales);
    }

    /// Takes what a body in joints may have in any case: it may turn about a center of mass that rests, under forces that cancel, so that its
    /// momentum is counted over the one of its `mass` with its largest kinetic energy, and its moment over the one at its `radius` of
    /// gyration; strain pushes nothing. With less than the last energy it rests.
    pub(super) fn in_joints(&mut self, mass: f64, radius: f64, at_rest: f64) {
        let linear_momentum = (2.0 * mass * self.scales.kinetic.max(at_rest)).sqrt();
        let of = Balances { linear_momentum, angular_momentum: radius * linear_momentum, energy: at_rest };
        self.widen(&Largest { of, kinetic: 0.0 });
    }

    /// Largest changes so far, relative to the largest values.
    pub(crate) fn balances(&self) -> Balances {
        let relative = |change: f64, scale: f64| if change > 0.0 { change / scale } else { 0.0 };
        Balances {
            energy: relative(self.changes.energy, self.scales.of.energy),
            linear_momentum: relative(self.changes.linear_momentum, self.scales.of.linear_momentum),
            angular_momentum: relative(self.changes.angular_momentum, self.scales.of.angular_momentum),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a momentum that is 0.01 off, over √(2 · 2 kg · 25 J) = 10 N s of a body whose center of mass rests, whatever its strain.
    #[test]
    fn the_momentum_of_a_body_in_joints_is_not_measured_by_its_strain() {
        for strain in [0.0, 1e6] {
            let mut monitor = Monitor::default();
            for off in [0.0, 0.01] {
                let momentum = Vector3::x() * off;
                let balances = (0.0, momentum, Vector3::zeros());
                monitor.take(&Conserved {
                    quantities: (25.0 + strain, momentum, Vector3::zeros()),
                    balances,
                    kinetic: 25.0,
                });
            }
            monitor.in_joints(2.0, 0.1, 1e-9);
            assert!((monitor.balances().linear_momentum - 1e-3).abs() < 1e-15, "{:?}", monitor.balances());
        }
        // At rest a body is measured by what would be called rest.
        let mut monitor = Monitor::default();
        for off in [0.0, 1e-15] {
            let momentum = Vector3::x() * off;
            let quantities = (3.0, momentum, Vector3::zeros());
            monitor.take(&Conserved { quantities, balances: (0.0, momentum, Vector3::zeros()), kinetic: 1e-30 });
        }
        monitor.in_joints(2.0, 0.1, 1e-12);
        assert!((monitor.balances().linear_momentum - 1e-15 / 2e-6).abs() < 1e-20, "{:?}", monitor.balances());
    }
}
