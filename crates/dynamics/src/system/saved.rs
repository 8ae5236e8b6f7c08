//! The state of a system between its steps: for watchers, and for checkpoints.

use serde::{Deserialize, Serialize};

use crate::conservative::frame::Frame;
use crate::equations::Equations;
use crate::error::RateError;
use crate::observation::moment::Moment;
use crate::simulation::checkpoint::{CheckpointError, counts, expect, finite, fixed_room};
use crate::state::State;
use crate::system::collocation::STAGES;
use crate::system::joint::coordinate::JointCoordinates;
use crate::system::joint::work::JointWork;
use crate::system::radau::SystemMotion;
use crate::system::radau::past::Past;
use crate::system::radau::stage_rates::StageRates;
use crate::system::stage::vector;

/// A motion in a checkpoint.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::system) struct SavedMotion {
    time: f64,
    frames: Vec<Frame>,
    bodies: Vec<State>,
    last: Vec<Vec<f64>>,
    last_length: f64,
    /// Beside the increments, the way within the last step.
    bend: [Vec<f64>; 2],
    stage_rates: [StageRates; STAGES],
    past: Past,
    multipliers: Vec<Vec<f64>>,
    joints: Vec<(JointCoordinates, JointWork)>,
    elements: Vec<JointWork>,
    held: Vec<[f64; 2]>,
    sums: [f64; 3],
    #[serde(with = "fixed_room")]
    evaluations: u64,
}

impl SystemMotion {
    /// The motion of a body at the end of the last step.
    pub(in crate::system) fn moment(&self, body: usize) -> Moment<'_> {
        let [.., last] = &self.stages;
        let (first, end) = (self.system.first[body], self.system.first[body + 1]);
        Moment {
            time: self.time,
            omega_body: vector(&last.velocities, first + 3),
            modal_displacement: last.body_place(&self.system, body).q,
            modal_velocity: &last.velocities[first + 6..end],
        }
    }

    /// Work and dissipation of a body since the beginning.
    pub(in crate::system) fn work_and_dissipation(&self, body: usize) -> [f64; 2] {
        self.system.bodies[body].work_and_dissipation_of(&self.bodies[body])
    }

    /// All that a later step depends on.
    pub(in crate::system) fn saved(&self) -> SavedMotion {
        SavedMotion {
            time: self.time,
            frames: self.system.bodies.iter().map(|body| body.frame).collect(),
            bodies: self.bodies.clone(),
            last: self.last.concat(),
            last_length: self.last_length,
            bend: self.bend.clone(),
            stage_rates: self.stage_rates.clone(),
            past: self.past.clone(),
            multipliers: self.multipliers.to_vec(),
            joints: self.start.joints.iter().copied().zip(self.joint_works.iter().copied()).collect(),
            elements: self.element_works.clone(),
            held: self.held.clone(),
            sums: [self.largest_energy, self.largest_moving, self.jump_work],
            evaluations: self.evaluations,
        }
    }

    /// Takes up a state that [`Self::saved`] has given.
    ///
    /// # Errors
    /// [`CheckpointError`] for lists of other lengths, and numbers that are not finite.
    pub(in crate::system) fn take_up(&mut self, saved: SavedMotion) -> Result<(), CheckpointError> {
        let SavedMotion {
            time,
            frames,
            bodies,
            last,
            last_length,
            bend,
            stage_rates,
            past,
            multipliers,
            joints,
            elements,
            held,
            sums,
            evaluations,
        } = saved;
        let lists = [bodies.len(), frames.len(), last.len(), multipliers.len()];
        let own = self.bodies.len();
        expect("the number of bodies", lists == [own, own, 2 * STAGES, STAGES])?;
        for ((body, state), own) in self.system.bodies.iter().zip(&bodies).zip(&self.bodies) {
            expect("the state of a body", state.values.len() == own.values.len())?;
            body.layout().check(state)?;
        }
        expect("the last step", last.iter().all(|list| list.len() == self.system.coordinates()))?;
        expect("the multipliers", multipliers.iter().all(|list| list.len() == self.system.rows()))?;
        expect("the number of joints", joints.len() == self.joint_works.len())?;
        for (coordinates, work) in &joints {
            finite("a joint", coordinates.list().into_iter().chain(work.list()))?;
        }
        expect("the number of forces of joints", held.len() == self.held.len())?;
        finite("the time for which friction has held", held.iter().flatten())?;
        expect("the number of springs and bushings", elements.len() == self.element_works.len())?;
        finite("a spring or a bushing", elements.iter().flat_map(JointWork::list))?;
        finite("the frames", frames.iter().flat_map(Frame::numbers))?;
        finite("the motion", last.iter().chain(&multipliers).flatten().chain(&sums).chain([&time, &last_length]))?;
        counts(&[evaluations])?;
        expect("the bend of the last step", bend.iter().all(|list| list.len() == self.system.coordinates()))?;
        finite("the bend of the last step", bend.iter().flatten())?;
        stage_rates.iter().zip(&self.stage_rates).try_for_each(|(saved, own)| saved.check(own))?;
        past.check(&self.past)?;
        (self.past, self.bend, self.stage_rates) = (past, bend, stage_rates);
        self.system.bodies.iter_mut().zip(frames).for_each(|(body, frame)| body.frame = frame);
        (self.time, self.bodies, self.last_length, self.evaluations) = (time, bodies, last_length, evaluations);
        for (own, saved) in
            self.last.iter_mut().flatten().chain(&mut self.multipliers).zip(last.iter().chain(&multipliers))
        {
            own.copy_from_slice(saved);
        }
        for ((saved, coordinates), work) in joints.into_iter().zip(&mut self.start.joints).zip(&mut self.joint_works) {
            (*coordinates, *work) = saved;
        }
        self.element_works = elements;
        self.held = held;
        self.forget_judgement();
        [self.largest_energy, self.largest_moving, self.jump_work] = sums;
        Ok(())
    }

    /// The joint or coupling that is farthest from closed where the system is, with the residual of its row and the rate of that;
    /// `None` without any.
    pub(super) fn largest_gap(&mut self) -> Result<Option<(String, [f64; 2])>, RateError> {
        let [residuals, rates] = self.residuals()?;
        let open = |row: usize| [residuals[row].abs(), rates[row].abs()];
        let largest = |row: &usize| open(*row).into_iter().fold(0.0, f64::max);
        let worst = (0..residuals.len()).max_by(|a, b| largest(a).total_cmp(&largest(b)));
        let worst = worst.map(|row| (row, open(row)));
        Ok(worst.and_then(|(row, open)| Some((self.system.connections.names().nth(row)?.to_owned(), open))))
    }
}
