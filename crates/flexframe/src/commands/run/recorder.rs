//! From the motion of the bodies to the rows of the results file.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

use dynamics::{Island, IslandError, Reached, Run};
use results::{BodyResults, Results, Writer};
use scene::{Shared, StepControl};

use super::balances::Monitor;
use super::body::FollowedBody;
use super::body_report::BodyRunReport;
use super::error::RunError;
use super::estimate::Estimate;
use super::report::{RunReport, SystemReport};
use super::settings::{RunProgress, RunSettings};
use super::tied_report::TiedReport;
use crate::drawn::not_stored;
use crate::report::Times;
use crate::rows::columns::COLUMNS;
use crate::rows::row::{BodyRow, Row};

/// Steps between two reports of progress, where no row comes first.
const STEPS_PER_REPORT: u64 = 4096;
/// Steps from one row with a report of progress and a look at the clock to the next: a row may cost less than these.
const STEPS_PER_LOOK: u64 = 64;

/// Follows a run, and turns its observations into rows of the results file.
pub(super) struct Recorder<'a> {
    run: Run,
    /// The bodies in the order of the scene.
    bodies: Vec<FollowedBody<'a>>,
    row: Row,
    writer: Writer<Row>,
    rows: u64,
    estimate: Estimate,
    /// The number of what the run reads.
    identity: u64,
}

/// The number of the files that the run reads ([`identity_of_files`](crate::files::identity::identity_of_files)), and the state of the run: as many words at any time.
pub(super) fn checkpoint(identity: u64, run: &Run, part: &Path) -> Result<Vec<u64>, RunError> {
    let state = run.checkpoint().map_err(|source| RunError::Restore { part: part.to_owned(), source })?;
    Ok(std::iter::once(identity).chain(state).collect())
}

