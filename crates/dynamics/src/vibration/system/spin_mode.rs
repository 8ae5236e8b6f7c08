//! Vibrations in a spin.

use faer::c64;

use crate::vibration::system::error::SteadyError;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::mode::SystemMode;

/// A vibration at a spin speed: `exp((growth + i·circular_frequency) t)`, as the body sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct SpinMode {
    /// rad per time, not negative.
    pub circular_frequency: f64,
    /// Positive where the vibration grows.
    pub growth: f64,
    /// Angular momentum of the vibration about the spin axis: 1 where all points circle forwards, −1 backwards, 0 where
    /// they go to and fro. Zero without Coriolis terms.
    pub whirl: f64,
    /// Its shape: (Λ^½ q, q̇), of unit length (2nf).
    pub state: Vec<c64>,
}

impl Linearization {
    /// The vibrations in a spin at this speed.
    pub(crate) fn spin_modes(&self, speed: f64) -> Result<Vec<SpinMode>, SteadyError> {
        self.all_modes(|mode| self.spin_mode(mode, self.whirl(mode, speed)))
    }

    /// A vibration for each independent coordinate, slowest first.
    pub(crate) fn all_modes(&self, of_mode: impl Fn(&SystemMode) -> SpinMode) -> Result<Vec<SpinMode>, SteadyError> {
        let (mut moving, mut still): (Vec<SystemMode>, Vec<SystemMode>) =
            self.vibrations()?.modes.into_iter().partition(|mode| mode.circular_frequency() > 0.0);
        // Two that do not swing are in the place of one that does.
        still.sort_by(|a, b| b.growth().total_cmp(&a.growth()));
        still.truncate(self.size().saturating_sub(moving.len()));
        still.append(&mut moving);
        let mut modes: Vec<SpinMode> = still.iter().map(of_mode).collect();
        // Those that nothing resists.
        let none = SpinMode { circular_frequency: 0.0, growth: 0.0, whirl: 0.0, state: Vec::new() };
        modes.resize(self.size(), none);
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        Ok(modes)
    }

    /// Im(ηᴴ G η)/(ηᴴη), with the gyroscopic part 2Ω G of C.
    fn whirl(&self, mode: &SystemMode, speed: f64) -> f64 {
        if speed == 0.0 {
            return 0.0;
        }
        let (eta, size) = (&mode.coordinates, self.size());
        let squares: f64 = eta.iter().map(|x| x.norm_sqr()).sum();
        let turned = |i: usize| {
            let of = |j: usize| eta[j] * (0.25 * (self.damping[(i, j)] - self.damping[(j, i)]) / speed);
            (0..size).map(of).sum::<c64>()
        };
        (0..size).map(|i| (eta[i].conj() * turned(i)).im).sum::<f64>() / squares
    }

    pub(crate) fn spin_mode(&self, mode: &SystemMode, whirl: f64) -> SpinMode {
        let mut masses = Vec::with_capacity(mode.motion.len());
        for mass in &self.masses {
            masses.extend((0..mass.nrows()).map(|k| mass[(k, k)].sqrt()));
        }
        let strained = mode.motion.iter().zip(&self.strain).map(|(x, strain)| *x * strain.sqrt());
        let moving = mode.motion.iter().zip(&masses).map(|(x, mass)| mode.eigenvalue * *x * *mass);
        let state: Vec<c64> = strained.chain(moving).collect();
        let length = state.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        SpinMode {
            circular_frequency: mode.circular_frequency(),
            growth: mode.growth(),
            whirl,
            state: state.into_iter().map(|x| x / length).collect(),
        }
    }
}
