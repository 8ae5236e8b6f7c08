//! The threads for meshes and modes.

use diagnostic::{Failure, Kind};

/// The most that may be asked for.
pub const MOST: u16 = 256;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// Starts them: the number given, or as many as RAYON_NUM_THREADS says, or one for each core. Left to itself, the library starts
/// them at their first use, and panics where it cannot.
pub fn start(count: Option<u16>) -> Result<(), Failure> {
    let count = match count {
        Some(count) => Some(count),
        None => variable()?,
    };
    let threads = count.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    // A thread that has begun panics where there is no room for its signal stack, so the room is asked for before: the
    // stacks, and as much again for what a thread allocates when it begins.
    memory::check_with_reserve("the stacks of the threads", 0, 2 * threads * STACK)
        .map_err(|error| not_started(count, &error.to_string()))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK);
    pool.build_global().map_err(|error| {
        let reason = std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
        not_started(count, &reason)
    })
}

/// The error of a system that gives no threads.
fn not_started(count: Option<u16>, reason: &str) -> Failure {
    let threads =
        count.map_or_else(|| "the threads, one for each core,".to_owned(), |count| format!("{count} threads"));
    let words = format!("{threads} cannot be started: {reason}");
    Kind::Io.alone().help("ask for fewer with --threads").says(words)
}

fn variable() -> Result<Option<u16>, Failure> {
    let Some(found) = std::env::var_os("RAYON_NUM_THREADS").filter(|text| !text.is_empty()) else { return Ok(None) };
    let count = found.to_str().and_then(|text| text.trim().parse().ok()).filter(|count| (1..=MOST).contains(count));
    count.map(Some).ok_or_else(|| {
        let wrong = Kind::Usage.alone().key("RAYON_NUM_THREADS").found(format!("\"{}\"", found.display()));
        wrong.expected(format!("a number from 1 to {MOST}")).help("correct it, remove it, or give --threads").into()
    })
}
