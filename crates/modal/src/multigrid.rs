//! Modes and static responses by multigrid cycles, without the factor.

pub(crate) mod coarse;
pub(crate) mod cycle;
pub(crate) mod davidson;
pub(crate) mod levels;
pub(crate) mod make_levels;
pub(crate) mod modes_by_cycles;
pub(crate) mod renumbering;
pub(crate) mod smoother;
pub(crate) mod spatial_order;
#[cfg(test)]
pub(crate) mod tests;
