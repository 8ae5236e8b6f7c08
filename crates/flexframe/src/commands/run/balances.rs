//! How well what exact motion conserves is conserved.

use dynamics::Observation;
use nalgebra::Vector3;
use serde::Serialize;

use crate::files::json;

/// Largest changes, over the rows, of what should be constants of the motion, relative to the largest value of the
/// quantity itself; of the energy, or to what has come and gone by work and dissipation, if that is more; of the linear momentum of a
/// body in joints, or to that which its mass has with its largest energy, if that is more.
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
}

/// Watches the constants of the motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Monitor {
    start: Option<Momenta>,
    changes: Balances,
    scales: Balances,
}

impl Monitor {
    /// Takes one more observation into account.
    pub(crate) fn watch(&mut self, now: &Observation) {
        self.take(&Conserved {
            quantities: (now.energy(), now.linear_momentum_global, now.angular_momentum_global),
            balances: (now.energy_balance(), now.linear_balance_global(), now.angular_balance_global()),
        });
    }

    pub(super) fn take(&mut self, Conserved { quantities, balances }: &Conserved) {
        let start = self.start.get_or_insert(*balances);
        let grow = |largest: &mut f64, value: f64| *largest = largest.max(value.abs());
        grow(&mut self.changes.energy, balances.0 - start.0);
        grow(&mut self.changes.linear_momentum, (balances.1 - start.1).norm());
        grow(&mut self.changes.angular_momentum, (balances.2 - start.2).norm());
        grow(&mut self.scales.energy, quantities.0);
        grow(&mut self.scales.linear_momentum, quantities.1.norm());
        grow(&mut self.scales.angular_momentum, quantities.2.norm());
    }

    /// Takes into account how much energy has come and gone between the rows: they may all fall where there is none.
    pub(super) fn exchanged(&mut self, energy: f64) {
        self.scales.energy = self.scales.energy.max(energy);
    }

    /// The largest values so far.
    pub(crate) fn scales(&self) -> Balances {
        self.scales
    }

    /// Takes larger values as those that changes are relative to: of bodies that pass momentum and energy to each other, those of
    /// all of them.
    pub(crate) fn widen(&mut self, scales: &Balances) {
        self.scales = self.scales.or_larger(scales);
    }

    /// Largest changes so far, relative to the largest values.
    pub(crate) fn balances(&self) -> Balances {
        let relative = |change: f64, scale: f64| if change > 0.0 { change / scale } else { 0.0 };
        Balances {
            energy: relative(self.changes.energy, self.scales.energy),
            linear_momentum: relative(self.changes.linear_momentum, self.scales.linear_momentum),
            angular_momentum: relative(self.changes.angular_momentum, self.scales.angular_momentum),
        }
    }
}
