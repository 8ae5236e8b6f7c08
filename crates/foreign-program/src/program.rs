//! A program of others.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::error::ProgramError;
use crate::guard::MARK;
use crate::lines::{Stream, listen};
use crate::running::Running;

/// Time between two looks at the limits and at the wish to stop.
const LOOK: Duration = Duration::from_millis(50);
/// Between two looks at whether a program that says nothing more has ended.
const SHORT_LOOK: Duration = Duration::from_millis(2);
/// Between two looks at the bytes in its folder.
const MEASURE: Duration = Duration::from_millis(500);
/// Time within which the last lines arrive that it has said before it ended.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// Lines that wait to be heard.
const WAITING: usize = 1000;

/// Limits of a program.
#[derive(Debug, Clone, Copy, Default)]
pub struct Limits {
    /// Time; any if not given.
    pub time: Option<Duration>,
    /// Bytes in its private folder; any if not given.
    pub bytes: Option<u64>,
    /// Bytes of the address space of each of its processes; any if not given. Only Linux has this limit.
    pub memory: Option<u64>,
}

/// The program that an environment variable names, or the usual one. A relative path is one from the current folder, and not
/// from that in which the program will work.
pub fn named(variable: &str, usual: &str) -> OsString {
    let name = std::env::var_os(variable).filter(|name| !name.is_empty()).unwrap_or_else(|| usual.into());
    let is_path = Path::new(&name).components().count() > 1;
    match std::path::absolute(&name) {
        Ok(path) if is_path => path.into(),
        _ => name,
    }
}

/// A program of others that is about to be run.
#[derive(Debug)]
pub struct ForeignProgram {
    command: Command,
    /// The private folder.
    folder: PathBuf,
}

impl ForeignProgram {
    /// A program that works in a private folder, whose path is one from the root. The folder is removed where this program ends
    /// before the other.
    pub fn new(program: &OsStr, folder: &Path) -> Self {
        let mut command = Command::new(program);
        // Variables of the user that change what Python does or where it looks for modules are for programs of the user's own.
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.as_encoded_bytes().starts_with(b"PYTHON")) {
            command.env_remove(name);
        }
        // Python 3.11 and later do not look for modules in the folder of the program. (Others do, and find what is private.)
        command.env("PYTHONSAFEPATH", "1");
        let program = Self { command, folder: folder.to_owned() };
        program.in_folder(folder)
    }

    /// Lets it work in another folder than its private one: for what may do what it likes.
    pub fn in_folder(mut self, folder: &Path) -> Self {
        self.command.current_dir(folder).env("PWD", folder);
        self
    }

    /// An argument. A path should be one from the root: the program works in another folder.
    pub fn arg(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.command.arg(argument);
        self
    }

    /// Arguments.
    pub fn args(mut self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Self {
        self.command.args(arguments);
        self
    }

    /// An environment variable.
    pub fn env(mut self, name: &str, value: impl AsRef<OsStr>) -> Self {
        self.command.env(name, value);
        self
    }

    /// Runs it to its end. `hear` gets what it says, `stop` says whether it is to stop.
    ///
    /// # Errors
    /// [`ProgramError`]. Neither it nor anything that it has started is left then, nor is its private folder.
    pub fn run(
        mut self,
        limits: Limits,
        stop: impl Fn() -> bool,
        mut hear: impl FnMut(Stream, String),
    ) -> Result<ExitStatus, ProgramError> {
        self.command.env(MARK, &self.folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut running = Running::start(&mut self.command, &self.folder, limits.memory)?;
        let (send, receive) = sync_channel(WAITING);
        if let Some(pipe) = running.child().stdout.take() {
            listen(pipe, Stream::Output, send.clone()).map_err(ProgramError::Start)?;
        }
        if let Some(pipe) = running.child().stderr.take() {
            listen(pipe, Stream::Error, send).map_err(ProgramError::Start)?;
        }
        let started = Instant::now();
        let (mut looked, mut measured) = (started, started);
        let mut failure = None;
        while failure.is_none() {
            if stop() {
                failure = Some(ProgramError::Stopped);
            } else if let Some(most) = limits.time.filter(|most| started.elapsed() >= *most) {
                failure = Some(ProgramError::Time(most));
            } else if let Some(most) = limits.bytes.filter(|_| measured.elapsed() >= MEASURE) {
                measured = Instant::now();
                failure = Some(bytes_in(&self.folder))
                    .filter(|found| *found > most)
                    .map(|found| ProgramError::Bytes { found, most });
            }
            let is_silent = match receive.recv_timeout(LOOK) {
                Ok((stream, line)) => {
                    hear(stream, line);
                    false
                }
                Err(RecvTimeoutError::Timeout) => true,
                Err(RecvTimeoutError::Disconnected) => {
                    sleep(SHORT_LOOK);
                    true
                }
            };
            if is_silent || looked.elapsed() >= LOOK {
                looked = Instant::now();
                if running.has_ended()? {
                    break;
                }
            }
        }
        if let Some(failure) = failure {
            // Nobody listens any longer, so that it is not kept from ending by what it has to say.
            drop(receive);
            drop(running);
            return Err(failure);
        }
        running.end_group();
        let deadline = Instant::now() + LAST_WORDS;
        let left = || deadline.checked_duration_since(Instant::now());
        while let Some(Ok((stream, line))) = left().map(|left| receive.recv_timeout(left)) {
            hear(stream, line);
        }
        running.finish()
    }
}

/// The bytes of the files in a folder.
fn bytes_in(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.metadata().ok()).map(|found| found.len()).sum()
}
