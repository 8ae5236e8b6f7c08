//! Modes and static responses by multigrid cycles, without the factor of K + sM. The door is [`Cycles`]; where they do not do,
//! [`NoCycles`] is the reason.

pub(crate) mod coarse;
mod cycle;
mod cycles;
mod davidson;
mod no_cycles;
mod smoother;
pub(crate) mod spatial_order;
#[cfg(test)]
mod tests;

pub(crate) use cycles::{CycledBody, CycledInverse, Cycles, are_faster};
pub use no_cycles::NoCycles;
