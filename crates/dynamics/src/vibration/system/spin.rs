//! The vibrations of a system in spin, as a Campbell diagram follows them.

use nalgebra::Vector3;

use crate::system::radau::SystemMotion;
use crate::vibration::system::configuration::{CommonSpin, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::rotor::Rotor;
use crate::vibration::system::spin_mode::SpinMode;

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
        self.steady_state_with_rotors(&spin, rotors)?.linear.spin_modes(speed)
    }
}
