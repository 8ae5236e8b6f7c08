//! Numbers that a program sets while a run stands between two steps.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A function of time that a program outside sets while the run stands between two steps: `value + rate (t − since)`.
///
/// Copies are the same signal. After it has been set, [`Simulation::loads_have_changed`](crate::Simulation::loads_have_changed)
/// has to be told. A checkpoint does not hold it: who sets it keeps it.
#[derive(Debug, Clone)]
pub struct Signal(Arc<[AtomicU64; 3]>);

impl Signal {
    /// A signal with this value, held.
    pub fn held(value: f64) -> Self {
        Self(Arc::new([value, 0.0, 0.0].map(|number| AtomicU64::new(number.to_bits()))))
    }

    /// Holds this value from now on.
    pub fn hold(&self, value: f64) {
        self.set([value, 0.0, 0.0]);
    }

    /// From a time on goes on from this value at this rate.
    pub fn ramp(&self, since: f64, value: f64, rate: f64) {
        self.set([value, rate, since]);
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        let [value, rate, since] = self.numbers();
        value + rate * (time - since)
    }

    /// Its rate.
    pub fn rate(&self) -> f64 {
        self.numbers()[1]
    }

    /// Value, rate, and since when: what [`Self::set`] takes.
    pub fn numbers(&self) -> [f64; 3] {
        // Whoever sets it does so between steps, so that no order among the words is needed.
        std::array::from_fn(|i| f64::from_bits(self.0[i].load(Ordering::Relaxed)))
    }

    /// Sets value, rate, and since when.
    pub fn set(&self, numbers: [f64; 3]) {
        for (word, number) in self.0.iter().zip(numbers) {
            word.store(number.to_bits(), Ordering::Relaxed);
        }
    }
}
