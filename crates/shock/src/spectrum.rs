//! Shock response spectra.

use std::f64::consts::TAU;

use rayon::prelude::*;

use crate::base_motion::{BaseMotion, Piece};
use crate::error::ShockError;
use crate::extremes::Extremes;
use crate::oscillator::{Oscillator, Step, Swing};

/// Steps in a period: the extremes between them are then good to 3e-7 of the largest value.
const STEPS: f64 = 64.0;
/// Least steps in a cubic between two rows, each of which is straight.
const OF_CUBIC: f64 = 32.0;
/// Most cycles of an oscillator in a base motion.
const MAX_CYCLES: f64 = 1e6;

/// Peaks of an oscillator during a base motion and in the free vibration after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peaks {
    /// Largest magnitude of the displacement relative to the base.
    pub displacement: f64,
    /// Largest acceleration of the mass; zero where it is never positive.
    pub acceleration_largest: f64,
    /// Least acceleration of the mass; zero where it is never negative.
    pub acceleration_least: f64,
}

impl Peaks {
    /// Largest magnitude of the acceleration of the mass.
    pub fn acceleration(&self) -> f64 {
        self.acceleration_largest.max(-self.acceleration_least)
    }
}

/// An oscillator beside the base that it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Following {
    /// Its peaks.
    pub peaks: Peaks,
    /// Correlation α of the acceleration of the mass with that of the base during the motion, from 0 to 1.
    pub correlation: f64,
    /// The part β of the base motion that is in that of the mass, from 0 to 1.
    pub part: f64,
    /// Peaks of the rest: of z + β a/ω² and w − β a.
    pub rest: Peaks,
}

/// The peaks of oscillators of one damping ratio against their frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// Undamped frequencies, cycles per time, rising.
    pub frequencies: Vec<f64>,
    /// Peaks at each frequency.
    pub peaks: Vec<Peaks>,
}

impl BaseMotion {
    /// The peaks of one oscillator. Its frequency is in cycles per time.
    ///
    /// # Errors
    /// [`ShockError::Value`], [`ShockError::Cycles`].
    pub fn peaks(&self, frequency: f64, damping_ratio: f64) -> Result<Peaks, ShockError> {
        let mut watch = Watch::new(self.oscillator(frequency, damping_ratio)?, 0.0);
        self.lead(&mut watch);
        Ok(watch.peaks())
    }

    /// How an oscillator follows the base motion, Eq. (R8).
    ///
    /// # Errors
    /// As [`Self::peaks`].
    pub fn following(&self, frequency: f64, damping_ratio: f64) -> Result<Following, ShockError> {
        let oscillator = self.oscillator(frequency, damping_ratio)?;
        let mut first = Watch::new(oscillator, 0.0);
        self.lead(&mut first);
        let [along, of_mass, of_base] = first.work;
        let ratio = |of: f64| if of > 0.0 { (along / of).clamp(0.0, 1.0) } else { 0.0 };
        let (part, correlation) = (ratio(of_base), ratio((of_mass * of_base).sqrt()));
        let mut watch = Watch::new(oscillator, part);
        self.lead(&mut watch);
        Ok(Following { peaks: first.peaks(), correlation, part, rest: watch.peaks() })
    }

    /// The oscillator of a frequency, cycles per time.
    fn oscillator(&self, frequency: f64, damping_ratio: f64) -> Result<Oscillator, ShockError> {
        if !(frequency.is_finite() && frequency > 0.0) {
            let expected = "a positive number of cycles per time";
            return Err(ShockError::Value { what: "a frequency", found: frequency, expected });
        }
        if !(damping_ratio >= 0.0 && damping_ratio.is_finite()) {
            let expected = "0 or more";
            return Err(ShockError::Value { what: "the damping ratio", found: damping_ratio, expected });
        }
        let oscillator = Oscillator { omega: TAU * frequency, zeta: damping_ratio };
        let cycles = oscillator.fastest() / TAU * self.duration();
        if cycles > MAX_CYCLES {
            return Err(ShockError::Cycles { frequency, cycles, most: MAX_CYCLES });
        }
        Ok(oscillator)
    }

    /// Leads an oscillator through the motion and a period after it.
    fn lead(&self, watch: &mut Watch) {
        for piece in self.pieces() {
            watch.pass(piece);
        }
        // Free: an extreme of each sign comes within a period.
        let work = watch.work;
        watch.pass(Piece { duration: watch.oscillator.period(), ends: [0.0; 2], slopes: None });
        watch.work = work;
    }

