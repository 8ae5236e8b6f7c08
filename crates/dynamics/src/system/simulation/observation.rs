//! Bodies and joints at one time, as events and rows see them.

use std::sync::Arc;

use crate::body::shapes::PointShapes;
use crate::error::{RateError, StepError};
use crate::observation::Observation;
use crate::observation::observer::Observed;
use crate::simulation::events::{Crossing, Event};
use crate::system::description::System;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::SystemMotion;

/// The motion of a system at one time.
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
    /// Room for a system, and for the motion of points of each body.
    pub(crate) fn new(system: &System, points: &[Vec<PointShapes>]) -> Self {
        let of_bodies = system.bodies().iter().zip(points);
        Self {
            time: 0.0,
            bodies: of_bodies.map(|(body, points)| Observation::new(body.flexible(), points.len())).collect(),
            joints: vec![JointObservation::default(); system.joints().len()],
            elements: vec![JointObservation::default(); system.elements().len()],
        }
    }

    /// Takes in the motion where it is.
    pub(crate) fn fill(&mut self, motion: &mut SystemMotion, points: &[Vec<PointShapes>]) -> Result<(), RateError> {
        motion.find_reactions()?;
        self.time = motion.time();
        for (body, (out, points)) in self.bodies.iter_mut().zip(points).enumerate() {
            motion.observe(body, points, out)?;
        }
        for (joint, out) in self.joints.iter_mut().enumerate() {
            *out = motion.observe_joint(joint);
        }
        for (element, out) in self.elements.iter_mut().enumerate() {
            *out = motion.observe_element(element);
        }
        Ok(())
    }
}

impl Observed for SystemObservation {
    type Motion = SystemMotion;
    type Points = Vec<PointShapes>;

    fn time(&self) -> f64 {
        self.time
    }

    fn find(
        &mut self,
        motion: &mut SystemMotion,
        points: &[Vec<PointShapes>],
        longest_step: f64,
    ) -> Result<(), StepError> {
        let time = motion.time();
        self.fill(motion, points).map_err(|error| error.in_step(time, longest_step))
    }
}

impl Event<SystemObservation> {
    /// An event of a [`SystemSimulation`](crate::SystemSimulation), with a name for messages: the function sees all bodies and joints.
    pub fn of_system(
        name: impl Into<String>,
        crossing: Crossing,
        function: impl Fn(&SystemObservation) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::of(name.into(), crossing, Arc::new(function))
    }

    /// The same event of a body alone, which is a system of one.
    pub(crate) fn of_body(self) -> Event<Observation> {
        self.seeing(|body: &Observation| SystemObservation {
            time: body.time,
            bodies: vec![body.clone()],
            joints: Vec::new(),
            elements: Vec::new(),
        })
    }
}
