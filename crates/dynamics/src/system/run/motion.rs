//! Bodies in joints as a motion that a simulation leads.

use std::any::Any;

use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::ConservativeBody;
use crate::error::{BodyName, SetupError, StepError};
use crate::matrix::lists::larger;
use crate::motion::Motion;
use crate::motion::facts::{Balance, MotionFacts, Stepping};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::simulation::checkpoint::{CheckpointError, decode, encode, equal_room, expect, finite};
use crate::simulation::walk::EXACT;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::stepping::ROUNDING;
use crate::system::run::setup::{ShapeLimit, Start, assemble};
use crate::system::run::{STABLE, SystemRun, of_step};
use crate::system::saved::SavedMotion;
use crate::tolerance::ErrorMeasure;

/// State in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved {
    motion: SavedMotion,
    exchanged: Vec<f64>,
    gone: Vec<f64>,
    longest_step: f64,
    largest_residual: f64,
    #[serde(with = "equal_room")]
    undecided_at: Option<f64>,
    rounding_of_places: f64,
}

impl Motion for SystemRun {
    fn facts(&self) -> MotionFacts {
        let system = self.motion.system();
        let longest = self.shape_limit.map_or(f64::INFINITY, |ShapeLimit { limit, .. }| STABLE * limit);
        MotionFacts {
            flexible: system.bodies().iter().map(ConservativeBody::flexible).collect(),
            joints: system.joints().len(),
            elements: system.elements().len(),
            // The account measures by `balance`.
            fastest_rate: 0.0,
            stepping: Stepping::Free { longest, rounding: ROUNDING },
        }
    }

    fn time(&self) -> f64 {
        self.motion.time()
    }

