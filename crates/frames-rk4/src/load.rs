//! What acts on the body.

use nalgebra::{Matrix3, Vector3};

use crate::error::SetupError;
use crate::history::History;
use crate::motion::{PointShapes, RotationShapes, power_of, project};

/// The axes that the direction of a load is fixed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadFrame {
    /// Global axes: a dead load.
    Global,
    /// Body axes: a follower load.
    Body,
}

/// A load and its course in time.
#[derive(Debug, Clone)]
pub struct Load {
    /// What it does to the body where the history is 1.
    pub action: Action,
    /// The factor on it.
    pub history: History,
}

/// What a load does to the body.
#[derive(Debug, Clone)]
pub enum Action {
    /// A force at a point. A load of one direction that is spread over the body, such as a traction or gravity, is its
    /// resultant at the point that moves as the weighted mean of where it acts.
    Force {
        /// Where it acts.
        point: PointShapes,
        /// Force, components in the axes of `frame`.
        force: Vector3<f64>,
        /// Its axes.
        frame: LoadFrame,
    },
    /// A couple.
    Moment {
        /// How the place where it acts is turned by the modes.
        rotation: RotationShapes,
        /// Couple, components in the axes of `frame`.
        moment: Vector3<f64>,
        /// Its axes.
        frame: LoadFrame,
    },
    /// Forces on many nodes that are fixed in body axes, such as a pressure.
    Field(BodyField),
}

/// Forces f_i on nodes, body components, in modal coordinates.
#[derive(Debug, Clone)]
pub struct BodyField {
    /// Σ f_i.
    pub force_body: Vector3<f64>,
    /// Σ X_i × f_i.
    pub moment_body: Vector3<f64>,
    /// Ψᵀ f, rigid and flexible modes (6+nf).
    pub modal: Vec<f64>,
    /// Σ Φ_k,i × f_i for each flexible mode: what a deformation adds to the moment (nf).
    pub lever: Vec<Vector3<f64>>,
}

/// Force and moment about the origin that a load makes, body components, and its power on the deformation.
pub(crate) struct Resultant {
    pub force_body: Vector3<f64>,
    pub moment_body: Vector3<f64>,
    pub deforming_power: f64,
}

/// A load at a time: the factor on it, and the attitude of the body.
#[derive(Clone, Copy)]
pub(crate) struct Acting<'a> {
    pub factor: f64,
    /// `None` while the body axes are the global ones.
    pub global_to_body: Option<&'a Matrix3<f64>>,
}

impl Acting<'_> {
    fn to_body(self, vector: &Vector3<f64>, frame: LoadFrame) -> Vector3<f64> {
        match (frame, self.global_to_body) {
            (LoadFrame::Global, Some(global_to_body)) => global_to_body * vector * self.factor,
            _ => vector * self.factor,
        }
    }
}

impl Load {
    /// A force at a point that keeps its global direction.
    pub fn dead_force(point: PointShapes, force: Vector3<f64>, history: History) -> Self {
        Self { action: Action::Force { point, force, frame: LoadFrame::Global }, history }
    }

