//! A run: islands of bodies, each with steps of its own, led together from row to row.

pub(crate) mod description;
pub(crate) mod island;
pub(crate) mod row_times;

use crate::error::StepError;
use crate::observation::Observation;
use crate::observation::moment::Moment;
use crate::run::island::Island;
use crate::run::row_times::RowTimes;
use crate::simulation::Reached;
use crate::simulation::checkpoint::{CheckpointError, counts, expect, finite};
use crate::system::joint::observation::JointObservation;

/// A step of an island that failed.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{source}")]
pub struct IslandError {
    /// Numbers of its bodies.
    pub bodies: Vec<usize>,
    /// The reason.
    pub source: StepError,
}

impl From<IslandError> for StepError {
    fn from(failed: IslandError) -> Self {
        failed.source
    }
}

/// A run in progress: the one driver of bodies alone and of bodies in joints.
#[derive(Debug, Clone)]
pub struct Run {
    islands: Vec<Island>,
    /// Times of the rows of all islands; a body that nothing ties, alone in the run, has rows where it takes its steps.
    times: Option<RowTimes>,
    /// Number of the next row; the row of the start has number 0.
    next_row: u64,
    /// Time that all islands have been led to, some of them beyond it by less than a step.
    led_to: f64,
    stop: Option<f64>,
}

impl Run {
    /// The run of islands that are at the start, with rows at these times.
    pub fn new(mut islands: Vec<Island>, times: RowTimes) -> Self {
        let has_rows_at_steps = |island: &Island| !island.motion.is_free();
        let is_alone = matches!(&islands[..], [island] if has_rows_at_steps(island));
        if !is_alone && times.may_be_between_steps() {
            let between = islands.iter_mut().filter(|island| has_rows_at_steps(island));
            between.for_each(|island| island.motion.keep_last_step());
        }
        Self { islands, times: (!is_alone).then_some(times), next_row: 1, led_to: times.of(0), stop: None }
    }

    /// Its islands: first bodies that nothing ties.
    pub fn islands(&self) -> &[Island] {
        &self.islands
    }

    /// The same, for changes.
    pub fn islands_mut(&mut self) -> &mut [Island] {
        &mut self.islands
    }

    /// Its islands, to be led one by one.
    pub fn into_islands(self) -> Vec<Island> {
        self.islands
    }

    /// The island of a body, and the number of the body there.
    pub fn island_of(&self, body: usize) -> Option<(&Island, usize)> {
        self.islands.iter().find_map(|island| Some((island, island.bodies.iter().position(|of| *of == body)?)))
    }

    /// Room for the motion of each body.
    pub fn room(&self) -> Vec<Observation> {
        let count = self.islands.iter().map(|island| island.bodies.len()).sum();
        (0..count).filter_map(|body| self.island_of(body).map(|(island, own)| island.motion.room(own))).collect()
    }

    /// Room for the joints, and for the springs and bushings after them.
    pub fn room_of_joints(&self) -> Vec<JointObservation> {
        let count = self.islands.iter().map(|island| island.joints.len() + island.elements.len()).sum();
        vec![JointObservation::default(); count]
    }

    /// Time that all islands have come to.
    pub fn time(&self) -> f64 {
        self.islands.iter().map(|island| island.motion.time()).fold(f64::INFINITY, f64::min)
    }

    /// Time at which it ends.
    pub fn end(&self) -> f64 {
        self.islands.first().map_or(0.0, |island| island.motion.end())
    }

    /// Steps that all islands have taken.
    pub fn steps(&self) -> u64 {
        self.islands.iter().map(|island| island.motion.stats().accepted).sum()
    }

    /// The same, with steps that were tried in vain.
    pub fn tried(&self) -> u64 {
        self.islands.iter().map(|island| island.motion.tried()).sum()
    }

    /// Stops all islands at this time with [`Reached::Stop`], once. `None` takes it back.
    pub fn set_stop_time(&mut self, time: Option<f64>) {
        self.stop = time;
        self.islands.iter_mut().for_each(|island| island.motion.set_stop_time(time));
    }

