//! Long work in a thread of its own, while this one listens to Ctrl-C.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError};
use pyo3::prelude::*;

use crate::threads::in_pool;

/// Time between two looks at signals.
const LOOK: Duration = Duration::from_millis(50);
/// Stack of the first thread of a program.
const STACK: usize = 8 << 20;

/// Says to work in another thread that nobody waits for it any longer.
#[derive(Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

/// The end of a thread that was stopped.
struct Stopped;

impl Stop {
    /// The flag, for work that looks at it.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        self.0.clone()
    }

    /// Ends this thread if it is to stop: it unwinds, like a panic that says nothing, so that files are closed and temporary
    /// ones removed.
    pub(crate) fn check(&self) {
        if self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    }
}

/// Does `work` without the GIL. Where a signal handler raises, `stop` is set; if `is_soon`, what the work gives then is
/// returned together with the exception; otherwise the exception alone, at once, and the thread ends by itself at its next
/// [`Stop::check`].
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    is_soon: impl Fn() -> bool,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<(T, Option<PyErr>)> {
    let (sender, mut receiver) = channel();
    let run = move || {
        // Where nobody waits any longer, nobody wants the result.
        let _ = sender.send(in_pool(work));
    };
    let thread = thread::Builder::new().name("flexframe".to_owned()).stack_size(STACK).spawn(run);
    let thread = thread.map_err(|error| PyOSError::new_err(format!("no thread can be started: {error}")))?;
    let mut raised = None;
    loop {
        let receiver = &mut receiver;
        match py.detach(move || receiver.recv_timeout(LOOK)) {
            Ok(result) => return Ok((result?, raised)),
            Err(RecvTimeoutError::Disconnected) => return Err(ended(raised, py.detach(|| thread.join()))),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(error) = py.check_signals() {
            stop.0.store(true, Ordering::Relaxed);
            if raised.is_some() || !is_soon() {
                return Err(error);
            }
            raised = Some(error);
        }
    }
}

/// Reason of a thread that has ended without a result.
fn ended(raised: Option<PyErr>, joined: Result<(), Box<dyn Any + Send>>) -> PyErr {
    match joined {
        Err(panic) if !panic.is::<Stopped>() => resume_unwind(panic),
        _ => raised.unwrap_or_else(|| PyKeyboardInterrupt::new_err(())),
    }
}
