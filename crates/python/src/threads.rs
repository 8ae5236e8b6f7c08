//! Work in threads, also in a process that Python has forked (`multiprocessing`, `os.fork`).

use flexframe::forked::{NoThreads, in_this_process};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// Does work in the pool of this process.
pub(crate) fn in_pool<T: Send>(work: impl FnOnce() -> T + Send) -> PyResult<T> {
    in_this_process(work).map_err(|error: NoThreads| PyOSError::new_err(error.to_string()))
}

/// The same without the GIL.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| in_pool(work))
}
