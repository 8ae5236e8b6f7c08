//! The motion within a step that has been done: Eqs. (J17) of `docs/method/systems.md`.

use nalgebra::Vector3;

use crate::body::motion_state::MotionState;
use crate::conservative::{get, part, set};
use crate::equations::Equations;
use crate::error::SetupError;
use crate::state::State;
use crate::system::joint::work::JointWork;
use crate::system::radau::law_work::Path;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::stage::vector;

impl SystemMotion {
    /// Takes over the motion of another with the same system, but for the count of its evaluations, without allocating.
    pub(in crate::system) fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.system.bodies.iter_mut().zip(&other.system.bodies).for_each(|(own, other)| own.frame = other.frame);
        self.bodies.iter_mut().zip(&other.bodies).for_each(|(own, other)| own.copy_from(other));
        let lists = |of: &Self| -> [f64; 4] { [of.last_length, of.largest_energy, of.largest_moving, of.jump_work] };
        [self.last_length, self.largest_energy, self.largest_moving, self.jump_work] = lists(other);
        self.past.copy_from(&other.past);
        for (own, other) in self.last.iter_mut().flatten().zip(other.last.iter().flatten()) {
            own.copy_from_slice(other);
        }
        for (own, other) in self.multipliers.iter_mut().zip(&other.multipliers) {
            own.copy_from_slice(other);
        }
        for (own, other) in self.bend.iter_mut().zip(&other.bend) {
            own.copy_from_slice(other);
        }
        self.stage_rates.iter_mut().zip(&other.stage_rates).for_each(|(own, other)| own.copy_from(other));
        self.start.joints.copy_from_slice(&other.start.joints);
        self.matrices.is_left_out.copy_from_slice(&other.matrices.is_left_out);
        if let (Some(own), Some(other)) = (&mut self.judgement, &other.judgement) {
            own.rank.is_implied.copy_from_slice(&other.rank.is_implied);
        } else {
            self.judgement.clone_from(&other.judgement);
        }
        (self.judged_at, self.is_controlled) = (other.judged_at, other.is_controlled);
        self.joint_works.copy_from_slice(&other.joint_works);
        self.element_works.copy_from_slice(&other.element_works);
        self.held.copy_from_slice(&other.held);
    }

    /// Takes other states of the bodies, at the time of the first. Works and impulses are counted from there; full turns of joints go
    /// on.
    pub(in crate::system) fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let (expected, found) = (self.bodies.len(), states.len());
        if found != expected {
            return Err(SetupError::Length { what: "the list of states", expected, found });
        }
        let bodies = self.system.bodies.iter().zip(states);
        let bodies = bodies.map(|(body, state)| body.state_of(state)).collect::<Result<_, _>>()?;
        self.take_states(bodies, states.first().map(|first| first.time));
        Ok(())
    }

    /// The same of states as `ConservativeBody::motion_in_frame` gives them, at the same time.
    pub(in crate::system) fn set_states_in_frame(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let bodies = self.system.bodies.iter().zip(states);
        let bodies = bodies.map(|(body, state)| body.state_in_frame(state)).collect::<Result<_, _>>()?;
        self.take_states(bodies, None);
        Ok(())
    }

    fn take_states(&mut self, bodies: Vec<State>, time: Option<f64>) {
        self.bodies = bodies;
        self.time = time.unwrap_or(self.time);
        self.bodies.iter_mut().for_each(|body| body.time = self.time);
        self.joint_works.fill(JointWork::default());
        self.element_works.fill(JointWork::default());
        self.held.fill([0.0; 2]);
        self.jump_work = 0.0;
        self.forget_last_step();
        self.forget_judgement();
    }

    /// Goes to a time within a step, from the motion `before` it, by the polynomials of the step, at whose end `after` has been at
    /// the time `end`. The joints then hold as at the end of a step, and what flies freely has the momenta that the loads give it.
    pub(in crate::system) fn go_within(
        &mut self,
        before: &Self,
        (after, end): (&Self, f64),
        time: f64,
    ) -> Result<(), Failed> {
        self.copy_from(before);
        self.stage_rates.iter_mut().zip(&after.stage_rates).for_each(|(own, other)| own.copy_from(other));
        self.begin();
        let h = end - before.time;
        let fraction = (time - before.time) / h;
        let times = [time, before.time + 0.5 * h];
        let factors = self.scheme.at(fraction);
        let [.., stage] = &mut self.stages;
        let bend = self.scheme.bend(fraction);
        for (which, list) in [&mut stage.x, &mut stage.y].into_iter().enumerate() {
            for (k, value) in list.iter_mut().enumerate() {
                let of_stages: f64 =
                    factors.iter().zip(&after.last).map(|(factor, last)| factor * last[which][k]).sum();
                *value = of_stages + bend * after.bend[which][k];
            }
        }
        stage.evaluate(&self.system, &self.start, times)?;
        self.evaluations += 1;
        let Self { system, start, scheme, law_work, .. } = self;
        let increments = after.last.each_ref().map(|[x, _]| &x[..]);
        law_work.find(&Path { system, start, scheme, increments, h }, fraction);
        let weights = self.scheme.weights_to(fraction).map(|weight| h * weight);
        self.land(times, h, weights)?;
        // Momenta that bend have impulses that do.
        for (b, (body, state)) in self.system.bodies.iter().zip(&mut self.bodies).enumerate() {
            let first = self.system.first[b];
            let [impulse, about_center] = [0, 3].map(|part| bend * vector(&after.bend[1], first + part));
            let mut list = body.list_mut(state);
            let mut slow = *list.slow();
            let apart = self.system.spins_apart[b];
            let arm = if apart { Vector3::zeros() } else { get(&slow, part::POSITION) - body.frame.center() };
            let moment = about_center - arm.cross(&impulse);
            for (which, more) in [(part::IMPULSE, impulse), (part::ANGULAR_IMPULSE, moment)] {
                let sum = get(&slow, which) + more;
                set(&mut slow, which, &sum);
            }
            list.set_slow(&slow);
        }
        Ok(())
    }
}
