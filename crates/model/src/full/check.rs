//! The check of a model's state by the full body.

use dynamics::{ConservativeBody, History, LoadFrame, MotionState, Observation, PointForce, PointMoment, SharedLoad};
use faer::{ColRef, Mat};
use fem_tet10::{Location, StressRecovery};
use nalgebra::Vector3;
use nonlinear::{FullBody, FullState, StateError, StateErrorSettings, Tangent, state_error, true_frequencies};
use scene::Body;
use serde::Serialize;

use crate::error::refuse;
use crate::full::acting::TieForce;
use crate::full::mends::{ErrorPart, Mend, mend_of_drift, mends, parts};
use crate::full::stress::{StressCheck, stress_check};
use crate::full::{FullError, FullModel};
use crate::model::Model;

/// Frequencies that are compared.
const FREQUENCIES: usize = 4;
/// A spin above this part of the first frequency turns the vibrations of a body that spins freely into ones with its spin, which
/// the full body does not have.
const HELD_SPIN: f64 = 1e-3;

/// A state of a model against the full body.
#[derive(Debug, Clone, Serialize)]
pub struct StateCheck {
    /// The time.
    pub time: f64,
    /// Size of the error of the displacements over that of the true ones, over the body: in the norm of its mass.
    pub error: f64,
    /// The same size over the largest one of the model's displacements in the run, as far as that is known: what counts where the body
    /// is hardly deformed.
    pub error_of_largest: f64,
    /// Size of the true displacements in the norm of the mass: √mass times length.
    pub size: f64,
    /// The part of the error that is along the modes, as `error`.
    pub within_modes: f64,
    /// The part that no combination of the modes has.
    pub beside_modes: f64,
    /// The error by its directions with what would mend each, as `error_of_largest`.
    pub parts: [ErrorPart; 3],
    /// The error to which the vibrations of the run may come by its end, over the largest displacements as `error_of_largest`: if the forces along
    /// the modes are wrong all the time as much as here, in step with them, Eq. (K8) of `docs/method/check.md`.
    pub drift: f64,
    /// The mend of that.
    pub drift_mend: Option<Mend>,
    /// Largest error of the displacement of a node, length.
    pub largest_error: f64,
    /// Largest true displacement by deformation of a node, length.
    pub largest_displacement: f64,
    /// The points of the output.
    pub points: Vec<PointCheck>,
    /// The stress; `None` where the scene does not ask for it.
    pub stress: Option<StressCheck>,
    /// The lowest frequencies of the model and of the full body about the state; empty where they are not compared.
    pub frequencies: Vec<FrequencyCheck>,
    /// Number of directions in which the stiffness at the state is negative; `None` under forces that follow the body, where it
    /// says nothing.
    pub negative_directions: Option<usize>,
    /// Largest growth of a vibration of the full body about the state, 1 per time: positive where it is unstable.
    pub growth: f64,
    /// Means that would make the larger parts of the error smaller.
    pub mends: Vec<Mend>,
    /// Factors of the tangent that were made.
    pub factors: usize,
    /// True if the last of them changed little: the error is known well.
    pub is_settled: bool,
}

/// A point of the output.
#[derive(Debug, Clone, Serialize)]
pub struct PointCheck {
    /// Its name.
    pub name: String,
    /// The true displacement by deformation, body components.
    pub displacement: [f64; 3],
    /// Its error: the model's displacement less the true one, body components.
    pub error: [f64; 3],
    /// Size of the error over that of the displacement.
    pub relative: f64,
}

/// A frequency.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FrequencyCheck {
    /// Frequency of the model, cycles per time.
    pub model: f64,
    /// Frequency of the full body, cycles per time.
    pub full: f64,
    /// Relative error of the model's.
    pub error: f64,
}

/// A full body that checks states of a model: with its factor at rest.
pub struct Checker<'a> {
    full: &'a FullModel,
    given: &'a Body,
    model: &'a Model,
    body: &'a FullBody<'a>,
    at_rest: Tangent<'a>,
    points: Vec<(String, Location)>,
    course: Course,
}

/// The modal displacements of a run, as far as they are known.
#[derive(Debug, Clone, Default)]
pub struct Course {
    /// The largest of the model's displacements, in the norm of the mass.
    pub largest: f64,
    /// Half of the way between the least and the largest displacement of each mode.
    pub swings: Vec<f64>,
}

impl<'a> Checker<'a> {
    /// Factors the stiffness of the undeformed body.
    ///
    /// # Errors
    /// [`FullError`].
    pub fn new(
        full: &'a FullModel,
        given: &'a Body,
        model: &'a Model,
        body: &'a FullBody<'a>,
    ) -> Result<Self, FullError> {
        let points = crate::model::points::output_points(given, |key: String, at: [f64; 3]| {
            let located = full.assembled.mesh.locate(at);
            located.map_err(|error| refuse(given, &key, error).into())
        })?;
        Ok(Self { full, given, model, body, at_rest: body.at_rest()?, points, course: Course::default() })
    }

    /// States errors against the displacements of a run, too.
    #[must_use]
    pub fn against(self, course: Course) -> Self {
        Self { course, ..self }
    }

