//! One run of all bodies, observed at the times of comparison, and the errors of one run against another.

use std::time::{Duration, Instant};

use dynamics::{Observation, PointMotion, Reached};
use model::Model;
use nalgebra::Vector3;
use serde::Serialize;

use crate::commands::run::{Monitor, RunFailure};
use crate::files::json;
use crate::motion::{Motion, Moving};

/// Motion smaller than this fraction of the body is rounding.
const STILL: f64 = 1e-12;

/// Steps between two looks at the clock. Shorter runs come to their end whatever the patience is.
const STEPS_PER_LOOK: u64 = 1000;

/// Leads motions to their end, one after the other, until its patience is used up.
struct Watch {
    started: Instant,
    patience: Duration,
    motions: usize,
    /// Motions that have come to their end.
    ended: usize,
    /// Steps of the present motion tried at the last look.
    looked: u64,
}

impl Watch {
    fn new(patience: Duration, motions: usize) -> Self {
        Self { started: Instant::now(), patience, motions, ended: 0, looked: 0 }
    }

    /// Leads a motion to its end.
    fn lead(
        &mut self,
        motion: &mut Motion,
        mut at_row: impl FnMut(&mut Motion) -> Result<(), RunFailure>,
    ) -> Result<(), RunFailure> {
        while self.advance(motion)? != Reached::End {
            at_row(motion)?;
        }
        self.ended += 1;
        self.looked = 0;
        Ok(())
    }

    /// Goes on to the next row, or to the end.
    fn advance(&mut self, motion: &mut Motion) -> Result<Reached, RunFailure> {
        loop {
            let reached = motion.advance(STEPS_PER_LOOK, |_, _| ())?;
            let tried = motion.tried();
            // What has come to its end need not be stopped.
            if motion.time() < motion.end() && tried - self.looked >= STEPS_PER_LOOK {
                self.looked = tried;
                if self.started.elapsed() >= self.patience {
                    let reached = (self.ended as f64 + motion.time() / motion.end()) / self.motions as f64;
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
    /// Leads motions to their end, if that takes no longer than the patience.
    pub(super) fn follow(motions: Vec<Moving>, patience: Duration) -> Result<Self, RunFailure> {
        let mut watch = Watch::new(patience, motions.len());
        let count = motions.iter().map(|moving| moving.bodies.len()).sum();
        let mut all = Self {
            bodies: vec![Vec::new(); count],
            steps: 0,
            rejected: 0,
            evaluations: 0,
            energy: 0.0,
            angular_momentum: 0.0,
            time: Duration::ZERO,
        };
        for Moving { mut motion, bodies, .. } in motions {
            let mut monitors = vec![Monitor::default(); bodies.len()];
            let mut row = rooms(&motion)?;
            let mut observe = |motion: &mut Motion| -> Result<(), RunFailure> {
                motion.observe(None, &mut row)?;
                for ((now, monitor), number) in row.iter().zip(&mut monitors).zip(&bodies) {
                    monitor.watch(now);
                    all.bodies[*number].push(now.clone());
                }
                Ok(())
            };
            observe(&mut motion)?;
            watch.lead(&mut motion, observe)?;
            // Tied bodies pass momentum and energy to each other.
            let scales = monitors.iter().map(Monitor::scales).reduce(|most, scales| most.or_larger(&scales));
            for mut monitor in monitors {
                scales.iter().for_each(|scales| monitor.widen(scales));
                let balances = monitor.balances();
                all.energy = all.energy.max(balances.energy);
                all.angular_momentum = all.angular_momentum.max(balances.angular_momentum);
            }
            let stats = motion.stats();
            all.steps += stats.accepted;
            all.rejected += stats.rejected;
            all.evaluations += stats.evaluations;
        }
        all.time = watch.started.elapsed();
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

/// Room for the bodies of a motion.
fn rooms(motion: &Motion) -> Result<Vec<Observation>, RunFailure> {
    Ok(match motion {
        Motion::Alone(simulation) => vec![simulation.clone().observation()?],
        Motion::Tied(simulation) => {
            (0..simulation.motion().system().bodies().len()).map(|body| simulation.room(body)).collect()
        }
    })
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
    /// Leads the motions from their beginning at least three times, and so often that it takes `at_least` in all. A run that
    /// takes longer than the patience is the last, and does not count.
    ///
    /// # Errors
    /// The error of the first run.
    pub(super) fn of(motions: &[Moving], at_least: Duration, patience: Duration) -> Result<Self, RunFailure> {
        let mut timing = Self { shortest: Duration::MAX, longest: Duration::ZERO, repeats: 0 };
        let mut sum = Duration::ZERO;
        while timing.repeats < 3 || (sum < at_least && timing.repeats < 1000) {
            let mut motions = motions.to_vec();
            let mut watch = Watch::new(patience, motions.len());
            match motions.iter_mut().try_for_each(|moving| watch.lead(&mut moving.motion, |_| Ok(()))) {
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
pub(super) fn seconds_per_step(motions: &[Moving], at_least: Duration) -> Result<f64, RunFailure> {
    let mut shortest = f64::INFINITY;
    for _ in 0..3 {
        let mut motions = motions.to_vec();
        let mut watch = Watch::new(at_least, motions.len());
        match motions.iter_mut().try_for_each(|moving| watch.lead(&mut moving.motion, |_| Ok(()))) {
            Ok(()) | Err(RunFailure::OutOfPatience { .. }) => {}
            Err(failure) => return Err(failure),
        }
        let steps: u64 = motions.iter().map(|moving| moving.motion.stats().accepted).sum();
        shortest = shortest.min(watch.started.elapsed().as_secs_f64() / steps.max(1) as f64);
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
