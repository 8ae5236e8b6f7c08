//! Vibrations followed from speed to speed by their shapes.

use std::f64::consts::TAU;

use diagnostic::Failure;
use dynamics::SpinMode;
use results::kind::{NATURAL_MODE, STATIC_SHAPE};
use serde::Serialize;

use super::family::Family;

/// |⟨a, b⟩|² of two shapes that are taken for the same without a closer look. Above ½ only one can be.
const ALIKE: f64 = 0.6;
/// How often a step between two speeds is halved where shapes change too much to be told apart.
pub(super) const CLOSER: u32 = 5;
/// Frequencies and growths closer than this part of them are equal: their shapes are any mixture, at each speed another one.
const EQUAL: f64 = 1e-9;

/// A vibration followed through all spin speeds by its shape.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Branch {
    /// Its number as `flexframe modes` counts, at the lowest speed.
    pub mode: usize,
    /// "natural mode", or "static shape": its frequency is no natural one.
    pub kind: &'static str,
    /// Frequency at each speed, cycles per time.
    pub frequency: Vec<f64>,
    /// Growth at each speed, 1 per time: positive where the vibration is unstable.
    pub growth: Vec<f64>,
    /// Sense of the vibration at each speed: 1 forwards round the axis, −1 backwards, 0 to and fro.
    pub whirl: Vec<f64>,
}

impl Branch {
    /// Label in a table or a picture.
    pub(super) fn label(&self) -> String {
        match self.kind {
            STATIC_SHAPE => format!("static {}", self.mode),
            _ => format!("mode {}", self.mode),
        }
    }
}

/// The vibrations at each speed, each always at the same place of the list.
pub(super) struct Branches {
    /// Rising, radians per time.
    pub speeds: Vec<f64>,
    pub modes: Vec<Vec<SpinMode>>,
}

impl Branches {
    /// Follows all vibrations down from the highest speed: at rest a symmetric body has equal frequencies, whose shapes
    /// are any mixture. The places are in the order of the frequencies at the lowest speed.
    pub fn follow(family: &dyn Family, speeds: Vec<f64>, mut done: impl FnMut(usize)) -> Result<Self, Failure> {
        let mut modes: Vec<Vec<SpinMode>> = Vec::with_capacity(speeds.len());
        for (i, &speed) in speeds.iter().enumerate().rev() {
            let here = match modes.last() {
                Some(above) => continued(family, above, speeds[i + 1], speed, CLOSER)?,
                None => family.vibrations(speed)?,
            };
            modes.push(here);
            done(modes.len());
        }
        modes.reverse();
        let mut order: Vec<usize> = (0..modes[0].len()).collect();
        // What is stiff and damped so much that it does not swing comes behind what swings.
        let fast = |k: usize| modes[0][k].circular_frequency.hypot(modes[0][k].growth);
        order.sort_by(|&a, &b| fast(a).total_cmp(&fast(b)));
        let modes = modes.into_iter().map(|here| order.iter().map(|&k| here[k].clone()).collect()).collect();
        Ok(Self { speeds, modes })
    }

    /// The vibrations at a speed between the others, at the same places.
    pub fn at(&self, family: &dyn Family, speed: f64) -> Result<Vec<SpinMode>, Failure> {
        let above = self.speeds.partition_point(|s| *s < speed).min(self.speeds.len() - 1);
        continued(family, &self.modes[above], self.speeds[above], speed, CLOSER)
    }

    /// The lines of the diagram; the last ones are those of static shapes, which are stiff.
    pub fn lines(&self, static_shapes: usize) -> Vec<Branch> {
        let natural = self.modes[0].len().saturating_sub(static_shapes);
        let of = |k: usize, value: fn(&SpinMode) -> f64| self.modes.iter().map(|here| value(&here[k])).collect();
        (0..self.modes[0].len())
            .map(|k| Branch {
                mode: k + 1,
                kind: if k < natural { NATURAL_MODE } else { STATIC_SHAPE },
                frequency: of(k, |mode| mode.circular_frequency / TAU),
                growth: of(k, |mode| mode.growth),
                whirl: of(k, |mode| mode.whirl),
            })
            .collect()
    }
}

/// The vibrations at the speed `to`, each at the place of the one at the speed `from` that it continues.
pub(super) fn continued(
    family: &dyn Family,
    modes: &[SpinMode],
    from: f64,
    to: f64,
    halvings: u32,
) -> Result<Vec<SpinMode>, Failure> {
    let (matched, least_alike) = matched(modes, family.vibrations(to)?);
    if least_alike >= ALIKE || halvings == 0 || from == to {
        return Ok(matched);
    }
    let middle = 0.5 * (from + to);
    let halfway = continued(family, modes, from, middle, halvings - 1)?;
    continued(family, &halfway, middle, to, halvings - 1)
}

/// Sorts the vibrations `next` to those of `modes` that they are most alike, and says how alike the worst pair is. Of several with equal
/// frequencies, all shapes together count.
fn matched(modes: &[SpinMode], next: Vec<SpinMode>) -> (Vec<SpinMode>, f64) {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(modes.len() * next.len());
    for (i, a) in modes.iter().enumerate() {
        pairs.extend(next.iter().enumerate().map(|(j, b)| (alike(a, b), i, j)));
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut places = vec![None; modes.len()];
    let mut taken = vec![false; next.len()];
    let mut least_alike: f64 = 1.0;
    for (alike, i, j) in pairs {
        if places[i].is_none() && !taken[j] {
            (places[i], taken[j]) = (Some(j), true);
            let mixed = next.iter().filter(|of| are_equal(of, &next[j])).map(|of| self::alike(&modes[i], of)).sum();
            least_alike = alike.max(mixed).min(least_alike);
        }
    }
    (places.into_iter().flatten().map(|j| next[j].clone()).collect(), least_alike)
}

fn are_equal(a: &SpinMode, b: &SpinMode) -> bool {
    let apart = (a.circular_frequency - b.circular_frequency).hypot(a.growth - b.growth);
    apart <= EQUAL * a.circular_frequency.hypot(a.growth)
}

/// |⟨a, b⟩|²: 1 for the same shape, whatever its phase. Rigid motions, which have no energy, are all the same.
fn alike(a: &SpinMode, b: &SpinMode) -> f64 {
    let is_rigid = |of: &SpinMode| of.circular_frequency == 0.0 && of.growth == 0.0;
    if is_rigid(a) || is_rigid(b) {
        return f64::from(u8::from(is_rigid(a) && is_rigid(b)));
    }
    let (re, im) = a.state.iter().zip(&b.state).fold((0.0, 0.0), |(re, im), (x, y)| {
        let product = x.conj() * y;
        (re + product.re, im + product.im)
    });
    re * re + im * im
}