    /// Checks the state of a motion under the forces of joints. `frequencies` is true where these are to be compared, too.
    ///
    /// # Errors
    /// [`FullError`].
    pub fn check(
        &self,
        motion: &MotionState,
        joints: &[TieForce],
        settings: &StateErrorSettings,
        frequencies: bool,
    ) -> Result<StateCheck, FullError> {
        let moving = self.moving(joints)?;
        let observed = moving.observed_at(motion, &[])?;
        let state = self.state(&observed, joints)?;
        let found = state_error(self.body, &self.at_rest, &state, settings)?;
        let truth: Vec<f64> = state.displacement.iter().zip(&found.error).map(|(u, e)| u + e).collect();
        let size = self.body.mass_norm(&truth);
        let relative = |v: &[f64]| ratio(self.body.mass_norm(v), size);
        let modes = self.model.meshed.as_ref().map_or_else(Mat::new, |meshed| meshed.modes.shapes.clone());
        let [within, beside] = self.body.parts(modes.as_ref(), &found.error);
        let [_, answer] = self.body.parts(modes.as_ref(), &found.linear_answer);
        let product: f64 = beside.iter().zip(self.body.momentum(&answer)).map(|(e, a)| e * a).sum();
        let sizes = self.body.mass_norm(&beside) * self.body.mass_norm(&answer);
        let [error, within, beside] = [&found.error, &within, &beside].map(|v| relative(v));
        let linear = if sizes > 0.0 { (product / sizes).abs().min(1.0) } else { 0.0 };
        // Of a state that is smaller than the largest.
        let largest = self.course.largest.max(size);
        let share = ratio(size, largest);
        let (has_static_shapes, has_large_modes) =
            (self.model.static_shapes() > 0, !self.model.large_modes().is_empty());
        let [along, left_out] = self.along_modes(&found);
        let drift = ratio(self.drift(&along, &motion.modal_displacement), largest);
        let [along, left_out] = [along, left_out].map(|list| share * ratio(norm(&list), size));
        let parts = parts([along, left_out, beside * share, linear], has_static_shapes, has_large_modes);
        let follows = state.forces.follow();
        let (frequencies, growth) = match frequencies && self.spin_is_held(&state) {
            true => self.frequencies(&moving, motion, &state, &found)?,
            false => (Vec::new(), 0.0),
        };
        Ok(StateCheck {
            time: motion.time,
            error,
            error_of_largest: error * share,
            size,
            within_modes: within,
            beside_modes: beside,
            parts,
            drift,
            drift_mend: mend_of_drift(drift, has_large_modes),
            largest_error: peak(&found.error),
            largest_displacement: peak(&truth),
            points: self.points.iter().map(|point| checked(point, &truth, &found.error)).collect(),
            stress: self.stress(&observed, &truth)?,
            frequencies,
            negative_directions: (!follows).then_some(found.negative_pivots),
            growth,
            mends: mends(&parts),
            factors: found.factors,
            is_settled: found.factors == 1 || found.last_change <= settings.settled.max(0.5),
        })
    }

    /// The error of each modal displacement that the run may come to, Eq. (K8), as one size: a force that is wrong by ω² e in step with a vibration
    /// makes it lead or lag by ½ (e/q) ω t. A mode that the run holds at a place counts as far as it vibrates about it.
    fn drift(&self, along: &[f64], at: &[f64]) -> f64 {
        let Model { body, damping_ratios, .. } = self.model;
        let end = self.given.time.end;
        let of_mode = |k: usize| -> Option<f64> {
            let (error, q, swing) = (along.get(k)?.abs(), at.get(k)?.abs(), *self.course.swings.get(k)?);
            let (omega, zeta) = (*body.circular_frequencies.get(k)?, damping_ratios.get(k).copied().unwrap_or(0.0));
            let phase = 0.5 * (omega * end).min(zeta.recip());
            let part = if swing < q { swing / q } else { 1.0 };
            // A vibration that is out of step by half a turn is out by twice its size.
            Some((error * part * phase).min(2.0 * swing))
        };
        norm(&(0..body.natural_modes).filter_map(of_mode).collect::<Vec<_>>())
    }

    /// Two parts of the error along each mode: of the model, and of a linear body, too. A static shape is the
    /// answer to a force that stays; of one that does not, more modes have the difference, Eq. (K7) of `docs/method/check.md`.
    fn along_modes(&self, found: &StateError<'_>) -> [Vec<f64>; 2] {
        let Some(meshed) = &self.model.meshed else { return [Vec::new(), Vec::new()] };
        let shapes = &meshed.modes.shapes;
        let along = |v: &[f64]| shapes.transpose() * ColRef::from_slice(v);
        let error = along(&self.body.momentum(&found.error));
        let answer = along(&self.body.momentum(&found.linear_answer));
        let acting = along(&found.acting);
        let natural = self.model.body.natural_modes;
        let left_out = |k: usize| match k >= natural && meshed.reference.is_none() {
            true => answer[k] - acting[k] / meshed.modes.eigenvalues[k],
            false => 0.0,
        };
        let modes = 0..shapes.ncols();
        [modes.clone().map(|k| error[k] - left_out(k)).collect(), modes.map(left_out).collect()]
    }

