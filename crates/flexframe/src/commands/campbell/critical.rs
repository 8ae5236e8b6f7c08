//! Where engine orders and branches cross.

use std::f64::consts::TAU;

use dynamics::{EigenError, SpinMode, SteadySpin};
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
            let modes = branches.at(&|speed| spin.modes(speed), speed)?;
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

/// All crossings of branches between their speeds, with the square of each frequency a straight line in that of the speed: so it goes
/// with stiffness that grows with the centrifugal force, and a crossing is off by far less than the step. Order 0 where a vibration
/// stops to swing.
pub(super) fn between(branches: &Branches, orders: &[f64]) -> Vec<Critical> {
    let square = |mode: &SpinMode| mode.circular_frequency.powi(2) - mode.growth.powi(2);
    let mut all = Vec::new();
    for &order in std::iter::once(&0.0).chain(orders) {
        for (i, pair) in branches.speeds.windows(2).enumerate() {
            let [from, to] = [pair[0] * pair[0], pair[1] * pair[1]];
            for k in 0..branches.modes[i].len() {
                let [before, after] =
                    [(i, from), (i + 1, to)].map(|(at, speed)| square(&branches.modes[at][k]) - order * order * speed);
                if (before > 0.0) == (after > 0.0) {
                    continue;
                }
                let speed = (from + (to - from) * before / (before - after)).sqrt();
                all.push(Critical { order, mode: k + 1, speed, frequency: order * speed / TAU });
            }
        }
    }
    all.sort_by(|a, b| (a.order, a.speed).partial_cmp(&(b.order, b.speed)).unwrap_or(std::cmp::Ordering::Equal));
    all
}

/// Halvings of a step between two speeds: a crossing is found to a part of 1e-12 of it.
const HALVINGS: usize = 40;

/// All crossings of branches that `find` continues between the speeds, by halving; order 0 where a vibration stops to swing.
pub(super) fn find_between<E>(
    find: &impl Fn(f64) -> Result<Vec<SpinMode>, E>,
    branches: &Branches,
    orders: &[f64],
) -> Result<Vec<Critical>, E> {
    let mut all = Vec::new();
    for &order in std::iter::once(&0.0).chain(orders) {
        let above = |mode: &SpinMode, speed: f64| mode.circular_frequency > order * speed;
        for (i, pair) in branches.speeds.windows(2).enumerate() {
            for k in 0..branches.modes[i].len() {
                let is_above = above(&branches.modes[i][k], pair[0]);
                if is_above == above(&branches.modes[i + 1][k], pair[1]) {
                    continue;
                }
                let [mut low, mut high] = [pair[0], pair[1]];
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    match above(&branches.at(find, middle)?[k], middle) == is_above {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                let speed = 0.5 * (low + high);
                // At rest order n and a vibration without frequency meet, which is no crossing.
                if speed > 0.0 && low > branches.speeds[0] {
                    all.push(Critical { order, mode: k + 1, speed, frequency: order * speed / TAU });
                }
            }
        }
    }
    all.sort_by(|a, b| (a.order, a.speed).partial_cmp(&(b.order, b.speed)).unwrap_or(std::cmp::Ordering::Equal));
    Ok(all)
}
