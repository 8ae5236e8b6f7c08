//! From the motion of the bodies to the rows of the results file.

use std::sync::atomic::Ordering;
use std::time::Instant;

use dynamics::{JointObservation, Reached, StepError};
use results::{BodyResults, Results, Writer};
use scene::{Scene, StepControl};

use super::body::{FollowedBody, RunBody};
use super::body_report::BodyRunReport;
use super::checkpoint::checkpoint;
use super::error::RunError;
use super::estimate::Estimate;
use super::mover::{Mover, Next};
use super::report::{RunReport, SystemReport};
use super::settings::{RunProgress, RunSettings};
use crate::drawn::not_stored;
use crate::motion::Motion;
use crate::motion::row_times::RowTimes;
use crate::report::Times;
use crate::rows::columns::COLUMNS;
use crate::rows::row::{BodyRow, Row};

/// Steps from one row with a report of progress and a look at the clock to the next: a row may cost less than these.
const STEPS_PER_LOOK: u64 = 64;

/// Follows a run, and turns its observations into rows of the results file.
pub(super) struct Recorder<'a> {
    movers: Vec<Mover<'a>>,
    row: Row,
    writer: Writer<Row>,
    rows: u64,
    /// Times of the rows of several bodies and of tied ones; a single free one has its rows where it takes them.
    times: Option<RowTimes>,
    estimate: Estimate,
    /// The number of what the run reads.
    identity: u64,
}