    /// The state of a motion on all nodes.
    ///
    /// # Errors
    /// [`FullError`].
    pub fn state(&self, observed: &Observation, joints: &[TieForce]) -> Result<FullState, FullError> {
        let forces = self.full.forces(observed.time, &observed.attitude, joints);
        let without_mesh =
            || nonlinear::NonlinearError::NotFinite { what: "the displacement of a body without a mesh" };
        Ok(self.model.full_state(observed, forces).ok_or_else(without_mesh)?)
    }

    /// The model's equations with the forces of joints as loads. They are without damping, which the full body does not have: its
    /// force would be taken for an error.
    fn moving(&self, joints: &[TieForce]) -> Result<ConservativeBody, FullError> {
        let Model { body, loads, physics, markers, .. } = self.model;
        let mut loads = loads.clone();
        for TieForce { marker, part, force_global, moment_global } in joints {
            let Some(marker) = markers.get(*marker) else { continue };
            let part = part.and_then(|part| marker.parts.get(part));
            let (point, turning) = part.map_or((&marker.point, &marker.turning), |part| (&part.point, &part.turning));
            let force: SharedLoad =
                std::sync::Arc::new(PointForce::dead(point.clone(), *force_global, History::Constant));
            let moment: SharedLoad = std::sync::Arc::new(PointMoment {
                rotation: turning.clone(),
                moment: *moment_global,
                frame: LoadFrame::Global,
                history: History::Constant,
            });
            loads.extend([force, moment]);
        }
        let undamped = vec![0.0; self.model.damping_ratios.len()];
        let initial = self.model.initial(self.given);
        Ok(ConservativeBody::new(body, &undamped, loads, physics)?.beginning_at(&initial))
    }

    /// The stress of the model's state beside that of the true displacements.
    fn stress(&self, observed: &Observation, truth: &[f64]) -> Result<Option<StressCheck>, FullError> {
        let Some(stress) = &self.model.stress else { return Ok(None) };
        let recovery = StressRecovery::new(&self.full.assembled.mesh, self.full.assembled.materials()?)?;
        let of_model = (&observed.modal_displacement[..], stress.peak(observed));
        stress_check(&recovery, stress, &self.points, of_model, truth).map(Some)
    }

    /// True if the spin is given, or next to none.
    fn spin_is_held(&self, state: &FullState) -> bool {
        let turns_freely = self.model.physics.drive.is_none() && !self.model.body.motion.rotations().is_empty();
        let first = self.model.lowest_frequency();
        !turns_freely || state.omega_body.norm() < HELD_SPIN * first
    }

    fn frequencies(
        &self,
        moving: &ConservativeBody,
        motion: &MotionState,
        state: &FullState,
        found: &StateError<'_>,
    ) -> Result<(Vec<FrequencyCheck>, f64), FullError> {
        let Some(shapes) = self.model.slopes(&motion.modal_displacement) else { return Ok((Vec::new(), 0.0)) };
        let full = true_frequencies(self.body, state, found, shapes.as_ref())?;
        let amplitudes: Vec<f64> =
            self.model.size.peaks.iter().map(|peak| 1e-4 * self.model.size.length / peak).collect();
        let model = moving.vibrations_at(motion, &amplitudes)?;
        // Those of the frame itself, of a body that turns freely.
        let floor = 1e-3 * self.model.lowest_frequency();
        let tau = std::f64::consts::TAU;
        let of_model = model.iter().map(|mode| mode.circular_frequency).filter(|omega| *omega > floor);
        let of_full = full.iter().map(|mode| mode.circular_frequency).filter(|omega| *omega > floor);
        let compared = of_model.zip(of_full).take(FREQUENCIES.min(self.model.body.natural_modes));
        let compared = compared.map(|(model, full)| FrequencyCheck {
            model: model / tau,
            full: full / tau,
            error: model / full - 1.0,
        });
        // Growth that is more than rounding.
        let growth = full.iter().map(|mode| mode.growth).fold(0.0, f64::max);
        let scale = full.iter().map(|mode| mode.circular_frequency).fold(0.0, f64::max);
        Ok((compared.collect(), if growth > 1e-6 * scale { growth } else { 0.0 }))
    }
}

fn norm(list: &[f64]) -> f64 {
    list.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn ratio(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / size }
}

/// Largest displacement of a node.
fn peak(u: &[f64]) -> f64 {
    u.chunks_exact(3).map(|u| Vector3::from_column_slice(u).norm()).fold(0.0, f64::max)
}

fn checked((name, location): &(String, Location), truth: &[f64], error: &[f64]) -> PointCheck {
    let at = |list: &[f64]| -> Vector3<f64> {
        location.mean(|node| Vector3::from_column_slice(&list[3 * node as usize..3 * node as usize + 3]))
    };
    let (displacement, error) = (at(truth), at(error));
    PointCheck {
        name: name.clone(),
        displacement: displacement.into(),
        error: (-error).into(),
        relative: ratio(error.norm(), displacement.norm()),
    }
}
