//! The threads for meshes and modes.

use crate::cli_error::CliError;

/// The most that may be asked for.
pub const MOST: u16 = 256;

/// Starts them: so many, or as many as RAYON_NUM_THREADS says, or one for each core. Left to itself, the library starts
/// them at their first use, and panics where it cannot.
pub fn start(count: Option<u16>) -> Result<(), CliError> {
    let count = match count {
        Some(count) => Some(count),
        None => variable()?,
    };
    rayon::ThreadPoolBuilder::new().num_threads(count.map_or(0, usize::from)).build_global().map_err(|error| {
        let reason = std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
        CliError::Threads { count, reason }
    })
}

fn variable() -> Result<Option<u16>, CliError> {
    let Some(found) = std::env::var_os("RAYON_NUM_THREADS").filter(|text| !text.is_empty()) else { return Ok(None) };
    let count = found.to_str().and_then(|text| text.trim().parse().ok()).filter(|count| (1..=MOST).contains(count));
    count.map(Some).ok_or_else(|| CliError::ThreadsVariable { found: found.display().to_string(), most: MOST })
}
