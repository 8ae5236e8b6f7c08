//! The common spin of bodies in joints: that which is asked for, or that of the drive that turns all of them.

use dynamics::{CommonSpin, SteadyError, SteadyState, SystemMotion};
use nalgebra::Vector3;

/// The spin that equations are about.
pub(super) struct SystemSpin {
    pub omega_global: Vector3<f64>,
    pub steady: SteadyState,
    /// A drive that turns, but not all bodies together.
    pub warning: Option<String>,
}

impl SystemSpin {
    /// An angular velocity that is asked for is about the axis of the driven joint to the ground where there is one, else through the center of
    /// mass. Without one the bodies spin as that drive does at the time of the motion, if all of them can.
    ///
    /// # Errors
    /// [`SteadyError`]; that a joint does not allow the spin only of one that is asked for.
    pub fn new(motion: &SystemMotion, asked: Option<Vector3<f64>>) -> Result<Self, SteadyError> {
        let driven = of_drives(motion);
        let axis = driven.first().map(|(_, spin)| spin.point_global);
        let point_global = axis.unwrap_or_else(|| motion.center_of_mass());
        let at = |omega_global, warning| -> Result<Self, SteadyError> {
            let steady = motion.steady_state(&CommonSpin { omega_global, point_global })?;
            Ok(Self { omega_global, steady, warning })
        };
        if let Some(omega_global) = asked {
            return at(omega_global, None);
        }
        let rest = |warning| at(Vector3::zeros(), warning);
        let turning: Vec<&(String, CommonSpin)> =
            driven.iter().filter(|(_, spin)| spin.omega_global.norm() > 0.0).collect();
        let [(name, spin)] = turning[..] else {
            let warning = (!turning.is_empty()).then(|| "several drives turn; the equations are about rest".to_owned());
            return rest(warning);
        };
        match motion.steady_state(spin) {
            Ok(steady) => Ok(Self { omega_global: spin.omega_global, steady, warning: None }),
            Err(SteadyError::Against { joint, .. }) => {
                let warning = format!(
                    "the drive of {name} turns, but joint {joint} keeps bodies from turning with it; the equations are about rest"
                );
                rest(Some(warning))
            }
            Err(error) => Err(error),
        }
    }
}

/// The spins of drives that turn a body against the ground, by joint, at the time of the motion.
fn of_drives(motion: &SystemMotion) -> Vec<(String, CommonSpin)> {
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
            Some((joint.name.clone(), CommonSpin { omega_global: axis * speed, point_global }))
        })
        .collect()
}
