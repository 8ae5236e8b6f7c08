//! All bodies, joints and force elements at one time, as events and observers see them.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::motion::Motion;
use crate::motion::facts::MotionFacts;
use crate::observation::Observation;
use crate::system::joint::observation::JointObservation;

/// The motion of all bodies of a run at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemObservation {
    /// Time.
    pub time: f64,
    /// The bodies, in their order in the system.
    pub bodies: Vec<Observation>,
    /// The joints, in their order in the system.
    pub joints: Vec<JointObservation>,
    /// The force elements, in their order in the system; zeros of those that do not show what they do.
    pub elements: Vec<JointObservation>,
}

impl SystemObservation {
    /// Room for a motion, and for points of each body.
    pub(crate) fn new(facts: &MotionFacts, points: &[Vec<PointShapes>]) -> Self {
        let of_bodies = facts.flexible.iter().zip(points);
        Self {
            time: 0.0,
            bodies: of_bodies.map(|(flexible, points)| Observation::new(*flexible, points.len())).collect(),
            joints: vec![JointObservation::default(); facts.joints],
            elements: vec![JointObservation::default(); facts.elements],
        }
    }

    /// Takes in the motion where it is.
    pub(crate) fn find(&mut self, motion: &mut dyn Motion, points: &[Vec<PointShapes>]) -> Result<(), StepError> {
        motion.begin_observation()?;
        for (body, (out, points)) in self.bodies.iter_mut().zip(points).enumerate() {
            motion.observe(body, points, out)?;
        }
        self.find_ties(motion);
        Ok(())
    }

    /// Takes in the time, the joints and the elements, after the bodies.
    pub(crate) fn find_ties(&mut self, motion: &dyn Motion) {
        self.time = motion.time();
        self.joints.iter_mut().enumerate().for_each(|(joint, out)| *out = motion.observe_joint(joint));
        self.elements.iter_mut().enumerate().for_each(|(element, out)| *out = motion.observe_element(element));
    }
}
