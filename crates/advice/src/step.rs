//! Error of the length of the steps: the run itself, or its beginning, in these steps against far shorter ones.
//!
//! Turning couples the modes, and this coupling is what a step gets wrong that follows each mode by itself exactly. No
//! formula in the step, the spin and the frequencies tells how wrong, and the balance of energy does not either: a mode
//! that swings with the wrong phase has the right energy.

use dynamics::{Observation, Reached, Rows, Setup, SetupError, Simulation, StepControl, StepError};

use crate::table::relative::relative;
use crate::table::row::Row;

/// Most products of the modal matrices that the comparison may cost: some tenths of a second.
const PRODUCTS: f64 = 6e8;
/// Cost of an evaluation of the rates beside these, in as many products.
const BESIDE: f64 = 300.0;
/// Largest step of the comparison times ω_max: where both sides are blind to a mode, they agree on a wrong motion.
const RESOLVED: f64 = 1.5;
/// The step is halved so often at least, and at most.
const HALVINGS: [i32; 2] = [2, 10];
/// Times at which the motions are compared.
const SAMPLES: f64 = 256.0;
/// Fewest steps that are compared.
const FEWEST: f64 = 8.0;
/// The comparison ends where it has cost this many times what it may.
const OVERRUN: f64 = 4.0;
/// Steps between two looks at what it has cost.
const STEPS_AT_ONCE: u64 = 1000;
/// Growth of an error with time that is carried on to the end of the run, as a power.
const STEEPEST: f64 = 2.0;
/// Times 1/(ζ_k ω_k) after which an error that a mode has made is gone.
const FORGOTTEN: f64 = 3.0;
/// An error of the way below this is not worth a word.
const SHOWN: f64 = 1e-9;
/// Deformation and way, over the radius of gyration, that are rounding.
const STILL: f64 = 1e-12;

/// Estimated errors at the end of a run, by the length of its steps.
#[derive(Debug, Clone, PartialEq)]
pub struct StepEstimate {
    /// Length of the steps.
    pub step: f64,
    /// How much shorter the steps were that they were compared with.
    pub finer: f64,
    /// Part of the run that was compared; the errors are carried on to its end where this is below 1.
    pub seen: f64,
    /// Error of the attitude, rad.
    pub attitude: f64,
    /// Error of the centre of mass, relative to its way; 0 where it stays.
    pub position: f64,
    /// Each mode (nf).
    pub modes: Vec<ModeError>,
    /// The step times the rate that sets its length: ω_max, or the spin.
    pub value: f64,
    /// Reason of the failure in these steps, if there is one.
    pub failure: Option<StepError>,
}

/// Estimated error of a mode at the end of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeError {
    /// Error of its coordinate relative to the largest value of it; 0 where it does not swing.
    pub error: f64,
    /// The largest value of its coordinate relative to that of all.
    pub share: f64,
}

impl StepEstimate {
    /// Error of the deformation, relative to the largest modal coordinate.
    pub fn deformation(&self) -> f64 {
        self.modes.iter().map(|mode| mode.error * mode.share).fold(0.0, f64::max)
    }

    /// The largest of the errors of attitude, deformation and position; 1 where the run fails.
    pub fn largest(&self) -> f64 {
        match self.failure {
            Some(_) => 1.0,
            None => self.attitude.max(self.deformation()).max(self.position),
        }
    }

    /// The mode that is furthest off its own largest value, counted from 1, and its error, among those whose share is
    /// not below `share`.
    pub fn worst_mode(&self, share: f64) -> Option<(usize, f64)> {
        let swinging = self.modes.iter().enumerate().filter(|(_, mode)| mode.share >= share && mode.error > 0.0);
        swinging.max_by(|a, b| a.1.error.total_cmp(&b.1.error)).map(|(k, mode)| (k + 1, mode.error))
    }

