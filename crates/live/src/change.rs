//! Changes in a run while it goes.

use std::sync::Arc;

use dynamics::nalgebra::Vector3;
use dynamics::{
    Bushing, DescribedBody, ForceElement, Joint, JointForce, PointSpring, RunDescription, ScaledLoad, Signal,
};

use crate::error::LiveError;

/// A number of the run that may be changed. Factors are 1 in the recorded run, what is added is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Factor on a load.
    Load {
        /// Number of the body on the page.
        body: usize,
        /// Number of the load.
        load: usize,
    },
    /// Damping ratio that is added to that of each mode.
    Damping {
        /// Number of the body on the page.
        body: usize,
    },
    /// Factor on the speed of a drive.
    Drive {
        /// Number of the body on the page.
        body: usize,
    },
    /// Factor on the stiffness of a joint.
    JointStiffness {
        /// Number of the motion.
        motion: usize,
        /// Number of the joint in it.
        joint: usize,
    },
    /// Factor on the damping and the friction of a joint.
    JointDamping {
        /// Number of the motion.
        motion: usize,
        /// Number of the joint in it.
        joint: usize,
    },
    /// Factor on the motors of a joint.
    JointMotor {
        /// Number of the motion.
        motion: usize,
        /// Number of the joint in it.
        joint: usize,
    },
    /// Factor on the stiffness and the damping of a spring or a bushing.
    Element {
        /// Number of the motion.
        motion: usize,
        /// Number of the element in it.
        element: usize,
    },
}

impl Change {
    /// By the number of its kind, in the order above, and the two numbers that it has.
    pub fn by_number(kind: u32, of: usize, item: usize) -> Option<Self> {
        Some(match kind {
            0 => Self::Load { body: of, load: item },
            1 => Self::Damping { body: of },
            2 => Self::Drive { body: of },
            3 => Self::JointStiffness { motion: of, joint: item },
            4 => Self::JointDamping { motion: of, joint: item },
            5 => Self::JointMotor { motion: of, joint: item },
            6 => Self::Element { motion: of, element: item },
            _ => return None,
        })
    }

    /// The numbers of [`Self::by_number`].
    pub fn numbers(self) -> [usize; 3] {
        match self {
            Self::Load { body, load } => [0, body, load],
            Self::Damping { body } => [1, body, 0],
            Self::Drive { body } => [2, body, 0],
            Self::JointStiffness { motion, joint } => [3, motion, joint],
            Self::JointDamping { motion, joint } => [4, motion, joint],
            Self::JointMotor { motion, joint } => [5, motion, joint],
            Self::Element { motion, element } => [6, motion, element],
        }
    }

    /// The value of the recorded run.
    pub fn recorded(self) -> f64 {
        if let Self::Damping { .. } = self { 0.0 } else { 1.0 }
    }

    /// Refuses values that are not finite, and negative ones of what must not be negative.
    pub(crate) fn check(self, value: f64) -> Result<(), LiveError> {
        let may_be_negative = matches!(self, Self::Load { .. } | Self::Drive { .. } | Self::JointMotor { .. });
        if value.is_finite() && (may_be_negative || value >= 0.0) {
            return Ok(());
        }
        let expected = if may_be_negative { "a finite number" } else { "zero or more" };
        Err(LiveError::Value { what: "a factor or a damping ratio", found: value, expected })
    }

    /// Puts the value into a run. `body` is the number in it of the change's body.
    pub(crate) fn apply(self, value: f64, body: usize, run: &mut RunDescription) -> Result<(), LiveError> {
        const NO_BODY: LiveError = LiveError::Nothing { what: "such body" };
        match self {
            Self::Load { load, .. } => {
                let loads = &mut run.bodies.get_mut(body).ok_or(NO_BODY)?.loads;
                let load = loads.get_mut(load).ok_or(LiveError::Nothing { what: "such load" })?;
                *load = Arc::new(ScaledLoad { load: Arc::clone(load), factor: Signal::held(value) });
            }
            Self::Damping { .. } => {
                let DescribedBody { damping_ratios, .. } = run.bodies.get_mut(body).ok_or(NO_BODY)?;
                damping_ratios.iter_mut().for_each(|ratio| *ratio += value);
            }
            Self::Drive { .. } => {
                let physics = &mut run.bodies.get_mut(body).ok_or(NO_BODY)?.physics;
                let drive = physics.drive.as_mut().ok_or(LiveError::Nothing { what: "such drive" })?;
                drive.speed.amplitude *= value;
            }
            Self::JointStiffness { joint, .. } => forces(run, joint)?.for_each(|force| force.stiffness *= value),
            Self::JointDamping { joint, .. } => forces(run, joint)?.for_each(|force| {
                force.damping *= value;
                force.friction.iter_mut().for_each(|friction| friction.force *= value);
            }),
            Self::JointMotor { joint, .. } => forces(run, joint)?.for_each(|force| {
                force.motor.iter_mut().for_each(|motor| motor.amplitude *= value);
            }),
            Self::Element { element, .. } => {
                const NONE: LiveError = LiveError::Nothing { what: "such spring or bushing" };
                let element = run.elements.get_mut(element).ok_or(NONE)?;
                *element = stiffened(element, value).ok_or(NONE)?;
            }
        }
        Ok(())
    }
}

/// The forces along the coordinates of a joint.
fn forces(run: &mut RunDescription, joint: usize) -> Result<impl Iterator<Item = &mut JointForce>, LiveError> {
    const NONE: LiveError = LiveError::Nothing { what: "such joint" };
    let Joint { turn_force, slide_force, .. } = run.joints.get_mut(joint).ok_or(NONE)?;
    Ok(turn_force.iter_mut().chain(slide_force))
}

/// A spring or a bushing times a factor.
fn stiffened(element: &Arc<dyn ForceElement>, factor: f64) -> Option<Arc<dyn ForceElement>> {
    let any: &dyn std::any::Any = &**element;
    if let Some(spring) = any.downcast_ref::<PointSpring>() {
        let (stiffness, damping) = (spring.stiffness * factor, spring.damping * factor);
        return Some(Arc::new(PointSpring { stiffness, damping, ..spring.clone() }));
    }
    let bushing = any.downcast_ref::<Bushing>()?;
    let times = |vectors: [_; 2]| vectors.map(|vector: Vector3<f64>| vector * factor);
    let (stiffness, damping) = (times(bushing.stiffness), times(bushing.damping));
    Some(Arc::new(Bushing { stiffness, damping, ..bushing.clone() }))
}
