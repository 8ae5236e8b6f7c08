//! The common spin of bodies in joints: that which is asked for, or that of the drive that turns all of them.

use dynamics::{CommonSpin, SteadyError, SteadyState, SystemMode, SystemMotion};
use nalgebra::Vector3;

use crate::commands::system_modes::{Rotors, SpinningRotor};

/// The spin that equations are about.
pub(super) struct SystemSpin {
    pub omega_global: Vector3<f64>,
    pub steady: SteadyState,
    /// Rotors that spin against the others.
    pub rotors: Vec<SpinningRotor>,
    /// Joints that turn otherwise.
    pub warnings: Vec<String>,
}

impl SystemSpin {
    /// An angular velocity that is asked for is about the axis of the driven joint to the ground where there is one, else through the center of
    /// mass. Without one the bodies spin as that drive does at the time of the motion, if all of them can.
    ///
    /// # Errors
    /// [`SteadyError`]; that a joint does not allow the spin only of one that is asked for.
    pub fn new(motion: &SystemMotion, asked: Option<Vector3<f64>>) -> Result<Self, SteadyError> {
        let driven = of_drives(motion);
        let axis = driven.first().map(|spin| spin.point_global);
        let point_global = axis.unwrap_or_else(|| motion.center_of_mass());
        let at = |spin: &CommonSpin| -> Result<Self, SteadyError> {
            // Joints on the ground turn by the spin.
            let is_on_ground =
                |joint: usize| motion.system().joints()[joint].markers.iter().any(|marker| marker.body().is_none());
            let spins = spin.omega_global.norm() > 0.0;
            let rotors = Rotors::of(motion, |joint| spins && is_on_ground(joint));
            let steady = rotors.steady_state(motion, spin)?;
            let modes = steady.linear.vibrations()?.modes;
            let warnings = rotors.warnings(modes.iter().map(SystemMode::circular_frequency));
            Ok(Self { omega_global: spin.omega_global, steady, rotors: rotors.found, warnings })
        };
        if let Some(omega_global) = asked {
            return at(&CommonSpin { omega_global, point_global });
        }
        let rest = || at(&CommonSpin::REST);
        let turning: Vec<&CommonSpin> = driven.iter().filter(|spin| spin.omega_global.norm() > 0.0).collect();
        let [spin] = turning[..] else { return rest() };
        match at(spin) {
            Err(SteadyError::Against { .. }) => rest(),
            found => found,
        }
    }
}

/// The spins of drives that turn a body against the ground, at the time of the motion.
fn of_drives(motion: &SystemMotion) -> Vec<CommonSpin> {
    let joints = motion.system().joints().iter().enumerate();
    joints
        .filter(|(_, joint)| joint.is_turned_by_drive())
        .filter_map(|(number, joint)| {
            let drive = joint.drive.as_ref()?;
            let time = motion.time();
            let rate = drive.amplitude * drive.history.rate(time, time);
            let [first, second] = joint.markers.each_ref().map(|marker| marker.body());
            // The angle is that of the second marker as the first sees it.
            let speed = match (first, second) {
                (None, Some(_)) => rate,
                (Some(_), None) => -rate,
                _ => return None,
            };
            let (point_global, axis) = motion.joint_axis(number);
            Some(CommonSpin { omega_global: axis * speed, point_global })
        })
        .collect()
}
