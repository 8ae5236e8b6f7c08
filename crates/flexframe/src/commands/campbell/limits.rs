//! Speeds at which a vibration meets an order, begins to grow, or begins to swing: eigenvalues where a family has them as such; else bracketed
//! and followed along the branch, or read off the branch.

use std::f64::consts::TAU;

use diagnostic::Failure;
use dynamics::SpinMode;

use super::branches::{Branches, CLOSER, continued};
use super::critical::{Critical, CriticalKind, SwingLimit};
use super::family::Family;

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
    /// It has the frequency of this order; 0 of a vibration without damping that stops to swing and grows.
    Order(f64),
    Growth,
    Swing,
}

impl Limit {
    /// The number that is zero at the limit. Squares of frequencies go with the stiffness, which grows with the square of the speed.
    fn distance(self, mode: &SpinMode, speed: f64) -> f64 {
        match self {
            Self::Order(0.0) => mode.circular_frequency.powi(2) - mode.growth.powi(2),
            Self::Order(order) => mode.circular_frequency.powi(2) - order * order * (speed * speed),
            Self::Growth => mode.growth,
            Self::Swing => mode.circular_frequency,
        }
    }

    /// The part of the eigenvalue that the limit is about.
    fn part(self, mode: &SpinMode) -> f64 {
        if matches!(self, Self::Growth) { mode.growth } else { mode.circular_frequency }
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
    /// The limits within the speeds of branches.
    pub fn of(family: &dyn Family, branches: &Branches, orders: &[f64]) -> Result<Self, Failure> {
        let mut found = Self::default();
        let mut limits = Vec::new();
        for order in orders.iter().copied().chain([0.0]) {
            match family.resonances(order)? {
                Some(speeds) => found.add_resonances(family, branches, order, &speeds)?,
                None if order == 0.0 && !family.is_slow() => limits.extend([Limit::Growth, Limit::Swing]),
                None => limits.push(Limit::Order(order)),
            }
        }
        if !limits.is_empty() {
            let search = Search { family, branches, limits };
            let each = branches.speeds.iter().zip(&branches.modes);
            let here: Vec<Here> = each.map(|(speed, modes)| Here { speed: *speed, modes: modes.clone() }).collect();
            for pair in here.windows(2) {
                search.step(&pair[0], &pair[1], PARTS, &mut found)?;
            }
        }
        found.critical.sort_by(Critical::by_order_and_speed);
        found.swings.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        Ok(found)
    }
}

struct Search<'a> {
    family: &'a dyn Family,
    branches: &'a Branches,
    limits: Vec<Limit>,
}