    /// The estimate as a sentence; modes whose share is below `share` are not named.
    pub fn in_words(&self, share: f64) -> String {
        let Self { step, attitude, position, failure, seen, .. } = self;
        if let Some(failure) = failure {
            return format!("Steps of {step:.1e} fail: {failure}.");
        }
        let mut parts = vec![format!("{attitude:.1e} rad in the attitude")];
        if *position > SHOWN {
            parts.push(format!("{position:.1e} of the way of the centre of mass"));
        }
        if !self.modes.is_empty() {
            parts.push(format!("{:.1e} of the largest modal coordinate", self.deformation()));
        }
        let mode = self.worst_mode(share).map_or_else(String::new, |(mode, error)| {
            format!("; mode {mode} is the worst, {error:.1e} of its own largest value")
        });
        let from = if *seen < 1.0 {
            format!(" (carried on from the first {seen:.1e} of the run; what begins later is not seen)")
        } else {
            String::new()
        };
        format!("Steps of {step:.1e} get wrong at the end{from} about {}{mode}.", parts.join(", "))
    }

    /// The row of the table.
    pub fn row(&self, tolerance: f64) -> Row {
        let influence = relative(self.largest(), 1.0);
        Row {
            value: self.value,
            influence,
            on: influence >= tolerance || influence.is_nan(),
            why: self.in_words(tolerance),
        }
    }
}

/// Estimates what the steps of a run get wrong; nothing under step control, which sees to it itself, and where a load makes the
/// steps so short that the comparison would take long.
///
/// The run is made in its own steps and in steps so short that every mode is resolved. Where that would cost more than
/// some tenths of a second, its beginning stands for it: errors go on growing as they grew in the second half of what was
/// compared, at most with the square of time, and those of a mode for as long as it remembers them.
///
/// # Errors
/// [`SetupError`] of the run itself.
pub fn step_estimate(setup: &Setup) -> Result<Option<StepEstimate>, SetupError> {
    let StepControl::Fixed(longest) = setup.control else { return Ok(None) };
    // Rows cut steps short, too.
    let step = match setup.rows {
        Rows::Interval(interval) => interval / (interval / longest * (1.0 - 1e-12)).ceil().max(1.0),
        Rows::EverySteps(_) => longest,
    };
    let omega = setup.physics.with_highest(&setup.body.circular_frequencies);
    let highest = omega.iter().copied().fold(0.0, f64::max);
    let halvings = (step * highest / RESOLVED).log2().ceil().max(f64::from(HALVINGS[0])).min(f64::from(HALVINGS[1]));
    let finer = halvings.exp2();
    let modes = omega.len() as f64;
    let of_evaluation = 9.0 * modes * modes + BESIDE;
    let cost = f64::from(setup.method.method().evaluations_per_step) * of_evaluation;
    let steps = setup.end / step;
    let compared = (PRODUCTS / (cost * (1.0 + finer))).max(FEWEST).min(steps);
    let each = (compared / SAMPLES).ceil();
    let interval = (each * step).min(setup.end);
    let samples = if compared < steps { (compared / each).ceil() as usize } else { usize::MAX };

    let begin = |step: f64| {
        Simulation::new(&Setup {
            control: StepControl::Fixed(step),
            rows: Rows::Interval(interval),
            points: &[],
            ..setup.clone()
        })
    };
    let mut comparison = Comparison::new(setup);
    // Loads may ask for steps far shorter than those of the run.
    let max_evaluations = (OVERRUN * PRODUCTS.max(FEWEST * (1.0 + finer) * cost) / of_evaluation) as u64;
    let failure = comparison.follow(begin(step)?, begin(step / finer)?, samples, max_evaluations).err();
    if comparison.times.is_empty() && failure.is_none() {
        return Ok(None);
    }
    Ok(Some(comparison.estimate(setup, step, finer, failure)))
}

/// Two motions side by side.
struct Comparison {
    /// Largest differences up to each time.
    times: Vec<f64>,
    attitude: Vec<f64>,
    position: Vec<f64>,
    /// nf for each time.
    modes: Vec<f64>,
    /// Largest values.
    way: f64,
    peaks: Vec<f64>,
    spin: f64,
}

impl Comparison {
    fn new(setup: &Setup) -> Self {
        let list = Vec::new;
        Self {
            times: list(),
            attitude: list(),
            position: list(),
            modes: list(),
            way: 0.0,
            peaks: vec![0.0; setup.body.flexible()],
            spin: setup.initial.omega.norm(),
        }
    }

