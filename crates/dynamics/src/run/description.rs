//! A run as data: all that it begins with, so that another process makes the same motion of it, such as a page in a browser.
//!
//! It holds what this crate can make itself. A load, a law, an element or a method of one's own is code, which no data hold: a run
//! with such a part is refused by name.

pub(crate) mod error;
mod loads;
mod method;

use std::sync::Arc;

use reduced_body::ReducedBody;
use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::physics::Physics;
use crate::body::shapes::PointShapes;
use crate::conservative::ConservativeBody;
use crate::error::SetupError;
use crate::load::SharedLoad;
use crate::run::description::error::DescriptionError;
use crate::simulation::Simulation;
use crate::simulation::plan::{Rows, StepControl};
use crate::simulation::setup::{Method, Setup};
use crate::system::collocation::SystemScheme;
use crate::system::description::System;
use crate::system::element::{ForceElement, data as elements};
use crate::system::joint::Joint;
use crate::system::joint::coupling::Coupling;
use crate::system::run::setup::{Start, SystemSetup};

/// Name and version of the data, in front of them.
const NAME: &str = "flexframe run";
const VERSION: u32 = 5;

/// A body with what acts on it, and the points that are observed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DescribedBody {
    /// The body.
    pub body: ReducedBody,
    /// One damping ratio for each flexible mode.
    pub damping_ratios: Vec<f64>,
    /// The loads.
    #[serde(with = "loads")]
    pub loads: Vec<SharedLoad>,
    /// Effects, drives and stress.
    pub physics: Physics,
    /// Points whose motion is observed.
    pub points: Vec<PointShapes>,
    /// Its name for messages, which data do not hold.
    #[serde(skip)]
    pub name: Option<Box<str>>,
}

/// The run of an island with all that it begins with: what [`Setup`] has of one body, and [`SystemSetup`] of bodies in joints.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RunDescription {
    /// The bodies: one, unless the method is of bodies in joints.
    pub bodies: Vec<DescribedBody>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Couplings of the joints.
    pub couplings: Vec<Coupling>,
    /// Forces between markers.
    #[serde(with = "elements")]
    pub elements: Vec<Arc<dyn ForceElement>>,
    /// The motion of each body at the beginning, as far as the joints let it be.
    pub states: Vec<MotionState>,
    /// Where bodies in joints begin.
    pub start: Start,
    /// How it is stepped.
    #[serde(with = "method")]
    pub method: Method,
    /// How long the steps are.
    pub control: StepControl,
    /// When it ends.
    pub end: f64,
    /// When it is observed.
    pub rows: Rows,
}

impl RunDescription {
    /// As bytes, by serde and postcard, with name and version in front.
    ///
    /// # Errors
    /// [`DescriptionError`] for a part that is code of one's own.
    pub fn to_bytes(&self) -> Result<Vec<u8>, DescriptionError> {
        self.check()?;
        Ok(postcard::to_allocvec(&(NAME, VERSION, self))?)
    }

    /// The run of [`Self::to_bytes`]. Beginning it checks its numbers.
    ///
    /// # Errors
    /// [`DescriptionError`] for bytes of something else or of another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DescriptionError> {
        let ((name, version), rest) =
            postcard::take_from_bytes::<(&str, u32)>(bytes).map_err(|_| DescriptionError::Other)?;
        if name != NAME {
            return Err(DescriptionError::Other);
        }
        if version != VERSION {
            return Err(DescriptionError::Version { found: version, expected: VERSION });
        }
        match postcard::take_from_bytes(rest)? {
            (run, []) => Ok(run),
            _ => Err(postcard::Error::DeserializeBadEncoding.into()),
        }
    }

    /// Refuses what no data hold.
    fn check(&self) -> Result<(), DescriptionError> {
        for body in &self.bodies {
            if let Some(load) = body.loads.iter().find(|load| loads::data(&***load).is_none()) {
                return Err(DescriptionError::Load { load: format!("{load:?}") });
            }
            if body.physics.drive.as_ref().is_some_and(|drive| drive.added.is_some()) {
                return Err(DescriptionError::AddedSpeed);
            }
        }
        method::check(&self.method)?;
        if let Some(element) = self.elements.iter().find(|element| elements::data(&***element).is_none()) {
            return Err(DescriptionError::Element { element: format!("{element:?}") });
        }
        let has_law = |joint: &&Joint| joint.forces().any(|(_, force)| !force.laws.is_empty());
        if let Some(joint) = self.joints.iter().find(has_law) {
            return Err(DescriptionError::Law { joint: joint.name.clone() });
        }
        match self.joints.iter().find(|joint| joint.equations().next().is_some()) {
            Some(joint) => Err(DescriptionError::Equation { joint: joint.name.clone() }),
            None => Ok(()),
        }
    }

    /// Begins the run.
    ///
    /// # Errors
    /// As [`Simulation::new`] and [`Simulation::of_system`]; for several bodies, joints or forces between markers by a method that has
    /// no joints.
    pub fn begin(&self) -> Result<Simulation, SetupError> {
        match self.method.joints {
            Some(scheme) => self.begin_in_joints(scheme),
            None => self.begin_without_joints(),
        }
    }

    fn begin_without_joints(&self) -> Result<Simulation, SetupError> {
        let ([described], [], [], [state]) = (&self.bodies[..], &self.joints[..], &self.elements[..], &self.states[..])
        else {
            let formulation = self.method.formulation;
            return Err(SetupError::NotInFormulation { formulation, what: "bodies in joints" });
        };
        let DescribedBody { body, damping_ratios, loads, physics, points, .. } = described;
        Simulation::new(&Setup {
            body,
            damping_ratios,
            loads,
            physics,
            initial: &state.into(),
            method: &self.method,
            control: self.control,
            end: self.end,
            rows: self.rows,
            points,
        })
    }

    fn begin_in_joints(&self, scheme: SystemScheme) -> Result<Simulation, SetupError> {
        let of = |body: &DescribedBody| {
            ConservativeBody::new(&body.body, &body.damping_ratios, body.loads.clone(), &body.physics)
        };
        let bodies = self.bodies.iter().map(of).collect::<Result<_, _>>()?;
        let names: Option<Vec<_>> = self.bodies.iter().map(|body| body.name.clone()).collect();
        let system = System::new(bodies, self.joints.clone())?.with_names(names.unwrap_or_default());
        Simulation::of_system(SystemSetup {
            system: system.with_couplings(self.couplings.clone())?.with_elements(self.elements.clone())?,
            states: self.states.clone(),
            start: self.start,
            scheme,
            control: self.control,
            end: self.end,
            rows: self.rows,
            points: self.bodies.iter().map(|body| body.points.clone()).collect(),
        })
    }
}