    fn begin_step(&mut self) {
        self.motion.follow_islands();
    }

    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let time = self.motion.time();
        let tried = self.motion.try_step(h, end, EXACT, f64::INFINITY);
        tried.map_err(|failed| self.motion.reason_or(of_step(failed, time, h)))?;
        self.longest_step = self.longest_step.max(h);
        Ok(())
    }

    fn free_step(&mut self, end: f64, measure: &mut ErrorMeasure, h: &mut f64) -> Result<Option<f64>, StepError> {
        let taken = self.motion.try_towards(end, measure, h);
        let taken = taken.map_err(|error| self.motion.reason_or(error))?;
        self.longest_step = taken.map_or(self.longest_step, |length| self.longest_step.max(length));
        Ok(taken)
    }

    fn part_of_step(&mut self, h: f64, end: f64, exactness: f64) -> Result<(), StepError> {
        let time = self.motion.time();
        self.motion.try_step(h, end, exactness, f64::INFINITY).map_err(|failed| of_step(failed, time, h))?;
        Ok(())
    }

    fn go_within(&mut self, before: &dyn Motion, after: &dyn Motion, time: f64) -> Result<(), StepError> {
        let [before, after] = [before, after].map(|of| (of as &dyn Any).downcast_ref::<Self>());
        let (Some(Self { motion: before, .. }), Some(Self { motion: after, .. })) = (before, after) else {
            return Err(StepError::OutsideLastStep { time, from: self.time(), to: self.time() });
        };
        let (start, end) = (before.time(), after.time());
        self.motion.go_within(before, (after, end), time).map_err(|failed| of_step(failed, start, end - start))
    }

    fn step_is_done(&mut self) -> [f64; 2] {
        let Self { motion, largest_residual, rounding_of_places, undecided_at, exchanged, gone, .. } = self;
        *largest_residual = larger(*largest_residual, motion.residual_of_last_step());
        *rounding_of_places = rounding_of_places.max(motion.rounding_of_places());
        if motion.is_undecided() {
            undecided_at.get_or_insert(motion.time());
        }
        let mut total = [0.0; 2];
        for (body, (exchanged, gone)) in exchanged.iter_mut().zip(gone).enumerate() {
            let now = motion.work_and_dissipation(body);
            *exchanged = exchanged.max(now[0].abs() + now[1].abs());
            total = [total[0] + now[0], total[1] + now[1]];
            *gone += motion.way_of_last_step(body);
        }
        total
    }

    fn pass_discontinuity(&mut self) -> Result<(), StepError> {
        self.motion.pass_discontinuity().map_err(|error| self.in_step(error))
    }

    fn loads_have_changed(&mut self) {
        self.motion.forget_last_step();
    }

    fn begin_observation(&mut self) -> Result<(), StepError> {
        self.motion.find_reactions().map_err(|error| self.in_step(error))
    }

    fn observe(&mut self, body: usize, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        self.motion.observe(body, points, out).map_err(|error| self.in_step(error))
    }

    fn observe_joint(&self, joint: usize) -> JointObservation {
        self.motion.observe_joint(joint)
    }

    fn observe_element(&self, element: usize) -> JointObservation {
        self.motion.observe_element(element)
    }

    fn name_of(&self, body: usize) -> Option<BodyName> {
        Some(self.motion.system().named(body))
    }

    fn states(&self) -> Result<Vec<MotionState>, StepError> {
        let bodies = 0..self.exchanged.len();
        bodies.map(|body| self.motion.state(body).map_err(|error| error.in_step(self.time(), 0.0))).collect()
    }

    fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let mut motion = self.motion.clone();
        motion.set_states(states)?;
        self.placed = assemble(&mut motion, states, Start::AsPlaced, [self.size, self.end])?;
        self.motion = motion;
        self.exchanged.fill(0.0);
        self.gone.fill(0.0);
        Ok(())
    }

    /// The bodies alone: how the steps of the run went stays.
    fn copy_state(&mut self, from: &dyn Motion) {
        let Some(from) = (from as &dyn Any).downcast_ref::<Self>() else { return };
        self.motion.copy_from(&from.motion);
    }

    fn moment(&self, body: usize) -> Moment<'_> {
        self.motion.moment(body)
    }

    /// It takes an evaluation: see `balance`.
    fn energies(&self) -> Option<Energies> {
        None
    }

    fn balance(&self, sum: &Energies, elapsed: f64) -> Option<Balance> {
        let (scale, unseen) = (self.motion.energy_scale(), self.unseen_energy(elapsed));
        Some(Balance { energies: *sum, scale, unseen })
    }

    fn exchanged(&self, body: usize) -> Option<[f64; 2]> {
        Some([self.exchanged[body].max(self.motion.energy_scale()), self.energy_at_rest(body)])
    }

    fn evaluations(&self) -> u64 {
        self.motion.evaluations()
    }

    fn save(&self) -> Result<Vec<u8>, CheckpointError> {
        encode(&Saved {
            motion: self.motion.saved(),
            exchanged: self.exchanged.clone(),
            gone: self.gone.clone(),
            longest_step: self.longest_step,
            largest_residual: self.largest_residual,
            undecided_at: self.undecided_at,
            rounding_of_places: self.rounding_of_places,
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError> {
        let Saved { motion, exchanged, gone, longest_step, largest_residual, undecided_at, rounding_of_places } =
            decode(saved)?;
        expect("the number of bodies", [&exchanged, &gone].iter().all(|list| list.len() == self.exchanged.len()))?;
        let numbers = [&longest_step, &largest_residual, &rounding_of_places];
        finite("the energies and the ways of bodies", exchanged.iter().chain(&gone))?;
        finite("the steps so far", numbers.into_iter().chain(&undecided_at))?;
        self.motion.take_up(motion)?;
        (self.exchanged, self.gone, self.longest_step) = (exchanged, gone, longest_step);
        self.largest_residual = largest_residual;
        (self.undecided_at, self.rounding_of_places) = (undecided_at, rounding_of_places);
        Ok(())
    }

    fn boxed_clone(&self) -> Box<dyn Motion> {
        Box::new(self.clone())
    }
}