    /// Follows both until the end, for a number of `samples`, or for a number of evaluations of the rates.
    fn follow(
        &mut self,
        mut a: Simulation,
        mut b: Simulation,
        samples: usize,
        max_evaluations: u64,
    ) -> Result<(), StepError> {
        let (mut of_a, mut of_b) = (a.observation()?, b.observation()?);
        let start = of_a.position_global;
        while self.times.len() < samples && next_row(&mut a, &mut of_a, max_evaluations)? {
            // That the shorter steps fail says nothing about those of the run.
            if !next_row(&mut b, &mut of_b, max_evaluations).unwrap_or(false) {
                break;
            }
            self.add(&of_a, &of_b);
            self.way = self.way.max((of_b.position_global - start).norm());
        }
        Ok(())
    }

    fn add(&mut self, a: &Observation, b: &Observation) {
        let grown = |list: &[f64], value: f64| list.last().copied().unwrap_or(0.0).max(value);
        let modes = self.modes.len();
        self.times.push(a.time);
        self.attitude.push(grown(&self.attitude, a.attitude.angle_to(&b.attitude)));
        self.position.push(grown(&self.position, (a.position_global - b.position_global).norm()));
        let nf = self.peaks.len();
        for (k, (a, b)) in a.modal_displacement.iter().zip(&b.modal_displacement).enumerate() {
            let before = if modes == 0 { 0.0 } else { self.modes[modes - nf + k] };
            self.modes.push(before.max((a - b).abs()));
            self.peaks[k] = self.peaks[k].max(b.abs());
        }
        self.spin = self.spin.max(b.omega_body.norm());
    }

    fn estimate(self, setup: &Setup, step: f64, finer: f64, failure: Option<StepError>) -> StepEstimate {
        let body = setup.body;
        // The finer steps err, too.
        let order = f64::from(setup.method.method().order);
        let short = 1.0 / (1.0 - finer.powf(-order));
        let count = self.times.len();
        let seen = self.times.last().copied().unwrap_or(0.0);
        let until = |end: f64, error: &dyn Fn(usize) -> f64| -> f64 {
            if count == 0 {
                return 0.0;
            }
            let last = short * error(count - 1);
            let half = self.times.partition_point(|time| *time < 0.5 * seen).min(count - 1);
            let grown = error(count - 1) / error(half);
            let longer = (end / seen).max(1.0);
            if grown.is_finite() && count > 1 {
                let power = (grown.ln() / (seen / self.times[half]).ln()).min(STEEPEST);
                last * longer.powf(power.max(0.0))
            } else {
                last * longer
            }
        };
        let radius = (0.5 * body.inertia.trace() / body.mass).sqrt();
        let still = STILL * radius;
        let largest = self.peaks.iter().copied().fold(0.0, f64::max);
        let nf = self.peaks.len();
        let mode = |k: usize| {
            let peak = self.peaks[k];
            if largest <= still * body.mass.sqrt() || peak <= STILL * largest {
                return ModeError { error: 0.0, share: 0.0 };
            }
            let decay = setup.damping_ratios[k] * body.circular_frequencies[k];
            let end = setup.end.min(seen.max(FORGOTTEN / decay));
            ModeError { error: until(end, &|i| self.modes[nf * i + k]) / peak, share: peak / largest }
        };
        let frequencies = setup.physics.with_highest(&body.circular_frequencies);
        let highest = frequencies.into_iter().fold(0.0, f64::max);
        StepEstimate {
            step,
            finer,
            seen: if failure.is_none() { seen / setup.end } else { 1.0 },
            attitude: until(setup.end, &|i| self.attitude[i]),
            position: if self.way <= still { 0.0 } else { until(setup.end, &|i| self.position[i]) / self.way },
            modes: (0..nf).map(mode).collect(),
            value: step * if setup.method.method().is_limited_by_modes() { highest } else { self.spin },
            failure,
        }
    }
}

/// Goes on to the next row; `false` at the end, and where all evaluations have been made.
fn next_row(simulation: &mut Simulation, out: &mut Observation, max_evaluations: u64) -> Result<bool, StepError> {
    while simulation.stats().evaluations < max_evaluations {
        match simulation.advance(STEPS_AT_ONCE)? {
            Reached::Row => {
                simulation.observe([out])?;
                return Ok(true);
            }
            Reached::End => return Ok(false),
            _ => {}
        }
    }
    Ok(false)
}
