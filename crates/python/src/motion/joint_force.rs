//! The class JointForce: a force along the coordinate of a joint, whose law is a function of Python.

use std::sync::Arc;

use flexframe::dynamics::{Coordinate, JointLaw};
use flexframe::motion::JointForces;
use flexframe::scene;
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::motion::law::{LawInRun, OwnLaw};
use crate::values::numbers::number_that;

/// A moment about the turn of a joint, or a force along its slide, by a law: a function of the time, the coordinate (rad or a
/// length) and its rate that returns a number. It is positive on the second body along the coordinate, as the motor of a scene.
///
/// `along` is "turn" or "slide"; a joint that has but one needs none. The law is evaluated several times a step, and must depend on
/// nothing but these. `discontinuities` are times at which it or its rate jumps, so that steps end there. `switch` is a function of
/// the same that changes its sign where the law has a kink or a jump, such as the gap of a stop: under a tolerance steps end there.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct JointForce {
    joint: String,
    along: Option<Coordinate>,
    law: OwnLaw,
}

#[pymethods]
impl JointForce {
    #[new]
    #[pyo3(signature = (joint, law, *, along=None, name=None, discontinuities=Vec::new(), switch=None))]
    fn new(
        joint: String,
        law: &Bound<'_, PyAny>,
        along: Option<&str>,
        name: Option<String>,
        discontinuities: Vec<f64>,
        switch: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let along = match along {
            None => None,
            Some("turn") => Some(Coordinate::Turn),
            Some("slide") => Some(Coordinate::Slide),
            Some(other) => {
                let help = "name the coordinate of the joint that the law acts along";
                return Err(wrong_input(law.py(), "along", &format!("`{other}`"), "`turn` or `slide`", help));
            }
        };
        Ok(Self { joint, along, law: OwnLaw::new(law, name, discontinuities, switch)? })
    }

    fn __repr__(&self) -> String {
        format!("JointForce({:?}, {})", self.joint, self.law.name())
    }
}

impl JointForce {
    /// The law at a joint of a system.
    pub(crate) fn of(&self, py: Python<'_>, scene: &scene::Scene, faults: &Faults) -> PyResult<JointForces> {
        let number = joint_number(py, &self.joint, scene)?;
        let known = scene.joints[number].kind.coordinates();
        let along = match (self.along, known) {
            (None, [only]) => *only,
            (Some(along), known) if known.contains(&along) => along,
            (found, _) => {
                let found = match found {
                    None => "no coordinate",
                    Some(Coordinate::Turn) => "`turn`",
                    Some(Coordinate::Slide) => "`slide`",
                };
                let kind = scene.joints[number].kind.name();
                let help = "a hinge turns, a slide slides, a cylindrical joint does both";
                return Err(wrong_input(py, "along", found, &format!("a coordinate of a {kind} joint"), help));
            }
        };
        Ok(JointForces { joint: number, along, law: Arc::new(self.law.in_run(py, faults)) })
    }
}

/// The number of a joint of a system, by its name.
pub(crate) fn joint_number(py: Python<'_>, name: &str, scene: &scene::Scene) -> PyResult<usize> {
    let names = || scene.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ");
    scene.joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
        let expected = if scene.joints.is_empty() { "none: there are no joints".to_owned() } else { names() };
        wrong_input(py, "joint", &format!("`{name}`"), &format!("one of {expected}"), "name a joint of [[joints]]")
    })
}

impl JointLaw for LawInRun {
    fn force(&self, [time, _]: [f64; 2], [coordinate, rate]: [f64; 2]) -> f64 {
        let read = |value: &Bound<'_, PyAny>| {
            let what = format!("the force of the law `{}`", self.name);
            number_that(value, f64::is_finite, [&what, "a finite number", "return the force or the moment"])
        };
        self.ask(time, (time, coordinate, rate), read).unwrap_or(f64::NAN)
    }

    fn switch(&self, [time, _]: [f64; 2], [coordinate, rate]: [f64; 2]) -> Option<f64> {
        self.switch_at(time, (time, coordinate, rate))
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.discontinuities.clone()
    }
}
