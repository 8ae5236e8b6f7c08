//! A body that rests in its frame, and its first order there.

use dynamics::{AtRest, ConservativeBody, Equations, Initial, LoadedError, MotionState};
use scene::Body;

use crate::model::Model;

impl Model {
    /// First order of the body about rest in its frame under its loads and its drive as they are at a time, in the attitude of `initial`.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn at_rest(&self, initial: &Initial, time: f64) -> Result<AtRest, LoadedError> {
        self.conservative(initial)?.at_rest(initial, &self.small_amplitudes(), time)
    }

    /// The motion in which the body rests in its frame under its loads and its drive as they are at time 0, held to its first
    /// attitude.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn rest(&self, given: &Body) -> Result<MotionState, LoadedError> {
        let initial = self.initial(given);
        let body = self.conservative(&initial)?;
        let AtRest { modal_displacement, .. } = body.at_rest(&initial, &self.small_amplitudes(), 0.0)?;
        let modal_velocity = vec![0.0; modal_displacement.len()];
        let state = body.start(&Initial { modal_displacement, modal_velocity, ..initial })?;
        Ok(body.motion_state(&state).map_err(|error| error.in_step(0.0, 0.0))?)
    }

    /// The body under its loads where a motion begins.
    fn conservative(&self, initial: &Initial) -> Result<ConservativeBody, LoadedError> {
        let body = ConservativeBody::new(&self.body, self.damping_ratios(), self.loads().to_vec(), &self.physics)?;
        Ok(body.beginning_at(initial))
    }
}