impl Search<'_> {
    fn at(&self, speed: f64) -> Result<Here, Failure> {
        Ok(Here { speed, modes: self.branches.at(self.family, speed)? })
    }

    /// Adds the limits between two speeds. Where branches change places in between, each part is looked at by itself.
    fn step(&self, low: &Here, high: &Here, parts: u32, found: &mut Limits) -> Result<(), Failure> {
        let mut here = Limits::default();
        // A motion that nothing resists at rest may have stiffness in spin.
        let off_rest =
            (low.speed == 0.0 && !self.family.is_slow()).then(|| self.at(OFF_REST * high.speed)).transpose()?;
        for (place, limit) in (0..low.modes.len()).flat_map(|k| self.limits.iter().map(move |limit| (k, *limit))) {
            let side = |here: &Here| limit.side(&here.modes[place], here.speed);
            let starts = std::iter::once(low).chain(&off_rest);
            let Some((low, before)) = starts.filter_map(|low| Some((low, side(low)?))).next() else { continue };
            let Some(after) = side(high).filter(|after| *after != before) else { continue };
            if self.family.is_slow() {
                let distances = [low, high].map(|here| limit.distance(&here.modes[place], here.speed));
                here.add(limit, place, on_line([low, high], distances), [low, high], after);
                continue;
            }
            let [below, above] = self.bracket([low, high], place, limit)?;
            let [one, other] = [&below, &above].map(|here| &here.modes[place]);
            let size = |here: &Here| here.modes[place].circular_frequency.hypot(here.modes[place].growth);
            let apart = (limit.part(one) - limit.part(other)).abs();
            if apart > STEADY * size(low).max(size(high)) {
                if parts > 0 {
                    self.step(low, &below, parts - 1, found)?;
                    return self.step(&above, high, parts - 1, found);
                }
                continue;
            }
            here.add(limit, place, 0.5 * (below.speed + above.speed), [&below, &above], after);
        }
        found.critical.append(&mut here.critical);
        found.swings.append(&mut here.swings);
        Ok(())
    }

    /// Makes the step smaller until both sides of a limit are next to each other: by a line between the distances at its ends, of which
    /// the end that stays counts half (the Illinois method), and by halves.
    fn bracket(&self, [low, high]: [&Here; 2], place: usize, limit: Limit) -> Result<[Here; 2], Failure> {
        let side = |here: &Here| limit.side(&here.modes[place], here.speed);
        let distance = |here: &Here| limit.is_smooth().then(|| limit.distance(&here.modes[place], here.speed));
        let before = side(low);
        let mut distances = distance(low).zip(distance(high)).map(<[f64; 2]>::from);
        let [mut low, mut high] = [low.clone(), high.clone()];
        for trial in 0..TRIALS {
            let line = distances.filter(|_| trial % (ON_A_LINE + 1) < ON_A_LINE).map(|it| on_line([&low, &high], it));
            let inside = line.filter(|speed| *speed > low.speed && *speed < high.speed);
            let speed = inside.unwrap_or(0.5 * (low.speed + high.speed));
            // Shapes next to each other are alike, so that a branch is followed from there by few steps; the nearer, the fewer.
            let closer = CLOSER.saturating_sub(trial / (ON_A_LINE + 1));
            let middle = Here { speed, modes: continued(self.family, &high.modes, high.speed, speed, closer)? };
            let met = 2.0 * MET * middle.modes[place].circular_frequency.powi(2);
            if distance(&middle).is_some_and(|distance| distance.abs() <= met) {
                return Ok([middle.clone(), middle]);
            }
            let is_before = side(&middle) == before;
            if let (Some([from, to]), Some(here)) = (&mut distances, distance(&middle)) {
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

/// The speed at which a distance is zero that is a straight line in the square of the speed.
fn on_line([low, high]: [&Here; 2], [before, after]: [f64; 2]) -> f64 {
    let [from, to] = [low, high].map(|here| here.speed * here.speed);
    (from + (to - from) * before / (before - after)).sqrt()
}

impl Limits {
    /// Speeds at which a frequency is `order` times the speed, each of the branch whose frequency is the nearest there.
    fn add_resonances(
        &mut self,
        family: &dyn Family,
        branches: &Branches,
        order: f64,
        speeds: &[f64],
    ) -> Result<(), Failure> {
        let (Some(&start), Some(&end)) = (branches.speeds.first(), branches.speeds.last()) else { return Ok(()) };
        for &speed in speeds.iter().filter(|speed| (start..=end).contains(speed)) {
            let modes = branches.at(family, speed)?;
            let off = |place: usize| (modes[place].circular_frequency - order * speed).abs();
            if let Some(place) = (0..modes.len()).min_by(|a, b| off(*a).total_cmp(&off(*b))) {
                self.add_order(order, place, speed);
            }
        }
        Ok(())
    }

    fn add_order(&mut self, order: f64, place: usize, speed: f64) {
        let kind = if order == 0.0 { CriticalKind::ZeroFrequency } else { CriticalKind::Crossing };
        self.critical.push(Critical { kind, order, mode: place + 1, speed, frequency: order * speed / TAU });
    }

    fn add(&mut self, limit: Limit, place: usize, speed: f64, [below, above]: [&Here; 2], after: bool) {
        let mode = place + 1;
        match limit {
            Limit::Order(order) => self.add_order(order, place, speed),
            Limit::Growth => {
                let (kind, stable) =
                    if after { (CriticalKind::GrowthBegins, below) } else { (CriticalKind::GrowthEnds, above) };
                let frequency = stable.modes[place].circular_frequency / TAU;
                self.critical.push(Critical { kind, order: 0.0, mode, speed, frequency });
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