    /// The spectrum at rising frequencies, cycles per time.
    ///
    /// # Errors
    /// As [`Self::peaks`]; [`ShockError::Row`] for frequencies that do not rise.
    pub fn spectrum(&self, frequencies: &[f64], damping_ratio: f64) -> Result<Spectrum, ShockError> {
        if let Some(k) = (1..frequencies.len()).find(|k| frequencies[*k] <= frequencies[k - 1]) {
            let expected = "more than in the row before";
            return Err(ShockError::Row { what: "the frequency", row: k + 1, found: frequencies[k], expected });
        }
        let peaks = frequencies.par_iter().map(|frequency| self.peaks(*frequency, damping_ratio));
        let peaks = peaks.collect::<Result<_, _>>()?;
        Ok(Spectrum { damping_ratio, frequencies: frequencies.to_vec(), peaks })
    }
}

impl Spectrum {
    /// The displacement at a frequency: between two of the spectrum straight in logarithms.
    ///
    /// # Errors
    /// [`ShockError::NotCovered`].
    pub fn displacement_at(&self, frequency: f64) -> Result<f64, ShockError> {
        let list = &self.frequencies;
        let [from, to] = [list.first(), list.last()].map(|f| f.copied().unwrap_or(f64::NAN));
        if !(from <= frequency && frequency <= to) {
            return Err(ShockError::NotCovered { frequency, from, to });
        }
        let above = list.partition_point(|f| *f < frequency);
        let here = self.peaks[above].displacement;
        if list[above] == frequency {
            return Ok(here);
        }
        let before = self.peaks[above - 1].displacement;
        let part = (frequency / list[above - 1]).ln() / (list[above] / list[above - 1]).ln();
        // Without a logarithm of zero.
        let is_positive = before > 0.0 && here > 0.0;
        Ok(if is_positive { before * (here / before).powf(part) } else { before + part * (here - before) })
    }
}

/// An oscillator on its way, with its extremes.
struct Watch {
    oscillator: Oscillator,
    /// β, what is not looked at.
    part: f64,
    swing: Swing,
    displacement: Extremes,
    acceleration: Extremes,
    /// ∫ w a dt, ∫ w² dt and ∫ a² dt during the motion.
    work: [f64; 3],
    /// The last step and its length: tables mostly have equal ones.
    step: Option<(f64, Step)>,
}

impl Watch {
    fn new(oscillator: Oscillator, part: f64) -> Self {
        let [displacement, acceleration] = [Extremes::default(); 2];
        let (swing, work) = (Swing::default(), [0.0; 3]);
        Self { oscillator, part, swing, displacement, acceleration, work, step: None }
    }

    fn peaks(&self) -> Peaks {
        Peaks {
            displacement: self.displacement.magnitude(),
            acceleration_largest: self.acceleration.largest,
            acceleration_least: self.acceleration.least,
        }
    }

    /// A piece of the base motion.
    fn pass(&mut self, piece: Piece) {
        let duration = piece.duration;
        let least = if piece.slopes.is_some() { OF_CUBIC } else { 1.0 };
        let count = (duration * self.oscillator.fastest() / TAU * STEPS).ceil().max(least);
        let h = duration / count;
        let step = match self.step {
            Some((length, step)) if length == h => step,
            _ => self.oscillator.step(h),
        };
        self.step = Some((h, step));
        let at = |k: f64| piece.at(k / count);
        for k in 0..count as usize {
            let base = [at(k as f64), at((k + 1) as f64)];
            let before = self.swing;
            let after = step.after(before, base);
            let follows = [base[0], base[1]].map(|base| self.part * base);
            let (slope, stiffness) = ((follows[1] - follows[0]) / h, self.oscillator.omega.powi(2));
            let ends = [(before, 0), (after, 1)];
            let displacements = ends.map(|(swing, i)| [swing.z + follows[i] / stiffness, swing.v + slope / stiffness]);
            self.displacement.see_step(h, displacements);
            let accelerations = ends.map(|(swing, i)| self.oscillator.mass_acceleration(swing, base[i]));
            let beside = |i: usize| [accelerations[i][0] - follows[i], accelerations[i][1] - slope];
            self.acceleration.see_step(h, [beside(0), beside(1)]);
            for i in [0, 1] {
                let [w, a] = [accelerations[i][0], base[i]];
                for (sum, product) in self.work.iter_mut().zip([w * a, w * w, a * a]) {
                    *sum += 0.5 * h * product;
                }
            }
            self.swing = after;
        }
    }
}
