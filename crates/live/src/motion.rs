//! A motion that is led to a time.

use dynamics::{
    CustomError, MotionState, Observation, Reached, Rows, RunDescription, SetupError, Simulation, StepControl,
    StepError,
};

/// A motion with what is seen of its bodies at the time that it has been led to.
#[derive(Debug)]
pub(crate) struct Motion {
    simulation: Simulation,
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
        let mut simulation = run.begin()?;
        if let Some(states) = states {
            simulation.set_states(states)?;
        }
        simulation.keep_last_step();
        let begun = simulation.time();
        let observations = (0..run.bodies.len()).map(|body| simulation.room(body)).collect();
        let mut motion = Self { simulation, begun, interval, observations };
        motion.lead_to(begun).map_err(|error| SetupError::Custom(CustomError::new(error)))?;
        Ok(motion)
    }

    /// The time at which it ends.
    pub fn end(&self) -> f64 {
        self.simulation.end()
    }

    /// Steps as far as a time: of a body that nothing ties to it, within the last step; of bodies in joints to the last row at or before it.
    pub fn lead_to(&mut self, time: f64) -> Result<(), StepError> {
        let Self { simulation, begun, interval, observations } = self;
        let Some(interval) = *interval else {
            while simulation.time() < time && simulation.advance(1)? != Reached::End {}
            let within = time.clamp(*begun, simulation.time());
            return simulation.interpolate(within, observations);
        };
        let same = ROUNDING * interval;
        let next_row = |now: f64| ((now + same) / interval).floor() * interval + interval;
        while !simulation.is_over() && next_row(simulation.time()).min(simulation.end()) <= time + same {
            while simulation.advance(1)? == Reached::Between {}
        }
        simulation.observe(observations)
    }

    /// The state of each body at the time that has been reached: of a body that nothing ties the end of the last step.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        self.simulation.states()
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.simulation.stats().accepted
    }

    /// Says that something that a load reads has been changed.
    pub fn loads_have_changed(&mut self) {
        self.simulation.loads_have_changed();
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
