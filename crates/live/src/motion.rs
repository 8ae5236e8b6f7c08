//! A motion that is led to a time: of a body alone, or of a system.

use dynamics::{
    CustomError, DescribedBody, MotionState, Observation, Reached, Rows, RunDescription, RunOfBody, RunOfSystem,
    SetupError, Simulation, StepControl, StepError, SystemSimulation,
};

/// A motion with what is seen of its bodies at the time that it has been led to.
#[derive(Debug)]
pub(crate) struct Motion {
    simulation: Leading,
    pub observations: Vec<Observation>,
}

#[derive(Debug)]
enum Leading {
    /// With the time at which it began.
    Alone(Box<Simulation>, f64),
    /// With its interval of rows: between them it is not seen.
    Tied(Box<SystemSimulation>, f64),
}

/// Part of the interval of rows by which a row may be missed.
const ROUNDING: f64 = 1e-9;

impl Motion {
    /// Begins a run, or goes on with it from `states`.
    pub fn begin(run: &RunDescription, states: Option<&[MotionState]>) -> Result<Self, SetupError> {
        let simulation = match run {
            RunDescription::Alone(run) => {
                let mut simulation = run.begin()?;
                if let Some(state) = states.and_then(<[_]>::first) {
                    simulation.set_state(state)?;
                }
                simulation.keep_last_step();
                let begun = simulation.time();
                Leading::Alone(Box::new(simulation), begun)
            }
            RunDescription::Tied(run) => {
                let Rows::Interval(interval) = run.rows else {
                    let (what, expected) = ("the rows of a system", "an interval");
                    return Err(SetupError::Value { what, found: f64::NAN, expected });
                };
                let mut simulation = run.begin()?;
                if let Some(states) = states {
                    simulation.set_states(states)?;
                }
                Leading::Tied(Box::new(simulation), interval)
            }
        };
        let room = |body: &DescribedBody| Observation::new(body.damping_ratios.len(), body.points.len());
        let mut begun = Self { simulation, observations: run.bodies().iter().map(room).collect() };
        begun.lead_to(begun.time()).map_err(|error| SetupError::Custom(CustomError::new(error)))?;
        Ok(begun)
    }

    /// The time that the steps have come to.
    pub fn time(&self) -> f64 {
        match &self.simulation {
            Leading::Alone(simulation, _) => simulation.time(),
            Leading::Tied(simulation, _) => simulation.time(),
        }
    }

    /// The time at which it ends.
    pub fn end(&self) -> f64 {
        match &self.simulation {
            Leading::Alone(simulation, _) => simulation.end(),
            Leading::Tied(simulation, _) => simulation.end(),
        }
    }

    /// Steps as far as a time: of a body alone to it, within the last step; of a system to the last row at or before it.
    pub fn lead_to(&mut self, time: f64) -> Result<(), StepError> {
        match &mut self.simulation {
            Leading::Alone(simulation, begun) => {
                while simulation.time() < time && simulation.advance(1)? != Reached::End {}
                let time = time.clamp(*begun, simulation.time());
                self.observations.iter_mut().try_for_each(|out| simulation.interpolate(time, out))
            }
            Leading::Tied(simulation, interval) => {
                let same = ROUNDING * *interval;
                let next_row = |now: f64| ((now + same) / *interval).floor() * *interval + *interval;
                while !simulation.is_over() && next_row(simulation.time()).min(simulation.end()) <= time + same {
                    while simulation.advance(1)? == Reached::Between {}
                }
                simulation.observe(&mut self.observations)
            }
        }
    }

    /// The state of each body at the time that has been reached: of a body alone the end of the last step.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        match &self.simulation {
            Leading::Alone(simulation, _) => Ok(vec![simulation.state()?]),
            Leading::Tied(simulation, _) => {
                let (motion, time) = (simulation.motion(), simulation.time());
                let state = |body| motion.state(body).map_err(|error| error.in_step(time, 0.0));
                (0..motion.system().bodies().len()).map(state).collect()
            }
        }
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        match &self.simulation {
            Leading::Alone(simulation, _) => simulation.stats().accepted,
            Leading::Tied(simulation, _) => simulation.stats().accepted,
        }
    }

    /// Says that something that a load reads has been changed.
    pub fn loads_have_changed(&mut self) {
        match &mut self.simulation {
            Leading::Alone(simulation, _) => simulation.loads_have_changed(),
            Leading::Tied(simulation, _) => simulation.loads_have_changed(),
        }
    }
}

/// End of a run.
pub(crate) fn end(run: &RunDescription) -> f64 {
    match run {
        RunDescription::Alone(run) => run.end,
        RunDescription::Tied(run) => run.end,
    }
}

/// Lets a run go on until another time, with the same errors allowed per time.
pub(crate) fn prolong(run: &mut RunDescription, until: f64) {
    match run {
        RunDescription::Alone(run) => {
            let RunOfBody { control, end, .. } = &mut **run;
            if let StepControl::Tolerance(tolerance) = control {
                *tolerance *= until / *end;
            }
            *end = until;
        }
        RunDescription::Tied(run) => {
            let RunOfSystem { end, .. } = &mut **run;
            *end = until;
        }
    }
}

/// Gives the rows of a system an interval of at most `longest`, so that it is seen as often: rows of a system end no steps.
pub(crate) fn show_every(run: &mut RunDescription, longest: f64) {
    if let RunDescription::Tied(run) = run {
        let recorded = match run.rows {
            Rows::Interval(interval) => interval,
            Rows::EverySteps(_) => run.end,
        };
        run.rows = Rows::Interval(recorded / (recorded / longest - ROUNDING).ceil().max(1.0));
    }
}
