//! The state that a motion stands for, at the beginning and where a drive jumps.

use nalgebra::Vector3;

use crate::body::initial::Initial;
use crate::body::motion_state::MotionState;
use crate::conservative::body::{ConservativeBody, Translation, along};
use crate::conservative::frame::Frame;
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::{BodyList, Slow, get, part, set};
use crate::error::{RateError, SetupError};
use crate::matrix::four::Padded;
use crate::matrix::side_by_side::combine;
use crate::state::State;

impl ConservativeBody {
    /// The state at the beginning: π = J ω + Sᵀ q̇, p = q̇ + S ω. Parts of the velocities that the body has not got are
    /// left out; driven ones are as they are driven.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn start(&self, initial: &Initial) -> Result<State, SetupError> {
        self.start_at(initial, 0.0)
    }

    /// The same at another time, when the drive is as fast as it then is.
    pub(crate) fn start_at(&self, initial: &Initial, time: f64) -> Result<State, SetupError> {
        self.start_in(&self.frame, initial, time)
    }

    /// The same of a motion whose positions and velocities are such that its numbers come to be in the body's frame from this one.
    fn start_in(&self, frame: &Frame, initial: &Initial, time: f64) -> Result<State, SetupError> {
        initial.check(self.flexible())?;
        let mut e = self.room();
        let [q, _] = e.at.modes_mut();
        q.copy_from_slice(&initial.modal_displacement);
        let scalar = pulp::Scalar::new();
        self.deform(scalar, &mut e);
        let speed = self.drive.as_ref().map_or(0.0, |drive| drive.speed_at(time, time));
        let mut spin = Vector3::zeros();
        for (w, axis) in spin.iter_mut().zip(&self.axes) {
            *w = if self.turn_driven { speed } else { axis.dot(&initial.omega) };
        }
        self.extend_rate(&initial.modal_velocity, &mut e);
        let s_by_velocity = self.s_products(scalar, &e.products, self.velocity_of_coordinates(&e).groups());
        let pi: Vector3<f64> = self.deformed_inertia(scalar, &e) * spin + s_by_velocity;
        let mut mu = match &self.manifold {
            Some(manifold) => {
                let Evaluation { velocity, in_shapes: [_, in_shapes, _], .. } = &mut e;
                manifold.in_shapes(velocity, in_shapes);
                let mut mu = vec![0.0; velocity.len()];
                manifold.add_from_shapes(in_shapes, &mut mu);
                mu
            }
            None => e.modal_velocity.to_vec(),
        };
        let mut s_by_spin = Padded::zeros(mu.len());
        combine(scalar, self.s_lists(&e.products), &spin.as_slice()[..self.s_count], s_by_spin.groups_mut());
        mu.iter_mut().zip(&*s_by_spin).for_each(|(mu, s)| *mu += s);
        mu.iter_mut().zip(&self.sliding).for_each(|(mu, b)| *mu += b * speed);
        let momentum = match &self.manifold {
            Some(manifold) => {
                let mut momentum = vec![0.0; self.flexible()];
                manifold.add_projection(&e.place, &mu, &mut momentum);
                momentum
            }
            None => mu,
        };
        let pi = Vector3::from_fn(|k, _| if k < self.axes.len() { pi[k] } else { 0.0 });
        let mut slow: Slow = [0.0; 20];
        set(&mut slow, part::POSITION, &frame.place_from(&initial.origin.unwrap_or(self.origin), time));
        let velocity = match self.translation {
            Translation::Free => initial.velocity - frame.velocity(),
            Translation::Along(direction) => along(&initial.attitude.to_global(&direction), &initial.velocity),
            Translation::None | Translation::Driven(_) => Vector3::zeros(),
        };
        set(&mut slow, part::MOMENTUM, &(velocity * self.mass));
        set(&mut slow, part::PI, &pi);
        let mut list = BodyList { values: self.layout.zeros(), flexible: self.flexible() };
        list.set_attitude(initial.attitude);
        list.set_slow(&slow);
        list.set_modes(&initial.modal_displacement, &momentum);
        Ok(State { time, values: list.values })
    }

    /// A state in quantities that every formulation has.
    pub(super) fn motion_of(&self, state: &State) -> Result<MotionState, RateError> {
        let in_frame = self.motion_in_frame(state)?;
        Ok(MotionState {
            origin_global: self.frame.global_place(&in_frame.origin_global, state.time),
            velocity_global: in_frame.velocity_global + self.frame.velocity(),
            ..in_frame
        })
    }

    /// The same with the position and the velocity of the origin in the frame of the body: what a system changes a little keeps its digits.
    pub(crate) fn motion_in_frame(&self, state: &State) -> Result<MotionState, RateError> {
        let mut e = self.room();
        self.evaluate_at(state, state.time, &mut e)?;
        let list = self.list(state);
        Ok(MotionState {
            time: state.time,
            attitude: list.attitude(),
            origin_global: get(list.slow(), part::POSITION),
            velocity_global: get(e.rates.slow(), part::POSITION),
            omega_body: e.omega_body,
            modal_displacement: list.q().to_vec(),
            modal_velocity: e.modal_velocity.to_vec(),
        })
    }

    /// The momenta of a motion. Work and impulses are counted from it anew.
    pub(super) fn state_from(&self, motion: &MotionState) -> Result<State, SetupError> {
        self.state_by(&self.frame, motion)
    }

    /// The same of a motion as [`Self::motion_in_frame`] gives it.
    pub(crate) fn state_in_frame(&self, motion: &MotionState) -> Result<State, SetupError> {
        self.state_by(&Frame::GLOBAL, motion)
    }

    fn state_by(&self, frame: &Frame, motion: &MotionState) -> Result<State, SetupError> {
        motion.check(self.flexible())?;
        let initial = Initial {
            attitude: motion.attitude,
            origin: Some(motion.origin_global),
            velocity: motion.velocity_global,
            omega: motion.omega_body,
            modal_displacement: motion.modal_displacement.clone(),
            modal_velocity: motion.modal_velocity.clone(),
        };
        self.start_in(frame, &initial, motion.time)
    }

    /// q̇ and ż.
    fn extend_rate(&self, rate: &[f64], e: &mut Evaluation) {
        e.modal_velocity.copy_from_slice(rate);
        if let Some(manifold) = &self.manifold {
            manifold.go_along(rate, &mut e.place, &mut e.velocity);
        }
    }

    /// Takes a state past a jump of the speed of the drive at its time. The drive does its impulse times the mean of the
    /// speeds.
    pub(super) fn pass_jump(&self, state: &mut State, e: &mut Evaluation) -> Result<(), RateError> {
        if self.drive.is_none() {
            return Ok(());
        }
        // The discontinuity itself is where it is but for rounding.
        let aside = 1e-12 * state.time.abs();
        let on_side = |state: &State, branch_time: f64, e: &mut Evaluation| -> Result<[f64; 2], RateError> {
            self.evaluate_at(state, branch_time, e)?;
            Ok([e.driven_speed, e.driven_momentum])
        };
        let [after, _] = on_side(state, state.time + aside, e)?;
        let [before, held] = on_side(state, state.time - aside, e)?;
        let jump = after - before;
        let mut list = BodyList { values: &mut state.values[..], flexible: self.flexible() };
        let [_, p] = list.modes_mut();
        p.iter_mut().zip(&e.drive_stress).for_each(|(p, k_q)| *p += jump * k_q);
        let [_, given] = on_side(state, state.time + aside, e)?;
        let mut list = BodyList { values: &mut state.values[..], flexible: self.flexible() };
        let mut slow = *list.slow();
        slow[part::WORK] += 0.5 * (before + after) * (given - held);
        list.set_slow(&slow);
        Ok(())
    }
}