impl<'a> Recorder<'a> {
    pub fn new(
        bodies: &[RunBody<'_>],
        mut movers: Vec<Mover<'a>>,
        writer: Writer<Row>,
        estimate: Estimate,
        identity: u64,
    ) -> Self {
        let is_alone = matches!(&movers[..], [Mover { motion: Motion::Alone(_), .. }]);
        let times = bodies.first().filter(|_| !is_alone).map(|body| RowTimes::new(body.scene));
        if times.is_some_and(|times| times.may_be_between_steps()) {
            movers.iter_mut().for_each(|mover| mover.motion.keep_last_step());
        }
        let joints = movers.iter().map(|mover| mover.joints.len() + mover.elements.len()).sum();
        let row = Row {
            time: 0.0,
            bodies: bodies.iter().map(|body| BodyRow::new(body.model)).collect(),
            joints: vec![JointObservation::default(); joints],
        };
        Self { movers, row, writer, rows: 0, times, estimate, identity }
    }

    /// The first row, and a first checkpoint.
    pub fn begin(&mut self) -> Result<(), RunError> {
        self.record()?;
        self.flush()
    }

    /// Takes the rows before a checkpoint into account, the last of which must be what the motion is at.
    pub fn take_up(&mut self, results: &Results) -> Result<(), RunError> {
        let part = self.writer.unfinished().to_path_buf();
        let changed = |what| RunError::Changed { part: part.clone(), what };
        let times = results.numbers("time").unwrap_or_default();
        for (row, time) in times.iter().enumerate() {
            let results: Vec<BodyResults<'_>> = results.bodies().collect();
            for body in self.movers.iter_mut().flat_map(|mover| &mut mover.bodies) {
                let number = body.number;
                let of = results.get(number).ok_or_else(|| changed("the list of bodies"))?;
                let out = &mut self.row.bodies[number];
                body.take_up(*of, (row, *time), out).ok_or_else(|| changed("the columns"))??;
            }
        }
        self.rows = results.rows() as u64;
        let Some(last) = self.rows.checked_sub(1) else { return Err(changed("the motion at the checkpoint")) };
        // A body that was between two steps at the row is beyond it.
        if self.movers.iter().any(|mover| self.row_within_step(mover, last).is_some()) {
            return Ok(());
        }
        self.observe(last)?;
        match results.is_row(last as usize, &COLUMNS, &self.row) {
            true => Ok(()),
            false => Err(changed("the motion at the checkpoint")),
        }
    }

    /// Goes on to the end. The results are then still in the unfinished file.
    pub fn follow(
        mut self,
        started: Instant,
        settings: &RunSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<(RunReport, Writer<Row>), RunError> {
        let before = self.steps();
        let mut looked_at = 0;
        loop {
            let reached = self.go()?;
            let asked = settings.stop.load(Ordering::Relaxed);
            match reached {
                Reached::Row => {
                    self.record()?;
                    let stop = asked && self.time() < self.end();
                    let tried = self.tried();
                    if !stop && tried < looked_at + STEPS_PER_LOOK {
                        continue;
                    }
                    looked_at = tried;
                    if stop || self.writer.flush_is_due() {
                        self.flush()?;
                    }
                    if stop {
                        return Err(self.stopped(settings));
                    }
                }
                // What has come since the last flush is computed again.
                Reached::Between if asked => return Err(self.stopped(settings)),
                Reached::End => break,
                _ => {}
            }
            progress(RunProgress::Motion(self.time() / self.end()));
        }
        // Should there be no room for the results file, they can still be had from here.
        self.flush()?;
        let time = started.elapsed();
        let steps = self.steps();
        let tied: Vec<_> = self.movers.iter().filter_map(Mover::tied_report).collect();
        let Self { movers, row, writer, rows, estimate, .. } = self;
        let count = row.bodies.len();
        let mut reports: Vec<_> = movers.into_iter().flat_map(|mover| reports(mover, &row, count)).collect();
        reports.sort_by_key(|report| report.number);
        let Some(scene) = reports.first().map(|report| report.scene) else { return Err(RunError::NoBody) };
        let mut schemes: Vec<&str> = reports.iter().map(|report| report.body.scheme.as_str()).collect();
        schemes.sort_unstable();
        schemes.dedup();
        let mut times = Times::default();
        reports.iter().for_each(|report| times.add_all(&report.times));
        let of_bodies = reports.iter().flat_map(|report| report.warnings.clone());
        let warnings = tied.iter().flat_map(|tied| tied.doubts()).chain(of_bodies).collect();
        let mut report = RunReport {
            title: scene.title.clone(),
            units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
            results: writer.path().to_path_buf(),
            tables: Vec::new(),
            rows,
            estimate,
            formulation: scene.time.method.formulation.to_owned(),
            scheme: schemes.join(", "),
            tolerance: match scene.time.control {
                StepControl::Fixed(_) => None,
                StepControl::Tolerance(tolerance) => Some(tolerance),
            },
            steps_per_second: (steps - before) as f64 / time.as_secs_f64(),
            tied,
            steps,
            bodies: reports.into_iter().map(|report| report.body).collect(),
            system: SystemReport::of(&row),
            check: None,
            large_choice: None,
            large_is_chosen: false,
            trust: None,
            warnings,
            times,
        };
        report.times.add("motion", started.elapsed());
        Ok((report, writer))
    }

    /// Goes on to the next row of all bodies, or less far.
    fn go(&mut self) -> Result<Reached, RunError> {
        let next = match &self.times {
            Some(times) if self.rows >= times.count() => return Ok(Reached::End),
            Some(times) => Next::Time(times.of(self.rows)),
            None => Next::Row,
        };
        let mut last = Reached::Row;
        for i in 0..self.movers.len() {
            let mover = &mut self.movers[i];
            let reached = mover.go(next, self.times.as_ref());
            if reached.is_err() {
                mover.look_ahead();
            }
            // A step that fails after the model has come to mean nothing fails for that.
            let refused = mover.bodies.iter().find_map(|body| Some((body.number, body.refusal()?)));
            if let Some((body, (time, refusal))) = refused {
                let results = self.writer.unfinished().to_path_buf();
                return Err(RunError::Refused { results, body: self.name_of(body), time, refusal });
            }
            last = reached.map_err(|source| self.failed(i, source))?;
            if last == Reached::Between {
                break;
            }
        }
        Ok(last)
    }

    /// Time that all bodies have come to.
    fn time(&self) -> f64 {
        self.movers.iter().map(|mover| mover.motion.time()).fold(f64::INFINITY, f64::min)
    }

    fn end(&self) -> f64 {
        self.movers.first().map_or(0.0, |mover| mover.motion.end())
    }

    /// Steps of all motions.
    fn steps(&self) -> u64 {
        self.movers.iter().map(|mover| mover.motion.stats().accepted).sum()
    }

    /// The same, with those that were tried in vain.
    fn tried(&self) -> u64 {
        self.movers.iter().map(|mover| mover.motion.tried()).sum()
    }

    /// Name of a body among several, for messages.
    fn name_of(&self, body: usize) -> Option<String> {
        let mut bodies = self.movers.iter().flat_map(|mover| &mover.bodies).filter(|_| self.row.bodies.len() > 1);
        bodies.find(|of| of.number == body).map(|of| of.of.name().to_owned())
    }

    fn stopped(&self, settings: &RunSettings) -> RunError {
        let replaces = settings.overwrite && self.writer.path().exists();
        RunError::Stopped { part: self.writer.unfinished().to_path_buf(), time: self.time(), replaces }
    }

    /// The error of a step of a motion, with the name of its body where it has one.
    fn failed(&self, mover: usize, source: StepError) -> RunError {
        let body = match &self.movers[mover].bodies[..] {
            [body] => self.name_of(body.number),
            _ => None,
        };
        RunError::Step { results: self.writer.unfinished().to_path_buf(), body, source }
    }

    /// Time of a row, where it is within the last step of a motion.
    fn row_within_step(&self, mover: &Mover<'_>, row: u64) -> Option<f64> {
        let times = self.times.as_ref()?;
        let time = times.of(row);
        (!times.are_same(mover.motion.time(), time)).then_some(time)
    }

    /// Observes the motion at a row.
    fn observe(&mut self, row: u64) -> Result<(), RunError> {
        for i in 0..self.movers.len() {
            let within = self.row_within_step(&self.movers[i], row);
            let observed = self.movers[i].observe(within, &mut self.row);
            observed.map_err(|source| self.failed(i, source))?;
        }
        self.row.time = self.times.as_ref().map_or_else(|| self.time(), |times| times.of(row));
        Ok(())
    }

    /// Writes the row of the time that all bodies have reached.
    fn record(&mut self) -> Result<(), RunError> {
        self.observe(self.rows)?;
        // It refuses what is not finite.
        self.writer.push(&self.row)?;
        let mut bodies = self.movers.iter_mut().flat_map(|mover| &mut mover.bodies);
        bodies.try_for_each(|body| body.record(&self.row.bodies[body.number]))?;
        self.rows += 1;
        Ok(())
    }

    /// Hands the rows to the operating system, with the state after the last; but not where a body is beyond the next row
    /// already, which could then not be found again.
    fn flush(&mut self) -> Result<(), RunError> {
        let next = self.times.as_ref().map_or(f64::INFINITY, |times| times.of(self.rows));
        if next < self.end() && self.movers.iter().any(|mover| mover.motion.time() > next) {
            return Ok(());
        }
        let checkpoint =
            checkpoint(self.identity, self.movers.iter().map(|mover| &mover.motion), self.writer.unfinished())?;
        Ok(self.writer.flush(&checkpoint)?)
    }
}

/// A body at the end of its run.
struct Finished<'a> {
    number: usize,
    scene: &'a Scene,
    body: BodyRunReport,
    warnings: Vec<String>,
    times: Times,
}

/// Reports of the bodies of a motion that has come to its end, of `count` in all.
fn reports<'a>(Mover { motion, mut bodies, .. }: Mover<'a>, last: &Row, count: usize) -> Vec<Finished<'a>> {
    let scales = bodies.iter_mut().map(|body| body.monitor_mut().scales());
    if let Some(scales) = scales.reduce(|most, scales| most.or_larger(&scales)) {
        bodies.iter_mut().for_each(|body| body.monitor_mut().widen(&scales));
    }
    let stats = motion.stats();
    let report = |(i, body): (usize, FollowedBody<'a>)| {
        let (of, number) = (body.of, body.number);
        let (report, warnings) =
            body.report(&last.bodies[number], (&stats, &motion.energies(i), motion.scheme(of.scene)));
        let named = |text| if count == 1 { text } else { format!("body {}: {text}", of.name()) };
        Finished {
            number,
            scene: of.scene,
            body: report,
            warnings: warnings.into_iter().chain(not_stored(of, count)).map(named).collect(),
            times: Times::of_model(of.model),
        }
    };
    bodies.into_iter().enumerate().map(report).collect()
}
