//! One run, observed at the times of comparison, and the errors of one run against another.

use std::time::{Duration, Instant};

use dynamics::{Observation, PointMotion, Reached, Simulation, Stats};
use model::Model;
use nalgebra::Vector3;
use serde::Serialize;

use crate::commands::run::{Balances, Monitor, RunFailure};
use crate::files::json;

/// Motion smaller than this fraction of the body is rounding.
const STILL: f64 = 1e-12;

/// Steps between two looks at the clock. Shorter runs come to their end whatever the patience is.
const STEPS_PER_LOOK: u64 = 1000;

/// Leads a run on until its patience is used up.
struct Watch {
    started: Instant,
    patience: Duration,
    /// Steps tried at the last look.
    looked: u64,
}

impl Watch {
    fn new(patience: Duration) -> Self {
        Self { started: Instant::now(), patience, looked: 0 }
    }

    /// Goes on to the next row, or to the end.
    fn advance(&mut self, simulation: &mut Simulation) -> Result<Reached, RunFailure> {
        loop {
            let reached = simulation.advance(STEPS_PER_LOOK)?;
            let stats = simulation.stats();
            let tried = stats.accepted + stats.rejected;
            // What has come to its end need not be stopped.
            if simulation.time() < simulation.end() && tried - self.looked >= STEPS_PER_LOOK {
                self.looked = tried;
                if self.started.elapsed() >= self.patience {
                    let reached = simulation.time() / simulation.end();
                    return Err(RunFailure::OutOfPatience { patience: self.patience.as_secs_f64(), reached });
                }
            }
            if reached != Reached::Between {
                return Ok(reached);
            }
        }
    }
}

/// A run, observed at equally spaced times.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    /// At the beginning and after each interval.
    pub observations: Vec<Observation>,
    pub stats: Stats,
    pub balances: Balances,
    /// How long it took, observations included.
    pub time: Duration,
}

impl Trajectory {
    /// Runs a simulation to its end, if that takes no longer than the patience.
    pub(super) fn follow(mut simulation: Simulation, patience: Duration) -> Result<Self, RunFailure> {
        let mut watch = Watch::new(patience);
        let mut observations = Vec::new();
        let mut monitor = Monitor::default();
        let mut observe = |simulation: &mut Simulation| -> Result<(), RunFailure> {
            let now = simulation.observation()?;
            monitor.watch(&now);
            observations.push(now);
            Ok(())
        };
        observe(&mut simulation)?;
        while watch.advance(&mut simulation)? != Reached::End {
            observe(&mut simulation)?;
        }
        let balances = monitor.balances();
        Ok(Self { observations, stats: simulation.stats(), balances, time: watch.started.elapsed() })
    }

    /// |ω| at the end.
    pub(super) fn final_spin(&self) -> f64 {
        self.observations.last().map_or(0.0, |last| last.omega_body.norm())
    }
}

/// Time that the loop of a run takes, without the observations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timing {
    /// The shortest.
    pub shortest: Duration,
    /// The longest.
    pub longest: Duration,
    pub repeats: u32,
}

impl Timing {
    /// Runs the simulation from its beginning at least three times, and so often that it takes `at_least` in all. A run that
    /// takes longer than the patience is the last, and does not count.
    ///
    /// # Errors
    /// The error of the first run.
    pub(super) fn of(simulation: &Simulation, at_least: Duration, patience: Duration) -> Result<Self, RunFailure> {
        let mut timing = Self { shortest: Duration::MAX, longest: Duration::ZERO, repeats: 0 };
        let mut sum = Duration::ZERO;
        while timing.repeats < 3 || (sum < at_least && timing.repeats < 1000) {
            let mut simulation = simulation.clone();
            let mut watch = Watch::new(patience);
            let ended = loop {
                match watch.advance(&mut simulation) {
                    Ok(Reached::End) => break Ok(()),
                    Ok(_) => {}
                    Err(failure) => break Err(failure),
                }
            };
            match ended {
                Err(RunFailure::OutOfPatience { .. }) if timing.repeats > 0 => break,
                ended => ended?,
            }
            let time = watch.started.elapsed();
            timing.shortest = timing.shortest.min(time);
            timing.longest = timing.longest.max(time);
            timing.repeats += 1;
            sum += time;
        }
        Ok(timing)
    }
}

/// Time of a step, seconds: the shortest of the means over three stretches from the beginning of the run, each of which
/// takes `at_least` or the whole run.
pub(super) fn seconds_per_step(simulation: &Simulation, at_least: Duration) -> Result<f64, RunFailure> {
    let mut shortest = f64::INFINITY;
    for _ in 0..3 {
        let mut simulation = simulation.clone();
        let mut watch = Watch::new(at_least);
        loop {
            match watch.advance(&mut simulation) {
                Ok(Reached::End) | Err(RunFailure::OutOfPatience { .. }) => break,
                Ok(_) => {}
                Err(failure) => return Err(failure),
            }
        }
        let steps = simulation.stats().accepted.max(1) as f64;
        shortest = shortest.min(watch.started.elapsed().as_secs_f64() / steps);
    }
    Ok(shortest)
}

