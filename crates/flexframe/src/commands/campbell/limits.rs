//! Speeds at which a vibration of a system meets an order, begins to grow, or begins to swing: bracketed, and followed along its branch.

use std::f64::consts::TAU;

use dynamics::SpinMode;

use super::branches::{Branches, CLOSER, continued};
use super::critical::{Critical, CriticalKind, SwingLimit};

/// Trials between two speeds. If all halve the step, a limit is found to a part of 1e-12 of it.
const TRIALS: u32 = 40;
/// Trials on a line between the ends of the step before one at its middle.
const ON_A_LINE: u32 = 2;
/// Part of its frequency to which a vibration meets an order.
const MET: f64 = 1e-12;
/// Part of the first step from rest at which a motion is looked at that nothing resists at rest.
const OFF_REST: f64 = 1e-3;
/// Part of the eigenvalue, as it is at the ends of the step, by which it may change over the last of the halvings: more is a branch that has taken the place of another one.
const STEADY: f64 = 1e-3;
/// How often a step is parted where branches change places.
const PARTS: u32 = 3;

/// The limits that a vibration may pass.
#[derive(Debug, Clone, Copy)]
enum Limit {
    /// It has the frequency of this order.
    Order(f64),
    Growth,
    Swing,
}

impl Limit {
    /// The number that is zero at the limit.
    fn distance(self, mode: &SpinMode, speed: f64) -> f64 {
        match self {
            Self::Order(order) => mode.circular_frequency - order * speed,
            Self::Growth => mode.growth,
            Self::Swing => mode.circular_frequency,
        }
    }

    /// True if that number is smooth there: others are zero on one side, and like a root on the other.
    fn is_smooth(self) -> bool {
        matches!(self, Self::Order(_))
    }

    /// The side of a vibration at a speed; `None` for a motion that nothing resists, which has none.
    fn side(self, mode: &SpinMode, speed: f64) -> Option<bool> {
        let resists = mode.circular_frequency != 0.0 || mode.growth != 0.0;
        resists.then(|| self.distance(mode, speed) > 0.0)
    }
}

/// All vibrations at a speed, at the places of their branches.
#[derive(Clone)]
struct Here {
    speed: f64,
    modes: Vec<SpinMode>,
}

/// The limits that were found.
#[derive(Default)]
pub(super) struct Limits {
    /// By order and speed.
    pub critical: Vec<Critical>,
    /// By speed.
    pub swings: Vec<SwingLimit>,
}

impl Limits {
    /// The limits between the speeds of branches, which `find` continues.
    pub fn between<E>(
        find: &impl Fn(f64) -> Result<Vec<SpinMode>, E>,
        branches: &Branches,
        orders: &[f64],
    ) -> Result<Self, E> {
        let all = orders.iter().map(|order| Limit::Order(*order)).chain([Limit::Growth, Limit::Swing]).collect();
        let search = Search { find, branches, limits: all };
        let mut found = Self::default();
        let here: Vec<Here> = branches
            .speeds
            .iter()
            .zip(&branches.modes)
            .map(|(speed, modes)| Here { speed: *speed, modes: modes.clone() })
            .collect();
        for pair in here.windows(2) {
            search.step(&pair[0], &pair[1], PARTS, &mut found)?;
        }
        found.critical.sort_by(Critical::by_order_and_speed);
        found.swings.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        Ok(found)
    }
}

struct Search<'a, F> {
    find: &'a F,
    branches: &'a Branches,
    limits: Vec<Limit>,
}

