//! Check that there is enough memory, before it is taken.
//!
//! An allocation that fails ends a Rust program by SIGABRT, and a machine without memory left ends it by SIGKILL. So
//! what needs much asks first with [`check`], or takes its array from [`zeros`], and has an error to give.
//!
//! Linux tells what is left; elsewhere only what the allocator refuses is known.

#![forbid(unsafe_code)]

mod bytes;
mod left;

use diagnostic::{Diagnosis, Diagnostic, Kind};

pub use bytes::Bytes;
pub use left::Left;

/// A piece of what many threads reserve, bytes.
const PIECE: usize = 1 << 30;
/// Less than this is not worth asking for.
const SMALL: usize = 1 << 20;

/// Memory that is not there.
#[derive(Debug, Clone, thiserror::Error)]
#[error(
    "not enough memory for {what}: {} wanted, {left}; use a coarser mesh, fewer modes, or a machine (or a limit) with more memory",
    Bytes(*wanted)
)]
pub struct OutOfMemory {
    /// Its purpose, such as "the factor of K + sM".
    pub what: &'static str,
    /// Bytes wanted.
    pub wanted: usize,
    /// The memory that is left, and by what limit.
    pub left: Left,
}

/// Asks whether `bytes` of memory can be had.
///
/// # Errors
/// [`OutOfMemory`] where the machine, the control group or the process's limit on its address space (`ulimit -v`) has
/// less.
pub fn check(what: &'static str, bytes: usize) -> Result<(), OutOfMemory> {
    check_with_reserve(what, bytes, 0)
}

/// As [`check`], for work that besides `bytes` reserves so much address space, in many places, without using it.
///
/// # Errors
/// As [`check`].
pub fn check_with_reserve(what: &'static str, bytes: usize, reserve: usize) -> Result<(), OutOfMemory> {
    let wanted = bytes.saturating_add(reserve);
    if wanted < SMALL {
        return Ok(());
    }
    if let Some(left) = Left::of_machine().filter(|left| left.bytes().is_some_and(|left| left < bytes)) {
        return Err(OutOfMemory { what, wanted: bytes, left });
    }
    // Nothing is touched, so nothing but address space is taken, and that is given back at once. Linux refuses one piece that is
    // larger than the machine, and not many.
    let pieces = std::iter::repeat_n(PIECE, reserve / PIECE).chain([bytes, reserve % PIECE]);
    let taken = |piece: usize| {
        let mut place = Vec::<u8>::new();
        place.try_reserve_exact(piece).map(|()| place)
    };
    match pieces.map(taken).collect::<Result<Vec<_>, _>>() {
        Ok(_) => Ok(()),
        Err(_) => Err(OutOfMemory { what, wanted, left: Left::of_process() }),
    }
}

/// An array of `length` zeros.
///
/// # Errors
/// [`OutOfMemory`].
pub fn zeros(what: &'static str, length: usize) -> Result<Vec<f64>, OutOfMemory> {
    let mut zeros = with_capacity(what, length)?;
    zeros.resize(length, 0.0);
    Ok(zeros)
}

/// An empty array with room for `length` values.
///
/// # Errors
/// [`OutOfMemory`].
pub fn with_capacity<T>(what: &'static str, length: usize) -> Result<Vec<T>, OutOfMemory> {
    let bytes = length.saturating_mul(size_of::<T>());
    check(what, bytes)?;
    let mut room = Vec::new();
    room.try_reserve_exact(length).map_err(|_| OutOfMemory { what, wanted: bytes, left: Left::of_process() })?;
    Ok(room)
}

impl Diagnostic for OutOfMemory {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Io.alone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_any_machine_has_is_refused_with_numbers() {
        let error = check("a test", 1 << 50).unwrap_err();
        let words = error.to_string();
        for expected in ["a test", "1125899.9 GB wanted", "left", "coarser mesh"] {
            assert!(words.contains(expected), "{expected} in: {words}");
        }
        assert!(zeros("a test", usize::MAX / 4).is_err());
        assert!(with_capacity::<f64>("a test", usize::MAX).is_err());
    }

    #[test]
    fn what_is_there_is_given() {
        check("a test", 1 << 22).unwrap();
        assert_eq!(zeros("a test", 1000).unwrap(), vec![0.0; 1000]);
    }

    #[test]
    fn bytes_are_written_in_three_digits_or_so() {
        assert_eq!(Bytes(840_600_000).to_string(), "841 MB");
        assert_eq!(Bytes(1_500_000_000).to_string(), "1.5 GB");
        assert_eq!(Bytes(1).to_string(), "1 MB");
    }
}