/// Sizes of the quantities that are compared; an error is relative to the largest value in the reference, unless that
/// is below this.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    modal: f64,
    displacement: f64,
    velocity: f64,
    acceleration: f64,
}

impl Scales {
    /// Scales below which a motion of a body of this size and mass is none.
    pub(super) fn of_body(model: &Model, end: f64) -> Self {
        let size = match &model.meshed {
            Some(meshed) => meshed.mesh.diagonal(),
            None => (model.body.inertia.trace() / model.body.mass).sqrt(),
        };
        let length = STILL * size;
        let modal = length * model.body.mass.sqrt();
        Self { modal, displacement: length, velocity: length / end, acceleration: length / (end * end) }
    }
}

/// Largest errors of a run over the times of comparison.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Errors {
    /// Angle to the reference's attitude, rad.
    #[serde(serialize_with = "json::number")]
    pub attitude: f64,
    /// Modal coordinates, relative to the largest of the reference; none where nothing vibrates.
    #[serde(serialize_with = "json::optional")]
    pub modal: Option<f64>,
    /// Displacement of the points, relative to the largest of the reference; none without points or where they rest.
    #[serde(serialize_with = "json::optional")]
    pub displacement: Option<f64>,
    /// Velocity of the points, likewise.
    #[serde(serialize_with = "json::optional")]
    pub velocity: Option<f64>,
    /// Acceleration of the points, likewise.
    #[serde(serialize_with = "json::optional")]
    pub acceleration: Option<f64>,
}

impl Errors {
    /// Errors of `run` against `reference`, at the times that both have. Modes that only one of them has are left out.
    pub(super) fn between(run: &Trajectory, reference: &Trajectory, scales: &Scales) -> Self {
        let (ours, theirs) = (&run.observations, &reference.observations);
        let stride = |list: &[Observation], other: &[Observation]| {
            (list.len().saturating_sub(1) / other.len().saturating_sub(1).max(1)).max(1)
        };
        let pairs = || {
            let theirs = theirs.iter().step_by(stride(theirs, ours));
            ours.iter().step_by(stride(ours, &reference.observations)).zip(theirs)
        };
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let relative = |error: f64, peak: f64, still: f64| (peak > still).then(|| error / peak);

        let modal_peak = largest(&mut theirs.iter().flat_map(|o| &o.modal_displacement).map(|q| q.abs()));
        let modal = largest(
            &mut pairs()
                .flat_map(|(a, b)| a.modal_displacement.iter().zip(&b.modal_displacement).map(|(a, b)| (a - b).abs())),
        );
        let of_points = |part: fn(&PointMotion) -> Vector3<f64>, still: f64| {
            let peak = largest(&mut theirs.iter().flat_map(|o| &o.points).map(|p| part(p).norm()));
            let error = largest(
                &mut pairs().flat_map(|(a, b)| a.points.iter().zip(&b.points).map(|(a, b)| (part(a) - part(b)).norm())),
            );
            relative(error, peak, still)
        };
        Self {
            attitude: largest(&mut pairs().map(|(a, b)| a.attitude.angle_to(&b.attitude))),
            modal: relative(modal, modal_peak, scales.modal),
            displacement: of_points(|p| p.displacement, scales.displacement),
            velocity: of_points(|p| p.velocity, scales.velocity),
            acceleration: of_points(|p| p.acceleration, scales.acceleration),
        }
    }

    /// The largest of them: the error of a run.
    pub fn largest(&self) -> f64 {
        self.worst().1
    }

    /// Name and value of the largest.
    pub(super) fn worst(&self) -> (&'static str, f64) {
        let attitude = ("attitude", self.attitude);
        self.named().fold(attitude, |worst, error| if error.1 > worst.1 { error } else { worst })
    }

    /// Name and value of each.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [
            ("attitude", Some(self.attitude)),
            ("modal coordinates", self.modal),
            ("displacement of the points", self.displacement),
            ("velocity of the points", self.velocity),
            ("acceleration of the points", self.acceleration),
        ]
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)))
    }

    /// All of them times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let scaled = |value: Option<f64>| value.map(|value| factor * value);
        Self {
            attitude: factor * self.attitude,
            modal: scaled(self.modal),
            displacement: scaled(self.displacement),
            velocity: scaled(self.velocity),
            acceleration: scaled(self.acceleration),
        }
    }
}
