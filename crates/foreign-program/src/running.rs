//! A program that runs, in a process group of its own.

use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus};

use rustix::io::Errno;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use crate::error::ProgramError;
use crate::guard::Guard;

/// A program and its guard.
#[derive(Debug)]
pub(crate) struct Running {
    child: Child,
    /// The id of the program and of its group; none once it is reaped.
    id: Option<Pid>,
    guard: Guard,
}

impl Running {
    pub(crate) fn start(command: &mut Command, folder: &Path, memory: Option<u64>) -> Result<Self, ProgramError> {
        let mut child = command.process_group(0).spawn().map_err(ProgramError::Start)?;
        let id = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
        limit_memory(id, memory);
        match Guard::over(child.id(), folder) {
            Ok(guard) => Ok(Self { id, child, guard }),
            Err(error) => {
                let _ = child.kill();
                let _ = child.wait();
                Err(error)
            }
        }
    }

    pub(crate) fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// True if it has ended. It stays the name of its group.
    pub(crate) fn has_ended(&self) -> Result<bool, ProgramError> {
        let Some(id) = self.id else { return Ok(true) };
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(id), options) {
            Ok(status) => Ok(status.is_some()),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(ProgramError::Wait(error.into())),
        }
    }

    /// Ends what is left of its group, when it has ended itself.
    pub(crate) fn end_group(&self) {
        if let Some(id) = self.id {
            let _ = kill_process_group(id, Signal::KILL);
        }
    }

    /// How it has ended. What it has left running is ended.
    pub(crate) fn finish(mut self) -> Result<ExitStatus, ProgramError> {
        self.end_group();
        self.id = None;
        let status = self.child.wait().map_err(ProgramError::Wait);
        self.guard.has_ended();
        self.guard.wait();
        status
    }
}

/// Limits the address space of a process and of those that it starts from now on. One that has ended needs no limit.
#[cfg(target_os = "linux")]
fn limit_memory(id: Option<Pid>, memory: Option<u64>) {
    use rustix::process::{Resource, Rlimit, getrlimit, prlimit};
    let hard = getrlimit(Resource::As).maximum;
    let Some(limit) = memory.map(|memory| hard.map_or(memory, |hard| hard.min(memory))) else { return };
    let _ = id.map(|id| prlimit(Some(id), Resource::As, Rlimit { current: Some(limit), maximum: Some(limit) }));
}

#[cfg(not(target_os = "linux"))]
fn limit_memory(_: Option<Pid>, _: Option<u64>) {}

/// Ends it, with all that it has started, unless it has been finished.
impl Drop for Running {
    fn drop(&mut self) {
        if self.id.take().is_some() {
            self.guard.begin_the_end();
            let _ = self.child.wait();
            self.guard.wait();
        }
    }
}