impl<'a> Recorder<'a> {
    pub fn new(
        run: Run,
        bodies: Vec<FollowedBody<'a>>,
        writer: Writer<Row>,
        estimate: Estimate,
        identity: u64,
    ) -> Self {
        let row = Row {
            time: 0.0,
            bodies: bodies.iter().map(|body| BodyRow::new(body.of.model)).collect(),
            joints: run.room_of_joints(),
        };
        Self { run, bodies, row, writer, rows: 0, estimate, identity }
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
            for body in &mut self.bodies {
                let number = body.number;
                let of = results.get(number).ok_or_else(|| changed("the list of bodies"))?;
                let out = &mut self.row.bodies[number];
                body.take_up(*of, (row, *time), out).ok_or_else(|| changed("the columns"))??;
            }
        }
        self.rows = results.rows() as u64;
        let Some(last) = self.rows.checked_sub(1) else { return Err(changed("the motion at the checkpoint")) };
        // A body that was between two steps at the row is beyond it.
        if self.run.is_between_steps() {
            return Ok(());
        }
        self.observe()?;
        match results.is_row(last as usize, &COLUMNS, &self.row) {
            true => Ok(()),
            false => Err(changed("the motion at the checkpoint")),
        }
    }

    /// Goes on to the end. The results are then still in the unfinished file.
    pub fn follow(
        mut self,
        scene: &Shared,
        started: Instant,
        settings: &RunSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<(RunReport, Writer<Row>), RunError> {
        let before = self.run.steps();
        let mut looked_at = 0;
        loop {
            let reached = self.go()?;
            let asked = settings.stop.load(Ordering::Relaxed);
            match reached {
                Reached::Row => {
                    self.record()?;
                    let stop = asked && self.run.time() < self.run.end();
                    let tried = self.run.tried();
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
            progress(RunProgress::Motion(self.run.time() / self.run.end()));
        }
        // Should there be no room for the results file, they can still be had from here.
        self.flush()?;
        let time = started.elapsed();
        let steps = self.run.steps();
        let tied: Vec<_> = self.run.islands().iter().filter_map(|island| self.tied_report(island)).collect();
        let Self { run, bodies, row, writer, rows, estimate, .. } = self;
        let reports = reports(&run, bodies, &row);
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
            accuracy: None,
            trust: None,
            warnings,
            times,
        };
        report.times.add("motion", started.elapsed());
        Ok((report, writer))
    }

    /// Goes on to the next row of all bodies, or less far.
    fn go(&mut self) -> Result<Reached, RunError> {
        let Self { run, bodies, .. } = self;
        let reached = run.advance(STEPS_PER_REPORT, |body, moment| bodies[body].look(moment));
        if let Err(failed) = &reached {
            self.look_ahead(&failed.bodies);
        }
        // A step that fails after the model has come to mean nothing fails for that.
        let refused = self.bodies.iter().find_map(|body| Some((body.number, body.refusal()?)));
        if let Some((body, (time, refusal))) = refused {
            let results = self.writer.unfinished().to_path_buf();
            return Err(RunError::Refused { results, body: self.name_of(body), time, refusal });
        }
        reached.map_err(|failed| self.failed(failed))
    }

    /// Shows bodies how far they would have bent at the end of the step that has failed: a body may be thrown out of its model within one
    /// step.
    fn look_ahead(&mut self, failed: &[usize]) {
        let Some((island, _)) = failed.first().and_then(|body| self.run.island_of(*body)) else { return };
        let Ok(states) = island.motion.states() else { return };
        let step = island.motion.stats().longest;
        for (state, body) in states.iter().zip(failed) {
            self.bodies[*body].look_ahead(state, step);
        }
    }

    /// The report of an island of tied bodies.
    fn tied_report(&self, island: &Island) -> Option<TiedReport> {
        let bodies = island.bodies.iter().map(|body| &self.bodies[*body].of);
        let constrained = bodies.clone().filter(|of| of.body.constraint.is_some());
        let [names, constrained] =
            [bodies.map(|of| of.name().to_owned()).collect(), constrained.map(|of| of.name().to_owned()).collect()];
        TiedReport::new(&island.motion, names, constrained)
    }

    /// Name of a body among several, for messages.
    fn name_of(&self, body: usize) -> Option<String> {
        (self.bodies.len() > 1).then(|| self.bodies[body].of.name().to_owned())
    }

    fn stopped(&self, settings: &RunSettings) -> RunError {
        let replaces = settings.overwrite && self.writer.path().exists();
        RunError::Stopped { part: self.writer.unfinished().to_path_buf(), time: self.run.time(), replaces }
    }

    /// The error of a step, with the name of the body where it moves alone.
    fn failed(&self, IslandError { bodies, source }: IslandError) -> RunError {
        let body = if let [body] = bodies[..] { self.name_of(body) } else { None };
        RunError::Step { results: self.writer.unfinished().to_path_buf(), body, source }
    }

    /// Observes the motion at the row that has been reached.
    fn observe(&mut self) -> Result<(), RunError> {
        let Self { run, row, .. } = self;
        let observed = run.observe(row.bodies.iter_mut().map(|body| &mut body.motion), &mut row.joints);
        self.row.time = observed.map_err(|failed| self.failed(failed))?;
        self.row.bodies.iter_mut().zip(&self.bodies).for_each(|(row, body)| row.complete(body.of.model));
        Ok(())
    }

    /// Writes the row of the time that all bodies have reached.
    fn record(&mut self) -> Result<(), RunError> {
        self.observe()?;
        // It refuses what is not finite.
        self.writer.push(&self.row)?;
        self.bodies.iter_mut().zip(&self.row.bodies).try_for_each(|(body, row)| body.record(row))?;
        self.rows += 1;
        Ok(())
    }

    /// Hands the rows to the operating system, with the state after the last; but not where a body is beyond the next row
    /// already, which could then not be found again.
    fn flush(&mut self) -> Result<(), RunError> {
        if self.run.is_beyond_next_row() {
            return Ok(());
        }
        let checkpoint = checkpoint(self.identity, &self.run, self.writer.unfinished())?;
        Ok(self.writer.flush(&checkpoint)?)
    }
}

/// A body at the end of its run.
struct Finished {
    body: BodyRunReport,
    warnings: Vec<String>,
    times: Times,
}

/// Reports of all bodies at the end of a run, in the order of the scene.
fn reports(run: &Run, mut bodies: Vec<FollowedBody<'_>>, last: &Row) -> Vec<Finished> {
    for island in run.islands() {
        Monitor::widen_together(&mut bodies, &island.bodies, FollowedBody::monitor_mut);
    }
    let count = bodies.len();
    let report = |body: FollowedBody<'_>| {
        let (of, number) = (body.of, body.number);
        let (island, own) = run.island_of(number)?;
        let scheme = of.body.method().scheme;
        let (report, warnings) =
            body.report(&last.bodies[number], (&island.motion.stats(), &island.motion.energies(own), scheme));
        let named = |text| if count == 1 { text } else { format!("body {}: {text}", of.name()) };
        Some(Finished {
            body: report,
            warnings: warnings.into_iter().chain(not_stored(of, count)).map(named).collect(),
            times: Times::of_model(of.model),
        })
    };
    bodies.into_iter().filter_map(report).collect()
}
