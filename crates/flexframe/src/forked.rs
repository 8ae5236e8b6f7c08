//! Work in threads, also in a process that was forked.
//!
//! A forked process has one thread: those of rayon's pool are not there, but rayon does not know, and waits for them for ever.
//! So a library in a program that forks (Python's `multiprocessing`, a host of FMUs) does its work by [`in_this_process`]. In the
//! process that has loaded it, that is nothing more than a call. In a forked one, the work finds a pool of that process.

use std::process;
use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The process that has loaded this library, whose threads are those of rayon's global pool.
static HOME: OnceLock<u32> = OnceLock::new();
/// The pools of processes forked from it. A forked process has the list of its parent, and adds its own.
static POOLS: OnceLock<Box<Link>> = OnceLock::new();

struct Link {
    process: u32,
    pool: ThreadPool,
    next: OnceLock<Box<Link>>,
}

/// The threads of a forked process cannot be started.
#[derive(Debug, thiserror::Error)]
#[error("this process was forked, and needs threads of its own, which cannot be started: {0}")]
pub struct NoThreads(#[from] ThreadPoolBuildError);

/// Remembers this process as the one that rayon's threads are in. Called when the library is loaded, before anything else.
pub fn loaded() {
    HOME.get_or_init(process::id);
}

/// Does some work, in the pool of this process if it was forked.
///
/// # Errors
/// [`NoThreads`].
pub fn in_this_process<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, NoThreads> {
    let process = process::id();
    if *HOME.get_or_init(|| process) == process {
        return Ok(work());
    }
    Ok(pool_of(process)?.install(work))
}

fn pool_of(process: u32) -> Result<&'static ThreadPool, ThreadPoolBuildError> {
    let mut place = &POOLS;
    loop {
        match place.get() {
            Some(link) if link.process == process => return Ok(&link.pool),
            Some(link) => place = &link.next,
            None => {
                // Made before, so that nobody who forks meanwhile leaves a place that is being filled for ever. Where another
                // thread of this process was faster, its pool is taken.
                let pool = ThreadPoolBuilder::new().build()?;
                let _ = place.set(Box::new(Link { process, pool, next: OnceLock::new() }));
            }
        }
    }
}
