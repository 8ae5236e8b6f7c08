//! A progress bar for work that takes longer than a second; without a terminal, a line every ten seconds.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use flexframe::advise::AdviseProgress;
use flexframe::campbell::CampbellProgress;
use flexframe::check::CheckProgress;
use flexframe::cost::CostProgress;
use flexframe::run::RunProgress;
use flexframe::sweep::SweepProgress;
use flexframe::verify::VerifyProgress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use memory::Bytes;
use modal::{EnginePhase, Forecast, Progress};
use model::BuildProgress;

use crate::output;

/// Work shorter than this needs no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Without a terminal there is a line so often.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Shows how far the work is.
pub struct Bar {
    started: Instant,
    phase: String,
    bar: ProgressBar,
    /// True if the bar has been given to the terminal, if there is one.
    is_given: bool,
    /// True if nothing but errors goes to standard error.
    is_silent: bool,
    /// Where there is no terminal: lines, and the time from the start at which the next one is due.
    next_line: Option<Duration>,
}

impl Bar {
    /// `is_silent`: without a terminal, nothing is shown. (Scripts that ask for JSON read errors from the same stream.)
    pub fn new(is_silent: bool) -> Self {
        let lines = !is_silent && !io::stderr().is_terminal();
        let next_line = lines.then_some(LINE_INTERVAL);
        Self {
            started: Instant::now(),
            phase: String::new(),
            bar: ProgressBar::hidden(),
            is_given: false,
            is_silent,
            next_line,
        }
    }

    pub fn build(&mut self, progress: BuildProgress) {
        match progress {
            BuildProgress::Mesh => self.show("reading the mesh", None),
            BuildProgress::Doubt(doubt) if !self.is_silent => {
                self.bar.suspend(|| output::doubts([doubt]));
            }
            BuildProgress::Doubt(_) => {}
            BuildProgress::Assembly => self.show("assembling", None),
            BuildProgress::Modes(Progress::Ordering) => self.show("ordering the unknowns", None),
            BuildProgress::Modes(Progress::Factorizing(forecast)) => {
                if forecast.time.is_some_and(|time| time >= LINE_INTERVAL) {
                    self.next_line = self.next_line.map(|_| Duration::ZERO);
                }
                self.show(&factoring(&forecast), None);
            }
            BuildProgress::Modes(Progress::Engine(phase)) => self.show(in_words(phase), None),
            BuildProgress::Modes(Progress::Lanczos { converged, requested }) => {
                self.show("finding modes", Some((converged as u64, requested as u64)));
            }
            BuildProgress::Statics => self.show("static responses", None),
        }
    }

    pub fn run(&mut self, progress: RunProgress) {
        match progress {
            RunProgress::Build(progress) => self.build(progress),
            RunProgress::Built => {}
            RunProgress::Estimate(estimate) if !self.is_silent => self.bar.suspend(|| output::show_estimate(&estimate)),
            RunProgress::Estimate(_) => {}
            RunProgress::Check(progress) => self.check(progress),
            RunProgress::Motion(part) => self.show("stepping", Some(((10_000.0 * part) as u64, 10_000))),
        }
    }

    pub fn advise(&mut self, progress: AdviseProgress) {
        match progress {
            AdviseProgress::Build(progress) => self.build(progress),
            AdviseProgress::Verifying { done, total } => self.show("verifying", Some((done, total))),
        }
    }

    pub fn campbell(&mut self, progress: CampbellProgress) {
        match progress {
            CampbellProgress::Build(progress) => self.build(progress),
            CampbellProgress::Speeds { done, total } => self.show("spinning", Some((done as u64, total as u64))),
        }
    }

    pub fn check(&mut self, progress: CheckProgress) {
        match progress {
            CheckProgress::Build(progress) => self.build(progress),
            CheckProgress::Rows { done, total } => self.show("checking", Some((done as u64, total as u64))),
        }
    }

    pub fn cost(&mut self, progress: CostProgress) {
        match progress {
            CostProgress::Build(progress) => self.build(progress),
            CostProgress::Measuring { done, total } => self.show("measuring", Some((done, total))),
        }
    }

    pub fn sweep(&mut self, progress: SweepProgress) {
        match progress {
            SweepProgress::Build(progress) => self.build(progress),
            SweepProgress::Rows { done, total } => self.show("sweeping", Some((done, total))),
        }
    }

    pub fn verify(&mut self, VerifyProgress { case, done, total }: VerifyProgress) {
        self.show(&format!("verifying {case}"), Some((done as u64, total as u64)));
    }

    fn show(&mut self, phase: &str, done: Option<(u64, u64)>) {
        if let Some(due) = self.next_line {
            let now = self.started.elapsed();
            if now >= due {
                let part = done.map_or_else(String::new, |(done, total)| format!(" {} %,", 100 * done / total.max(1)));
                // Where it cannot be written, nothing is lost but words.
                let _ = writeln!(io::stderr(), "{phase},{part} {} s since the start", now.as_secs());
                self.next_line = Some(now + LINE_INTERVAL);
            }
            return;
        }
        if phase != self.phase {
            self.bar.finish_and_clear();
            self.phase = phase.to_owned();
            self.is_given = false;
            self.bar = match done {
                Some((_, total)) => ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden())
                    .with_style(style("{msg} {wide_bar} {percent} %, {eta} left")),
                None => ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
                    .with_style(style("{spinner} {msg}, {elapsed}")),
            }
            .with_message(phase.to_owned());
        }
        if !self.is_given && self.started.elapsed() > PATIENCE {
            self.is_given = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
            if done.is_none() {
                self.bar.enable_steady_tick(Duration::from_millis(200));
            }
        }
        if let Some((done, _)) = done {
            self.bar.set_position(done);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn in_words(phase: EnginePhase) -> &'static str {
    match phase {
        EnginePhase::Writing => "writing K and M",
        EnginePhase::Starting => "starting SLEPc",
        EnginePhase::Factorizing => "MUMPS factors K + sM",
        EnginePhase::Counting => "MUMPS counts the modes",
    }
}

/// Such as "factoring K + sM (1.5 GB at the most, about 40 s)". The memory is that of the whole search.
fn factoring(forecast: &Forecast) -> String {
    let time = forecast.time.map_or_else(String::new, |time| format!(", about {:.0} s", time.as_secs_f64().max(1.0)));
    let what = if forecast.on_corners { "K + sM on the corners" } else { "K + sM" };
    format!("factoring {what} ({} at the most{time})", Bytes(forecast.peak_bytes))
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
