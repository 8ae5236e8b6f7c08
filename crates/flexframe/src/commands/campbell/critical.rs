//! Where engine orders and branches cross.

use std::f64::consts::TAU;

use dynamics::{EigenError, SteadySpin};
use serde::Serialize;

use super::branches::Branches;

/// A spin speed at which a load that turns with an order meets a natural frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Critical {
    /// Times a turn; 0 where a natural frequency is zero.
    pub order: f64,
    /// Number of the mode whose branch it is.
    pub mode: usize,
    /// Spin speed, radians per time.
    pub speed: f64,
    /// Frequency, cycles per time.
    pub frequency: f64,
}

/// All crossings within the speeds of the branches, not read off the branches but found as eigenvalues
/// ([`SteadySpin::critical_speeds`]).
pub(super) fn find(spin: &SteadySpin, branches: &Branches, orders: &[f64]) -> Result<Vec<Critical>, EigenError> {
    let (Some(&start), Some(&end)) = (branches.speeds.first(), branches.speeds.last()) else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for &order in std::iter::once(&0.0).chain(orders) {
        for speed in spin.critical_speeds(order)?.into_iter().filter(|speed| (start..=end).contains(speed)) {
            let off = |omega: f64| (omega - order * speed).abs();
            let modes = branches.at(spin, speed)?;
            let nearest = modes
                .iter()
                .enumerate()
                .min_by(|(_, a), (_, b)| off(a.circular_frequency).total_cmp(&off(b.circular_frequency)));
            if let Some((k, _)) = nearest {
                all.push(Critical { order, mode: k + 1, speed, frequency: order * speed / TAU });
            }
        }
    }
    Ok(all)
}