    /// The load on the body with its first `flexible` flexible modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let action = match &self.action {
            Action::Force { point, force, frame } => {
                Action::Force { point: point.truncated(flexible), force: *force, frame: *frame }
            }
            Action::Moment { rotation, moment, frame } => {
                Action::Moment { rotation: rotation.truncated(flexible), moment: *moment, frame: *frame }
            }
            Action::Field(field) => Action::Field(BodyField {
                modal: field.modal[..(6 + flexible).min(field.modal.len())].to_vec(),
                lever: field.lever[..flexible.min(field.lever.len())].to_vec(),
                ..*field
            }),
        };
        Self { action, history: self.history.clone() }
    }

    /// Adds Φᵀf of the flexible modes to `modal_force`, and returns the resultant at the deformation q whose rate is
    /// `velocity`.
    pub(crate) fn apply(&self, now: Acting, q: &[f64], velocity: &[f64], modal_force: &mut [f64]) -> Resultant {
        match &self.action {
            Action::Force { point, force, frame } => {
                let force_body = now.to_body(force, *frame);
                let arm = point.position_body() + point.deformation(q);
                Resultant {
                    force_body,
                    moment_body: arm.cross(&force_body),
                    deforming_power: point.add_flexible_force(&force_body, velocity, modal_force),
                }
            }
            Action::Moment { rotation, moment, frame } => {
                let moment_body = now.to_body(moment, *frame);
                Resultant {
                    force_body: Vector3::zeros(),
                    moment_body,
                    deforming_power: rotation.add_flexible_moment(&moment_body, velocity, modal_force),
                }
            }
            Action::Field(field) => {
                let mut power = 0.0;
                for ((f, v), unit) in modal_force.iter_mut().zip(velocity).zip(&field.modal[6..]) {
                    *f += now.factor * unit;
                    power += now.factor * unit * v;
                }
                let turned: Vector3<f64> = field.lever.iter().zip(q).map(|(lever, q)| lever * *q).sum();
                Resultant {
                    force_body: field.force_body * now.factor,
                    moment_body: (field.moment_body + turned) * now.factor,
                    deforming_power: power,
                }
            }
        }
    }

    /// Adds f_q = Ψᵀ f of all modes (6+nf).
    pub(crate) fn add_modal_force(&self, now: Acting, modal_force: &mut [f64]) {
        match &self.action {
            Action::Force { point, force, frame } => {
                project(point.columns(), &now.to_body(force, *frame), modal_force);
            }
            Action::Moment { rotation, moment, frame } => {
                project(rotation.columns(), &now.to_body(moment, *frame), modal_force);
            }
            Action::Field(field) => {
                for (f, unit) in modal_force.iter_mut().zip(&field.modal) {
                    *f += now.factor * unit;
                }
            }
        }
    }

    /// Force and moment about `center`, body components, and the whole power, of modal displacements and velocities
    /// (6+nf each) in an inertial frame.
    pub(crate) fn on_modes(
        &self,
        now: Acting,
        displacement: &[f64],
        velocity: &[f64],
        center: &Vector3<f64>,
    ) -> Resultant {
        match &self.action {
            Action::Force { point, force, frame } => {
                let force_body = now.to_body(force, *frame);
                let arm = point.position_body() + point.expand(displacement) - center;
                let deforming_power = power_of(point.columns(), &force_body, velocity);
                Resultant { force_body, moment_body: arm.cross(&force_body), deforming_power }
            }
            Action::Moment { rotation, moment, frame } => {
                let moment_body = now.to_body(moment, *frame);
                let deforming_power = power_of(rotation.columns(), &moment_body, velocity);
                Resultant { force_body: Vector3::zeros(), moment_body, deforming_power }
            }
            Action::Field(field) => {
                let force_body = field.force_body * now.factor;
                let turned: Vector3<f64> = field.lever.iter().zip(&displacement[6..]).map(|(l, q)| l * *q).sum();
                Resultant {
                    force_body,
                    moment_body: (field.moment_body + turned) * now.factor - center.cross(&force_body),
                    deforming_power: now.factor * field.modal.iter().zip(velocity).map(|(f, v)| f * v).sum::<f64>(),
                }
            }
        }
    }

    /// Refuses numbers that are not finite, histories that are none, and places of another body.
    pub(crate) fn check(&self, flexible: usize) -> Result<(), SetupError> {
        self.history.check()?;
        let length = |found: usize| {
            if found == flexible {
                Ok(())
            } else {
                Err(SetupError::Length { what: "the point of a load", expected: flexible, found })
            }
        };
        let (vector, found) = match &self.action {
            Action::Force { point, force, .. } => (force, point.flexible()),
            Action::Moment { rotation, moment, .. } => (moment, rotation.flexible()),
            Action::Field(field) => (&field.force_body, field.lever.len()),
        };
        if let Some(found) = vector.iter().copied().find(|f| !f.is_finite()) {
            return Err(SetupError::Value { what: "a force", found, expected: "a finite number" });
        }
        length(found)
    }
}
