//! A body that rests in its frame, and its first order there.

use dynamics::{ConservativeBody, Drive, Equations, Initial, LoadedError, MotionState, Physics, Signal};
use faer::Mat;
use nalgebra::Vector3;
use scene::Scene;

use crate::model::Model;

/// A body at rest under its loads, its drive standing still.
#[derive(Debug, Clone)]
pub struct AtRest {
    /// Generalised forces (6+nf) of each load where its history is 1, as [`ConservativeBody::unit_forces`].
    pub unit_forces: Vec<Vec<f64>>,
    /// Stiffness for small motions of the modes (nf×nf).
    pub stiffness: Mat<f64>,
}

/// Accelerations of the modes (nf), and the reaction: force and moment about the origin, body axes.
pub type Answer = (Vec<f64>, [f64; 6]);

/// First order of a held body about rest in its frame, in which its drive may turn. The laws are of second degree in each of these, so that
/// central differences are exact but for rounding.
#[derive(Debug, Clone)]
pub struct HeldSlopes {
    /// Modal displacements at rest.
    pub modal_displacement: Vec<f64>,
    /// By each modal displacement, then by each modal velocity.
    pub by_modes: [Vec<Answer>; 2],
    /// By the speed of the drive, and by its acceleration.
    pub by_drive: Option<[Answer; 2]>,
}

impl Model {
    /// The body at rest under its loads as they are at a time, in the attitude of `initial`.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn at_rest(&self, initial: &Initial, time: f64) -> Result<AtRest, LoadedError> {
        let physics = Physics { drive: None, drive_stiffness: None, ..self.physics.clone() };
        let initial = Initial { omega: Vector3::zeros(), velocity: Vector3::zeros(), ..initial.clone() };
        let body = self.conservative(&physics, &initial)?;
        let state = self.rest_of(&body, &initial, time)?;
        let stiffness = body.loaded_stiffness(&initial, &state.modal_displacement, &self.small_amplitudes(), time)?;
        Ok(AtRest { unit_forces: body.unit_forces(&state), stiffness })
    }

    /// The motion in which the body rests in its frame under its loads and its drive as they are at time 0, held to its first
    /// attitude.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn rest(&self, scene: &Scene) -> Result<MotionState, LoadedError> {
        let initial = self.initial(scene);
        self.rest_of(&self.conservative(&self.physics, &initial)?, &initial, 0.0)
    }

    /// Slopes of a body that is held, or held in what drives it, about rest in its frame at a time.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn held_slopes(&self, initial: &Initial, time: f64) -> Result<HeldSlopes, LoadedError> {
        let added = Signal::held(0.0);
        let drive = self.physics.drive.clone().map(|drive| Drive { added: Some(added.clone()), ..drive });
        let is_driven = drive.is_some();
        let initial = Initial { omega: Vector3::zeros(), velocity: Vector3::zeros(), ..initial.clone() };
        let body = self.conservative(&Physics { drive, ..self.physics.clone() }, &initial)?;
        let rest = self.rest_of(&body, &initial, time)?;
        let slope = |motions: [&MotionState; 2], size: f64, set: &dyn Fn(f64)| -> Result<Answer, LoadedError> {
            let mut answers = Vec::new();
            for (motion, sign) in motions.into_iter().zip([1.0, -1.0]) {
                set(sign * size);
                answers.push(body.observed_at(motion, &[])?);
            }
            set(0.0);
            let of = |ahead: f64, back: f64| (ahead - back) / (2.0 * size);
            let accelerations = answers[0].modal_acceleration.iter().zip(&answers[1].modal_acceleration);
            let [ahead, back] = [0, 1].map(|k| {
                let reaction = &answers[k].reaction;
                [reaction.force_body, reaction.moment_body]
            });
            let reaction = std::array::from_fn(|i| of(ahead[i / 3][i % 3], back[i / 3][i % 3]));
            Ok((accelerations.map(|(ahead, back)| of(*ahead, *back)).collect(), reaction))
        };
        let amplitudes = self.small_amplitudes();
        let omega = &self.body.circular_frequencies;
        let (mut by_displacement, mut by_velocity) = (Vec::new(), Vec::new());
        for (k, amplitude) in amplitudes.iter().copied().enumerate() {
            let moved = |by: f64| {
                let mut motion = rest.clone();
                motion.modal_displacement[k] += by;
                motion
            };
            by_displacement.push(slope([&moved(amplitude), &moved(-amplitude)], amplitude, &|_| ())?);
            let rate = amplitude * omega[k];
            let faster = |by: f64| {
                let mut motion = rest.clone();
                motion.modal_velocity[k] += by;
                motion
            };
            by_velocity.push(slope([&faster(rate), &faster(-rate)], rate, &|_| ())?);
        }
        let by_drive = if is_driven {
            let speed = omega.iter().copied().fold(f64::INFINITY, f64::min).min(1e6);
            let by_speed = slope([&rest; 2], speed, &|by| added.hold(by))?;
            let by_rate = slope([&rest; 2], speed * speed, &|by| added.ramp(time, 0.0, by))?;
            Some([by_speed, by_rate])
        } else {
            None
        };
        Ok(HeldSlopes {
            modal_displacement: rest.modal_displacement,
            by_modes: [by_displacement, by_velocity],
            by_drive,
        })
    }

    /// The body under its loads, with other physics than its own, where a motion begins.
    fn conservative(&self, physics: &Physics, initial: &Initial) -> Result<ConservativeBody, LoadedError> {
        let body = ConservativeBody::new(&self.body, self.damping_ratios(), self.loads().to_vec(), physics)?;
        Ok(body.beginning_at(initial))
    }

    /// The state in which a body rests in its frame at a time, with the velocities of `initial`.
    fn rest_of(&self, body: &ConservativeBody, initial: &Initial, time: f64) -> Result<MotionState, LoadedError> {
        let modal_displacement = body.loaded_rest(initial, &self.small_amplitudes(), time)?;
        let modal_velocity = vec![0.0; modal_displacement.len()];
        let state = body.start(&Initial { modal_displacement, modal_velocity, ..initial.clone() })?;
        let motion = body.motion_state(&state).map_err(|error| error.in_step(time, 0.0))?;
        Ok(MotionState { time, ..motion })
    }
}
