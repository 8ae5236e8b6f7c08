//! Runs a driver under mpirun.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use modal::{EnginePhase, Progress};
use rustix::process::{Pid, Signal, kill_process};
use serde::Deserialize;

use crate::cures::{INSTALL, cure};
use crate::error::SlepcError;
use crate::folder::DRIVER_FILE;
use crate::stop::Stop;

/// Names mpirun, where it is not `mpirun`.
const MPIRUN: &str = "FLEXFRAME_MPIRUN";
/// Names Python, where it is not `python3`.
const PYTHON: &str = "FLEXFRAME_MPI_PYTHON";
/// Whether to stop is looked at so often.
const PATIENCE: Duration = Duration::from_millis(50);
/// mpirun has so long to end its processes.
const FAREWELL: Duration = Duration::from_secs(10);
/// Lines that are kept of what it says, and that are shown.
const KEPT: usize = 60;
const SHOWN: usize = 12;

/// A line of the driver.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said {
    Refused { error: String, cure: String, is_missing: bool },
    Phase { phase: String },
    Converged { converged: usize, of: usize },
}

/// What comes from the processes.
enum Line {
    /// Of the driver.
    Said(Said),
    /// Of mpirun, Python, PETSc.
    Other(String),
}

/// Runs the driver of a folder on so many ranks.
pub(crate) fn drive(
    folder: &Path,
    ranks: usize,
    stop: &Stop,
    progress: &mut dyn FnMut(Progress),
) -> Result<(), SlepcError> {
    let named = |variable: &str, usual: &str| std::env::var_os(variable).unwrap_or_else(|| OsString::from(usual));
    let (mpirun, python) = (named(MPIRUN, "mpirun"), named(PYTHON, "python3"));
    let mut command = Command::new(&mpirun);
    command.args(["-n", &ranks.to_string()]).arg(&python).arg(folder.join(DRIVER_FILE));
    if std::env::var_os("OMP_NUM_THREADS").is_none() {
        // The ranks are the parallelism.
        command.env("OMP_NUM_THREADS", "1");
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let words = format!("{} -n {ranks} {} {DRIVER_FILE}", mpirun.to_string_lossy(), python.to_string_lossy());
    progress(Progress::Engine(EnginePhase::Starting));
    let mut child = command.spawn().map_err(|cause| SlepcError::NotInstalled {
        found: format!("`{}` cannot be started: {cause}", mpirun.to_string_lossy()),
        cure: INSTALL.to_owned(),
    })?;
    let (send, receive) = mpsc::channel();
    let readers = [
        child.stdout.take().map(|stream| listen(stream, send.clone())),
        child.stderr.take().map(|stream| listen(stream, send)),
    ];

    let (mut last, mut refusal) = (VecDeque::new(), None);
    loop {
        if stop.is_asked() {
            end(&mut child);
            return Err(SlepcError::Stopped { command: words });
        }
        match receive.recv_timeout(PATIENCE) {
            Ok(Line::Said(Said::Refused { error, cure, is_missing })) => refusal = Some((error, cure, is_missing)),
            Ok(Line::Said(Said::Phase { phase })) => match phase.as_str() {
                "factor" => progress(Progress::Engine(EnginePhase::Factorizing)),
                "count" => progress(Progress::Engine(EnginePhase::Counting)),
                _ => {}
            },
            Ok(Line::Said(Said::Converged { converged, of })) => {
                progress(Progress::Lanczos { converged, requested: of });
            }
            Ok(Line::Other(line)) => {
                last.push_back(line);
                if last.len() > KEPT {
                    last.pop_front();
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let status = child.wait().map_err(SlepcError::io(folder, "wait for mpirun"))?;
    readers.into_iter().flatten().for_each(|reader| drop(reader.join()));
    outcome(status, refusal, Vec::from(last), words, stop)
}

fn outcome(
    status: ExitStatus,
    refusal: Option<(String, String, bool)>,
    last: Vec<String>,
    command: String,
    stop: &Stop,
) -> Result<(), SlepcError> {
    match refusal {
        // The signal may have come to mpirun, too.
        _ if stop.is_asked() => Err(SlepcError::Stopped { command }),
        Some((found, cure, true)) => Err(SlepcError::NotInstalled { found, cure }),
        Some((found, cure, false)) => Err(SlepcError::Refused { found, cure }),
        None if status.success() => Ok(()),
        None => {
            let status = in_words(status);
            let cure = cure(&format!("{status}\n{}", last.join("\n"))).to_owned();
            let shown = &last[last.len().saturating_sub(SHOWN)..];
            let said = if shown.is_empty() { "nothing".to_owned() } else { shown.join("\n") };
            Err(SlepcError::Failed { command, status, said, cure })
        }
    }
}

/// The exit status, with the signal that mpirun tells by it: it does not always say so in words.
fn in_words(status: ExitStatus) -> String {
    match status.code() {
        Some(code @ (137 | 139 | 143)) => format!("{status}: signal {} ended a rank", code - 128),
        _ => status.to_string(),
    }
}

/// Sends the lines of a stream, but for rules and empty ones.
fn listen(stream: impl Read + Send + 'static, send: mpsc::Sender<Line>) -> thread::JoinHandle<()> {
    thread::spawn(move || {
        for line in BufReader::new(stream).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line).trim_end().to_owned();
            if line.trim_matches('-').is_empty() {
                continue;
            }
            if !lines_in(&line).into_iter().all(|line| send.send(line).is_ok()) {
                return;
            }
        }
    })
}

/// The lines in one that mpirun has forwarded: it may join those of two ranks, their ends behind both.
fn lines_in(text: &str) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut values = serde_json::Deserializer::from_str(text).into_iter();
    let mut rest = text;
    while let Some(Ok(said)) = values.next() {
        lines.push(Line::Said(said));
        rest = &text[values.byte_offset()..];
    }
    if !rest.trim().is_empty() {
        lines.push(Line::Other(rest.to_owned()));
    }
    lines
}

/// Ends mpirun, which ends its processes.
fn end(child: &mut Child) {
    let started = Instant::now();
    if let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) {
        let _ = kill_process(pid, Signal::TERM);
    }
    while started.elapsed() < FAREWELL {
        if !matches!(child.try_wait(), Ok(None)) {
            return;
        }
        thread::sleep(PATIENCE);
    }
    let _ = child.kill();
    let _ = child.wait();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_mpirun_has_joined_are_taken_apart() {
        let refused = r#"{"error": "none {here}", "cure": "install it", "is_missing": true}"#;
        let shown = |text: &str| -> Vec<String> {
            let name = |line| match line {
                Line::Said(Said::Refused { error, .. }) => format!("refused: {error}"),
                Line::Said(Said::Phase { phase }) => format!("phase: {phase}"),
                Line::Said(Said::Converged { converged, of }) => format!("{converged} of {of}"),
                Line::Other(text) => format!("other: {text}"),
            };
            lines_in(text).into_iter().map(name).collect()
        };
        assert_eq!(shown(refused), ["refused: none {here}"]);
        assert_eq!(shown(&refused.repeat(2)), ["refused: none {here}"; 2]);
        assert_eq!(
            shown(&format!(r#"{{"phase": "factor"}} {refused}Primary job ended"#)),
            ["phase: factor", "refused: none {here}", "other: Primary job ended"]
        );
        assert_eq!(shown(r#"{"converged": 2, "of": 8}"#), ["2 of 8"]);
        for other in ["Primary job", r#"{"unknown": 1}"#, r#"{"phase": "#, "12"] {
            assert_eq!(shown(other), [format!("other: {other}")]);
        }
    }
}
