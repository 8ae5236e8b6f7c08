//! The vibrations of a system in spin, as a Campbell diagram follows them.

use faer::c64;
use nalgebra::Vector3;

use crate::system::radau::SystemMotion;
use crate::vibration::steady_spin::SpinMode;
use crate::vibration::system::configuration::{CommonSpin, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::mode::SystemMode;
use crate::vibration::system::rotor::Rotor;

impl SystemMotion {
    /// A point and the z axis of the first marker of a joint, global.
    pub fn joint_axis(&self, joint: usize) -> (Vector3<f64>, Vector3<f64>) {
        let at = Configuration::of(self, &CommonSpin::REST);
        let markers = &self.system().joints()[joint].markers;
        let [first, _] = at.places(markers);
        (at.global_by(markers, &first.position), first.axes.column(2).into())
    }

    /// The center of mass of all bodies, undeformed, global.
    pub fn center_of_mass(&self) -> Vector3<f64> {
        let at = Configuration::of(self, &CommonSpin::REST);
        let bodies = || self.system().bodies().iter();
        let moment: Vector3<f64> =
            bodies().zip(&at.bodies).map(|(body, of)| at.origin_global(of)[0] * body.mass()).sum();
        moment / bodies().map(crate::ConservativeBody::mass).sum::<f64>()
    }

    /// The vibrations in a common spin about a unit vector through a point, at a speed in rad per time, slowest first: one for each
    /// independent coordinate. The bodies are deformed as the spin asks; rotors spin against what carries them, at a speed each.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn spin_modes(
        &self,
        axis_global: &Vector3<f64>,
        point_global: Vector3<f64>,
        speed: f64,
        rotors: &[(Rotor, f64)],
    ) -> Result<Vec<SpinMode>, SteadyError> {
        let spin = CommonSpin { omega_global: axis_global * speed, point_global };
        let rotors = rotors.iter().map(|(rotor, speed)| (rotor, *speed));
        let linear = self.steady_state_with_rotors(&spin, rotors)?.linear;
        linear.all_modes(|mode| linear.spin_mode(mode, linear.whirl(mode, speed)))
    }
}

impl Linearization {
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
