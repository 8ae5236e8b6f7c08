//! Runs a driver under mpirun.

use std::collections::VecDeque;
use std::path::Path;
use std::process::ExitStatus;

use diagnostic::{Failure, Kind};
use foreign_program::{ForeignProgram, Limits, ProgramError, named};
use modal::{EnginePhase, Progress};
use serde::Deserialize;

use crate::error::{not_installed, refused, stopped};
use crate::folder::DRIVER_FILE;
use crate::help::{INSTALL, help};
use crate::stop::Stop;

/// Names mpirun, where it is not `mpirun`.
const MPIRUN: &str = "FLEXFRAME_MPIRUN";
/// Names Python, where it is not `python3`.
const PYTHON: &str = "FLEXFRAME_MPI_PYTHON";
/// Lines that are kept of what it says, and that are shown.
const KEPT: usize = 60;
const SHOWN: usize = 12;
/// Bytes that are kept of a line.
const LONGEST: usize = 2000;

/// A line of the driver.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said {
    Refused { error: String, help: String, is_missing: bool },
    Phase { phase: String },
    Converged { converged: usize, of: usize },
}

/// A line of output of the processes.
enum Line {
    /// A message of the driver.
    Said(Said),
    /// A line of mpirun, Python or PETSc.
    Other(String),
}

/// Runs the driver of a folder on `ranks` ranks.
pub(crate) fn drive(
    folder: &Path,
    ranks: usize,
    stop: &Stop,
    progress: &mut dyn FnMut(Progress),
) -> Result<(), Failure> {
    let (mpirun, python) = (named(MPIRUN, "mpirun"), named(PYTHON, "python3"));
    let mut program = ForeignProgram::new(&mpirun, folder).args(["-n", &ranks.to_string()]).arg(&python);
    // PETSc's own installation is found by it.
    if let Some(path) = std::env::var_os("PYTHONPATH") {
        program = program.env("PYTHONPATH", path);
    }
    // Open MPI keeps its own files in a folder that all runs of a user share, and a run that ends may remove it under one that
    // begins.
    program = program.arg(folder.join(DRIVER_FILE)).env("TMPDIR", folder);
    if std::env::var_os("OMP_NUM_THREADS").is_none() {
        // The ranks are the parallelism.
        program = program.env("OMP_NUM_THREADS", "1");
    }
    let words = format!("{} -n {ranks} {} {DRIVER_FILE}", mpirun.to_string_lossy(), python.to_string_lossy());
    progress(Progress::Engine(EnginePhase::Starting));

    let (mut last, mut refusal) = (VecDeque::new(), None);
    let mut take = |line| match line {
        Line::Said(Said::Refused { error, help, is_missing }) => refusal = Some((error, help, is_missing)),
        Line::Said(Said::Phase { phase }) => match phase.as_str() {
            "factor" => progress(Progress::Engine(EnginePhase::Factorizing)),
            "count" => progress(Progress::Engine(EnginePhase::Counting)),
            _ => {}
        },
        Line::Said(Said::Converged { converged, of }) => progress(Progress::Lanczos { converged, requested: of }),
        Line::Other(line) => {
            last.push_back(line.chars().take(LONGEST).collect());
            if last.len() > KEPT {
                last.pop_front();
            }
        }
    };
    let hear = |_, line: String| {
        // Rules and empty lines say nothing.
        if !line.trim_matches('-').is_empty() {
            lines_in(&line).into_iter().for_each(&mut take);
        }
    };
    match program.run(Limits::default(), || stop.is_asked(), hear) {
        Ok(status) => outcome(status, refusal, Vec::from(last), words, stop),
        Err(ProgramError::Stopped) => Err(stopped(&words)),
        Err(ProgramError::Start(cause)) => {
            Err(not_installed(&format!("`{}` cannot be started: {cause}", mpirun.to_string_lossy()), INSTALL))
        }
        Err(error) => {
            let help = "see what the system lacks; docs/reference/cluster.md says how to run the driver by hand";
            Err(refused(&format!("`{words}`: {error}"), help))
        }
    }
}

fn outcome(
    status: ExitStatus,
    refusal: Option<(String, String, bool)>,
    last: Vec<String>,
    command: String,
    stop: &Stop,
) -> Result<(), Failure> {
    match refusal {
        // The signal may have come to mpirun, too.
        _ if stop.is_asked() => Err(stopped(&command)),
        Some((found, help, true)) => Err(not_installed(&found, help)),
        Some((found, help, false)) => Err(refused(&found, help)),
        None if status.success() => Ok(()),
        None => {
            let status = in_words(status);
            let help = help(&format!("{status}\n{}", last.join("\n"))).to_owned();
            let shown = &last[last.len().saturating_sub(SHOWN)..];
            let said = if shown.is_empty() { "nothing".to_owned() } else { shown.join("\n") };
            let words = format!("--solver slepc: `{command}` failed ({status}); it said last:\n{said}");
            Err(Kind::Run.alone().found(status).help(help).says(words))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_mpirun_has_joined_are_taken_apart() {
        let refused = r#"{"error": "none {here}", "help": "install it", "is_missing": true}"#;
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
