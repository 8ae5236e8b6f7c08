//! One run of all bodies, observed at the times of comparison, and the errors of one run against another.

use std::time::{Duration, Instant};

use dynamics::{Island, Observation, PointMotion, Reached, Run};
use model::Model;
use nalgebra::Vector3;
use serde::Serialize;

use crate::commands::run::{Monitor, RunFailure};
use crate::files::json;

/// Motion smaller than this fraction of the body is rounding.
const STILL: f64 = 1e-12;

/// Steps between two looks at the clock. Shorter runs come to their end whatever the patience is.
const STEPS_PER_LOOK: u64 = 1000;

/// Leads a run to its end, calling at each row, until its patience is used up.
fn lead(
    run: &mut Run,
    patience: Duration,
    mut at_row: impl FnMut(&mut Run) -> Result<(), RunFailure>,
) -> Result<(), RunFailure> {
    let started = Instant::now();
    let mut looked = 0;
    loop {
        let reached = run.advance(STEPS_PER_LOOK, |_, _| ())?;
        match reached {
            Reached::End => return Ok(()),
            Reached::Between => {}
            _ => at_row(run)?,
        }
        // What has come to its end need not be stopped.
        if run.time() < run.end() && run.tried() - looked >= STEPS_PER_LOOK {
            looked = run.tried();
            if started.elapsed() >= patience {
                let reached = run.time() / run.end();
                return Err(RunFailure::OutOfPatience { patience: patience.as_secs_f64(), reached });
            }
        }
    }
}

/// A run, observed at equally spaced times.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    /// States of each body at the beginning and after each interval.
    pub bodies: Vec<Vec<Observation>>,
    /// Steps of all bodies.
    pub steps: u64,
    /// Steps tried in vain.
    pub rejected: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// How far the balance of energy is from closed, of the worst body.
    pub energy: f64,
    /// The same of angular momentum.
    pub angular_momentum: f64,
    /// How long it took, observations included.
    pub time: Duration,
}

impl Trajectory {
    /// Leads a run to its end, if that takes no longer than the patience.
    pub(super) fn follow(mut run: Run, patience: Duration) -> Result<Self, RunFailure> {
        let started = Instant::now();
        let mut row = run.room();
        let mut joints = run.room_of_joints();
        let mut bodies = vec![Vec::new(); row.len()];
        let mut monitors = vec![Monitor::default(); row.len()];
        let mut observe = |run: &mut Run| -> Result<(), RunFailure> {
            run.observe(&mut row, &mut joints)?;
            for ((now, monitor), of) in row.iter().zip(&mut monitors).zip(&mut bodies) {
                monitor.watch(now);
                of.push(now.clone());
            }
            Ok(())
        };
        observe(&mut run)?;
        lead(&mut run, patience, observe)?;
        let mut all = Self {
            bodies,
            steps: run.steps(),
            rejected: run.tried() - run.steps(),
            evaluations: run.islands().iter().map(|island| island.motion.stats().evaluations).sum(),
            energy: 0.0,
            angular_momentum: 0.0,
            time: started.elapsed(),
        };
        for Island { bodies, .. } in run.islands() {
            Monitor::widen_together(&mut monitors, bodies, |monitor| monitor);
            for body in bodies {
                let balances = monitors[*body].balances();
                all.energy = all.energy.max(balances.energy);
                all.angular_momentum = all.angular_momentum.max(balances.angular_momentum);
            }
        }
        Ok(all)
    }

    /// |ω| at the end over that of another run, less one, of the body where that is farthest from zero; none where no body
    /// spins.
    pub(super) fn spin_against(&self, other: &Self) -> Option<f64> {
        let spin = |body: &Vec<Observation>| body.last().map_or(0.0, |last| last.omega_body.norm());
        let spins = self.bodies.iter().zip(&other.bodies).map(|(ours, theirs)| (spin(ours), spin(theirs)));
        let changes = spins.filter(|(_, theirs)| *theirs > 0.0).map(|(ours, theirs)| ours / theirs - 1.0);
        changes.max_by(|a, b| a.abs().total_cmp(&b.abs()))
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
    /// Leads the run from its start at least three times, and so often that it takes `at_least` in all. A run that
    /// takes longer than the patience is the last, and does not count.
    ///
    /// # Errors
    /// The error of the first run.
    pub(super) fn of(run: &Run, at_least: Duration, patience: Duration) -> Result<Self, RunFailure> {
        let mut timing = Self { shortest: Duration::MAX, longest: Duration::ZERO, repeats: 0 };
        let mut sum = Duration::ZERO;
        while timing.repeats < 3 || (sum < at_least && timing.repeats < 1000) {
            let mut run = run.clone();
            let started = Instant::now();
            match lead(&mut run, patience, |_| Ok(())) {
                Err(RunFailure::OutOfPatience { .. }) if timing.repeats > 0 => break,
                ended => ended?,
            }
            let time = started.elapsed();
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
pub(super) fn seconds_per_step(run: &Run, at_least: Duration) -> Result<f64, RunFailure> {
    let mut shortest = f64::INFINITY;
    for _ in 0..3 {
        let mut run = run.clone();
        let started = Instant::now();
        match lead(&mut run, at_least, |_| Ok(())) {
            Ok(()) | Err(RunFailure::OutOfPatience { .. }) => {}
            Err(failure) => return Err(failure),
        }
        shortest = shortest.min(started.elapsed().as_secs_f64() / run.steps().max(1) as f64);
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
    /// Errors of `run` against `reference`, at the times that both have: of each quantity, of the worst body. Modes that only one of
    /// them has are left out.
    pub(super) fn between(run: &Trajectory, reference: &Trajectory, scales: &[Scales]) -> Self {
        let bodies = run.bodies.iter().zip(&reference.bodies).zip(scales);
        bodies.map(|((ours, theirs), scales)| Self::of_body(ours, theirs, scales)).fold(Self::default(), Self::or_worse)
    }

    /// The larger of each.
    fn or_worse(self, other: Self) -> Self {
        let worse = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
        Self {
            attitude: self.attitude.max(other.attitude),
            modal: worse(self.modal, other.modal),
            displacement: worse(self.displacement, other.displacement),
            velocity: worse(self.velocity, other.velocity),
            acceleration: worse(self.acceleration, other.acceleration),
        }
    }

    fn of_body(ours: &[Observation], theirs: &[Observation], scales: &Scales) -> Self {
        let stride = |list: &[Observation], other: &[Observation]| {
            (list.len().saturating_sub(1) / other.len().saturating_sub(1).max(1)).max(1)
        };
        let pairs = || {
            let compared = theirs.iter().step_by(stride(theirs, ours));
            ours.iter().step_by(stride(ours, theirs)).zip(compared)
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