impl<E, F: Fn(f64) -> Result<Vec<SpinMode>, E>> Search<'_, F> {
    fn at(&self, speed: f64) -> Result<Here, E> {
        Ok(Here { speed, modes: self.branches.at(self.find, speed)? })
    }

    /// Adds the limits between two speeds. Where branches change places in between, each part is looked at by itself.
    fn step(&self, low: &Here, high: &Here, parts: u32, found: &mut Limits) -> Result<(), E> {
        let mut here = Limits::default();
        // A motion that nothing resists at rest may have stiffness in spin.
        let off_rest = (low.speed == 0.0).then(|| self.at(OFF_REST * high.speed)).transpose()?;
        for (place, limit) in (0..low.modes.len()).flat_map(|k| self.limits.iter().map(move |limit| (k, *limit))) {
            let side = |here: &Here| limit.side(&here.modes[place], here.speed);
            let starts = std::iter::once(low).chain(&off_rest);
            let Some((low, before)) = starts.filter_map(|low| Some((low, side(low)?))).next() else { continue };
            let Some(after) = side(high).filter(|after| *after != before) else { continue };
            let [below, above] = self.bracket([low, high], place, limit)?;
            let [one, other] = [&below, &above].map(|here| &here.modes[place]);
            let size = |here: &Here| here.modes[place].circular_frequency.hypot(here.modes[place].growth);
            let apart = (limit.distance(one, 0.0) - limit.distance(other, 0.0)).abs();
            if apart > STEADY * size(low).max(size(high)) {
                if parts > 0 {
                    self.step(low, &below, parts - 1, found)?;
                    return self.step(&above, high, parts - 1, found);
                }
                continue;
            }
            here.add(limit, place, [&below, &above], after);
        }
        found.critical.append(&mut here.critical);
        found.swings.append(&mut here.swings);
        Ok(())
    }

    /// Makes the step smaller until both sides of a limit are next to each other: by a line between the distances at its ends, of which
    /// the end that stays counts half (the Illinois method), and by halves.
    fn bracket(&self, [low, high]: [&Here; 2], place: usize, limit: Limit) -> Result<[Here; 2], E> {
        let side = |here: &Here| limit.side(&here.modes[place], here.speed);
        let distance = |here: &Here| limit.is_smooth().then(|| limit.distance(&here.modes[place], here.speed));
        let before = side(low);
        let mut distances = distance(low).zip(distance(high));
        let [mut low, mut high] = [low.clone(), high.clone()];
        for trial in 0..TRIALS {
            let on_line =
                distances.filter(|_| trial % (ON_A_LINE + 1) < ON_A_LINE).map(|(from, to)| from / (from - to));
            let share = on_line.filter(|share| *share > 0.0 && *share < 1.0).unwrap_or(0.5);
            let speed = low.speed + share * (high.speed - low.speed);
            // Shapes next to each other are alike, so that a branch is followed from there by few steps; the nearer, the fewer.
            let closer = CLOSER.saturating_sub(trial / (ON_A_LINE + 1));
            let middle = Here { speed, modes: continued(self.find, &high.modes, high.speed, speed, closer)? };
            if distance(&middle).is_some_and(|distance| distance.abs() <= MET * middle.modes[place].circular_frequency)
            {
                return Ok([middle.clone(), middle]);
            }
            let is_before = side(&middle) == before;
            if let (Some((from, to)), Some(here)) = (&mut distances, distance(&middle)) {
                if is_before {
                    (*from, *to) = (here, 0.5 * *to);
                } else {
                    (*from, *to) = (0.5 * *from, here);
                }
            }
            if is_before { low = middle } else { high = middle }
        }
        Ok([low, high])
    }
}

impl Limits {
    fn add(&mut self, limit: Limit, place: usize, [below, above]: [&Here; 2], after: bool) {
        let speed = 0.5 * (below.speed + above.speed);
        let mode = place + 1;
        let critical = |kind, order, frequency| Critical { kind, order, mode, speed, frequency };
        match limit {
            Limit::Order(order) => {
                self.critical.push(critical(CriticalKind::Crossing, order, order * speed / TAU));
            }
            Limit::Growth => {
                let (kind, stable) =
                    if after { (CriticalKind::GrowthBegins, below) } else { (CriticalKind::GrowthEnds, above) };
                self.critical.push(critical(kind, 0.0, stable.modes[place].circular_frequency / TAU));
            }
            Limit::Swing => {
                let still = if after { below } else { above };
                // A vibration that stops to swing and grows is unstable, which is told as that.
                if still.modes[place].growth < 0.0 {
                    self.swings.push(SwingLimit { mode, speed, swings_above: after });
                }
            }
        }
    }
}
