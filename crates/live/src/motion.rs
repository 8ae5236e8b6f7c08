//! A motion that is led to a time.

use dynamics::{
    CustomError, IslandMotion, MotionState, Observation, Reached, Rows, RunDescription, SetupError, StepControl,
    StepError,
};

/// A motion with what is seen of its bodies at the time that it has been led to.
#[derive(Debug)]
pub(crate) struct Motion {
    island: IslandMotion,
    /// The time at which it began.
    begun: f64,
    /// The interval of rows of bodies in joints: between them they are not seen.
    interval: Option<f64>,
    pub observations: Vec<Observation>,
}

/// Part of the interval of rows by which a row may be missed.
const ROUNDING: f64 = 1e-9;

impl Motion {
    /// Begins a run, or goes on with it from `states`.
    pub fn begin(run: &RunDescription, states: Option<&[MotionState]>) -> Result<Self, SetupError> {
        let interval = match (run.method.joints, run.rows) {
            (None, _) => None,
            (Some(_), Rows::Interval(interval)) => Some(interval),
            (Some(_), Rows::EverySteps(_)) => {
                let (what, expected) = ("the rows of a system", "an interval");
                return Err(SetupError::Value { what, found: f64::NAN, expected });
            }
        };
        let mut island = run.begin()?;
        if let Some(states) = states {
            island.set_states(states)?;
        }
        island.keep_last_step();
        let begun = island.time();
        let observations = (0..run.bodies.len()).map(|body| island.room(body)).collect();
        let mut motion = Self { island, begun, interval, observations };
        motion.lead_to(begun).map_err(|error| SetupError::Custom(CustomError::new(error)))?;
        Ok(motion)
    }

    /// The time at which it ends.
    pub fn end(&self) -> f64 {
        self.island.end()
    }

    /// Steps as far as a time: of a body that nothing ties to it, within the last step; of bodies in joints to the last row at or before it.
    pub fn lead_to(&mut self, time: f64) -> Result<(), StepError> {
        let Self { island, begun, interval, observations } = self;
        let Some(interval) = *interval else {
            while island.time() < time && island.advance(1, |_, _| {})? != Reached::End {}
            let within = time.clamp(*begun, island.time());
            return island.observe(Some(within), observations);
        };
        let same = ROUNDING * interval;
        let next_row = |now: f64| ((now + same) / interval).floor() * interval + interval;
        while !island.is_over() && next_row(island.time()).min(island.end()) <= time + same {
            while island.advance(1, |_, _| {})? == Reached::Between {}
        }
        island.observe(None, observations)
    }

    /// The state of each body at the time that has been reached: of a body that nothing ties the end of the last step.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        self.island.states()
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.island.stats().accepted
    }

    /// Says that something that a load reads has been changed.
    pub fn loads_have_changed(&mut self) {
        self.island.loads_have_changed();
    }
}

/// Lets a run go on until another time, with the same errors allowed per time.
pub(crate) fn prolong(run: &mut RunDescription, until: f64) {
    if let StepControl::Tolerance(tolerance) = &mut run.control {
        *tolerance *= until / run.end;
    }
    run.end = until;
}

/// Gives the rows of bodies in joints an interval of at most `longest`, so that they are seen as often: these rows end no steps.
pub(crate) fn show_every(run: &mut RunDescription, longest: f64) {
    if run.method.joints.is_some() {
        let recorded = match run.rows {
            Rows::Interval(interval) => interval,
            Rows::EverySteps(_) => run.end,
        };
        run.rows = Rows::Interval(recorded / (recorded / longest - ROUNDING).ceil().max(1.0));
    }
}
