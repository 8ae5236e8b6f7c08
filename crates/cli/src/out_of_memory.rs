//! The last resort where memory runs out in spite of all that asks before: an allocation of a library that is refused
//! ends the program by SIGABRT, or by a panic. Here that becomes a message and an exit code.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

use signal_hook::consts::SIGABRT;
use signal_hook::low_level;

/// The exit code where the system refuses something.
const REFUSED: u8 = 6;

/// Bytes of the last allocation that was refused; zero if none was.
static WANTED: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, which remembers what it has refused.
struct Watched;

#[global_allocator]
static ALLOCATOR: Watched = Watched;

fn watched(pointer: *mut u8, size: usize) -> *mut u8 {
    if pointer.is_null() {
        WANTED.store(size, Ordering::Relaxed);
    }
    pointer
}

// SAFETY: every call goes to the system's allocator with the caller's own arguments, and what that gives is given back.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        watched(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        watched(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        watched(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// From here on, an abort or a panic after a refused allocation ends the program in words.
pub fn listen() -> std::io::Result<()> {
    // SAFETY: abort() raises SIGABRT in the thread that calls it, between two statements, so this is no interruption of
    // anything; it allocates nothing.
    #[allow(unsafe_code)]
    unsafe {
        low_level::register(SIGABRT, end_if_refused)?;
    }
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        end_if_refused();
        usual(info);
    }));
    Ok(())
}

/// Ends the program where an allocation has been refused.
fn end_if_refused() {
    let wanted = WANTED.load(Ordering::Relaxed);
    if wanted > 0 {
        // Where it cannot be written, the exit code still tells.
        let _ = writeln!(
            std::io::stderr(),
            "error: not enough memory: {wanted} bytes more were wanted and not given; use a coarser mesh, fewer modes, \
             fewer threads (--threads 1), or a machine (or a limit) with more memory"
        );
        low_level::exit(REFUSED.into());
    }
}
