//! Bodies that move together by steps of their own.

use crate::error::StepError;
use crate::observation::Observation;
use crate::simulation::Simulation;
use crate::system::joint::observation::JointObservation;

/// Bodies that nothing ties to others, with steps of their own.
#[derive(Debug, Clone)]
pub struct Island {
    /// Their motion, where bodies, joints and elements have numbers of their own.
    pub motion: Simulation,
    /// Numbers of its bodies in the run.
    pub bodies: Vec<usize>,
    /// Numbers of its joints in the rows of the run.
    pub joints: Vec<usize>,
    /// Numbers of its springs and bushings in the rows, which come after the joints.
    pub elements: Vec<usize>,
}

impl Island {
    /// Observes its bodies, and its joints, springs and bushings at their numbers in a row, where the motion is or at a time within its
    /// last step.
    ///
    /// # Errors
    /// [`StepError`].
    pub fn observe<'o>(
        &mut self,
        within: Option<f64>,
        bodies: impl IntoIterator<Item = &'o mut Observation>,
        joints: &mut [JointObservation],
    ) -> Result<(), StepError> {
        let Self { motion, .. } = self;
        match within {
            Some(time) => motion.interpolate(time, bodies)?,
            None => motion.observe(bodies)?,
        }
        for (joint, place) in self.joints.iter().enumerate() {
            joints[*place] = motion.observe_joint(joint);
        }
        for (element, place) in self.elements.iter().enumerate() {
            joints[*place] = motion.observe_element(element);
        }
        Ok(())
    }
}