    /// Leads all islands to the next row or stop, or each as far as `tries` tries of a step lead; `watch` sees the bodies of an island at
    /// each of its steps. Of an island alone, events come between.
    ///
    /// # Errors
    /// [`IslandError`].
    pub fn advance(&mut self, tries: u64, mut watch: impl FnMut(usize, &Moment)) -> Result<Reached, IslandError> {
        let Self { islands, times, next_row, led_to, stop } = self;
        let mut advance = |Island { motion, bodies, .. }: &mut Island, tries| {
            let reached = motion.advance_watched(tries, |body, moment| watch(bodies[body], moment));
            reached.map_err(|source| IslandError { bodies: bodies.clone(), source })
        };
        let Some(times) = times else {
            let Some(island) = islands.first_mut() else { return Ok(Reached::End) };
            let reached = advance(island, tries)?;
            *led_to = island.motion.time();
            return Ok(reached);
        };
        let row = (*next_row < times.count()).then(|| times.of(*next_row));
        let Some(next) = row.into_iter().chain(*stop).reduce(f64::min) else { return Ok(Reached::End) };
        for island in islands {
            let before = island.motion.tried();
            while island.motion.time() < next && !times.are_same(island.motion.time(), next) {
                let left = tries.saturating_sub(island.motion.tried() - before);
                if left == 0 {
                    return Ok(Reached::Between);
                }
                // Its own rows may be beyond the time by many steps.
                let reached = advance(island, if times.may_be_between_steps() { 1 } else { left })?;
                if matches!(reached, Reached::Event(_)) {
                    return Ok(reached);
                }
            }
        }
        *led_to = next;
        if stop.take_if(|stop| *stop <= next).is_some() {
            return Ok(Reached::Stop);
        }
        *next_row += 1;
        Ok(Reached::Row)
    }

    /// Observes all bodies, and joints before springs and bushings, at the row or stop that they have been led to, whose time is returned.
    ///
    /// # Errors
    /// [`IslandError`].
    pub fn observe<'o>(
        &mut self,
        bodies: impl IntoIterator<Item = &'o mut Observation>,
        joints: &mut [JointObservation],
    ) -> Result<f64, IslandError> {
        let mut bodies: Vec<_> = bodies.into_iter().map(Some).collect();
        for at in 0..self.islands.len() {
            let within = (!self.is_at_row(&self.islands[at])).then_some(self.led_to);
            let island = &mut self.islands[at];
            let own: Vec<_> = island.bodies.iter().filter_map(|body| bodies[*body].take()).collect();
            let observed = island.observe(within, own, joints);
            observed.map_err(|source| IslandError { bodies: island.bodies.clone(), source })?;
        }
        Ok(if self.times.is_some() { self.led_to } else { self.time() })
    }

    fn is_at_row(&self, island: &Island) -> bool {
        self.times.is_none_or(|times| times.are_same(island.motion.time(), self.led_to))
    }

    /// True if the last row was within the last step of an island.
    pub fn is_between_steps(&self) -> bool {
        self.islands.iter().any(|island| !self.is_at_row(island))
    }

    /// True if an island is beyond the next row: a run that is restored here could not observe it.
    pub fn is_beyond_next_row(&self) -> bool {
        let next = self.times.as_ref().map_or(f64::INFINITY, |times| times.of(self.next_row));
        next < self.end() && self.islands.iter().any(|island| island.motion.time() > next)
    }

    /// State of the run, in equally many words at any time.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        let mut words = vec![self.next_row, self.led_to.to_bits()];
        for island in &self.islands {
            words.extend(island.motion.checkpoint()?);
        }
        Ok(words)
    }

    /// Takes up the state of a checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError`] for one of another run.
    pub fn restored(self, words: &[u64]) -> Result<Self, CheckpointError> {
        let [next_row, led_to, states @ ..] = words else { return Err(CheckpointError::Value { what: "its length" }) };
        let (mut states, led_to) = (states, f64::from_bits(*led_to));
        counts(&[*next_row])?;
        finite("the time of the last row", [led_to])?;
        let mut restored = |island: Island| {
            let (state, rest) = states.split_at(island.motion.checkpoint()?.len().min(states.len()));
            states = rest;
            Ok::<_, CheckpointError>(Island { motion: island.motion.restored(state)?, ..island })
        };
        let islands = self.islands.into_iter().map(&mut restored).collect::<Result<_, _>>()?;
        expect("its length", states.is_empty())?;
        Ok(Self { islands, next_row: *next_row, led_to, ..self })
    }
}
