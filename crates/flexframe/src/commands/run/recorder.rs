//! From the motion of the bodies to the rows of the results file.

use std::sync::atomic::Ordering;
use std::time::Instant;

use dynamics::{Reached, StepError};
use results::{Results, Writer};
use scene::StepControl;

use super::body::{MovingBody, Next};
use super::checkpoint::checkpoint;
use super::error::RunError;
use super::estimate::Estimate;
use super::report::{RunReport, SystemReport};
use super::row_times::RowTimes;
use super::settings::{RunProgress, RunSettings};
use crate::drawn::not_stored;
use crate::report::Times;
use crate::rows::columns::COLUMNS;
use crate::rows::row::{BodyRow, Row};

/// Steps from one row with a report of progress and a look at the clock to the next: a row may cost less than these.
const STEPS_PER_LOOK: u64 = 64;

/// Follows a run, and turns its observations into rows of the results file.
pub(super) struct Recorder<'a> {
    bodies: Vec<MovingBody<'a>>,
    row: Row,
    writer: Writer<Row>,
    rows: u64,
    /// Of several bodies; a single one has its rows where it takes them.
    times: Option<RowTimes>,
    estimate: Estimate,
}

impl<'a> Recorder<'a> {
    pub fn new(mut bodies: Vec<MovingBody<'a>>, writer: Writer<Row>, estimate: Estimate) -> Self {
        let times = bodies.first().filter(|_| bodies.len() > 1).map(|body| RowTimes::new(body.of.scene));
        if times.is_some_and(|times| times.may_be_between_steps()) {
            bodies.iter_mut().for_each(MovingBody::keep_last_step);
        }
        let row = Row { time: 0.0, bodies: bodies.iter().map(|body| BodyRow::new(body.of.model)).collect() };
        Self { bodies, row, writer, rows: 0, times, estimate }
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
            let bodies = self.bodies.iter_mut().zip(results.bodies()).zip(&mut self.row.bodies);
            for ((body, results), out) in bodies {
                body.take_up(results, (row, *time), out).ok_or_else(|| changed("the columns"))??;
            }
        }
        self.rows = results.rows() as u64;
        let Some(last) = self.rows.checked_sub(1) else { return Err(changed("the motion at the checkpoint")) };
        // A body that was between two steps at the row is beyond it.
        if (0..self.bodies.len()).any(|body| self.row_within_step(body, last).is_some()) {
            return Ok(());
        }
        self.observe(last)?;
        match results.is_row(last as usize, &COLUMNS, &self.row) {
            true => Ok(()),
            false => Err(changed("the motion at the checkpoint")),
        }
    }

    /// Goes on to the end.
    pub fn follow(
        mut self,
        started: Instant,
        settings: &RunSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<RunReport, RunError> {
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
        let Self { bodies, row, mut writer, rows, estimate, .. } = self;
        let steps: u64 = bodies.iter().map(|body| body.simulation().stats().accepted).sum();
        let Some(scene) = bodies.first().map(|body| body.of.scene) else { return Err(RunError::NoBody) };
        let count = bodies.len();
        let (mut reports, mut warnings, mut times) = (Vec::new(), Vec::new(), Times::default());
        for (body, last) in bodies.into_iter().zip(&row.bodies) {
            let of = body.of;
            times.add_all(&Times::of_model(of.model));
            let (report, of_body) = body.report(last);
            let of_body = of_body.into_iter().chain(not_stored(of, count));
            warnings.extend(of_body.map(|text| if count == 1 { text } else { format!("body {}: {text}", of.name()) }));
            reports.push(report);
        }
        let mut report = RunReport {
            title: scene.title.clone(),
            units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
            results: writer.path().to_path_buf(),
            rows,
            estimate,
            formulation: scene.time.method.formulation.to_owned(),
            scheme: scene.time.method.scheme.to_owned(),
            tolerance: match scene.time.control {
                StepControl::Fixed(_) => None,
                StepControl::Tolerance(tolerance) => Some(tolerance),
            },
            steps_per_second: (steps - before) as f64 / time.as_secs_f64(),
            bodies: reports,
            system: SystemReport::of(&row),
            warnings,
            times,
        };
        writer.warn(report.warnings.clone());
        writer.finish()?;
        report.times.add("motion", started.elapsed());
        Ok(report)
    }

    /// Goes on to the next row of all bodies, or less far.
    fn go(&mut self) -> Result<Reached, RunError> {
        let next = match &self.times {
            Some(times) if self.rows >= times.count() => return Ok(Reached::End),
            Some(times) => Next::Time(times.of(self.rows)),
            None => Next::Row,
        };
        let mut last = Reached::Row;
        for i in 0..self.bodies.len() {
            let body = &mut self.bodies[i];
            let reached = body.go(next, self.times.as_ref());
            // A step that fails after the model has come to mean nothing fails for that.
            if let Some((time, refusal)) = body.refusal() {
                let results = self.writer.unfinished().to_path_buf();
                return Err(RunError::Refused { results, body: self.name_of(i), time, refusal });
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
        self.bodies.iter().map(|body| body.simulation().time()).fold(f64::INFINITY, f64::min)
    }

    fn end(&self) -> f64 {
        self.bodies.first().map_or(0.0, |body| body.simulation().end())
    }

    /// Steps of all bodies.
    fn steps(&self) -> u64 {
        self.bodies.iter().map(|body| body.simulation().stats().accepted).sum()
    }

    /// The same, with those that were tried in vain.
    fn tried(&self) -> u64 {
        self.bodies.iter().map(|body| body.simulation().stats()).map(|stats| stats.accepted + stats.rejected).sum()
    }

    /// Name of a body among several, for messages.
    fn name_of(&self, body: usize) -> Option<String> {
        (self.bodies.len() > 1).then(|| self.bodies[body].of.name().to_owned())
    }

    fn stopped(&self, settings: &RunSettings) -> RunError {
        let replaces = settings.overwrite && self.writer.path().exists();
        RunError::Stopped { part: self.writer.unfinished().to_path_buf(), time: self.time(), replaces }
    }

    fn failed(&self, body: usize, source: StepError) -> RunError {
        RunError::Step { results: self.writer.unfinished().to_path_buf(), body: self.name_of(body), source }
    }

    /// Time of a row, where it is within the last step of a body.
    fn row_within_step(&self, body: usize, row: u64) -> Option<f64> {
        let times = self.times.as_ref()?;
        let time = times.of(row);
        (!times.are_same(self.bodies[body].simulation().time(), time)).then_some(time)
    }

    /// Observes the motion at a row.
    fn observe(&mut self, row: u64) -> Result<(), RunError> {
        for i in 0..self.bodies.len() {
            let within = self.row_within_step(i, row);
            let observed = self.bodies[i].observe(within, &mut self.row.bodies[i]);
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
        self.bodies.iter_mut().zip(&self.row.bodies).try_for_each(|(body, now)| body.record(now))?;
        self.rows += 1;
        Ok(())
    }

    /// Hands the rows to the operating system, with the state after the last; but not where a body is beyond the next row
    /// already, which could then not be found again.
    fn flush(&mut self) -> Result<(), RunError> {
        let next = self.times.as_ref().map_or(f64::INFINITY, |times| times.of(self.rows));
        if next < self.end() && self.bodies.iter().any(|body| body.simulation().time() > next) {
            return Ok(());
        }
        let checkpoint = checkpoint(self.bodies.iter().map(MovingBody::simulation), self.writer.unfinished())?;
        Ok(self.writer.flush(&checkpoint)?)
    }
}
