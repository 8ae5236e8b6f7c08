//! The seal of a results file: a check sum of what is not to change any more.
//!
//! HDF5 is a library of C: a damaged file can make it crash or run for ever, and no look at its answers can prevent
//! that. So the file begins with a sum of its bytes, in what HDF5 calls the user block and leaves alone, and the reader
//! compares before HDF5 sees the file. Of an unfinished file, whose structure is written once and never touched again,
//! the sum leaves out the numbers of the histories and the checkpoints, which HDF5 only copies, and a flag of HDF5's for
//! a file that is being written. That of a finished one is of all of it.
//!
//! | bytes | what, integers in 64 bits, the lowest byte first |
//! |---|---|
//! | 0–24 | `flexframe results, v. 1` and a line feed |
//! | 24–32 | CRC-32 of all bytes after it that are not left out |
//! | 32–40 | bytes of the file |
//! | 40–48 | ranges that are left out |
//! | 48– | first byte, and first byte after, of each |

use crate::FileError;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::iter::once;
use std::ops::Range;
use std::path::Path;

const MAGIC: &[u8; 24] = b"flexframe results, v. 1\n";

/// Where the sum is, and where what it is of begins.
const SUM: Range<u64> = 24..32;

/// Bytes before the ranges, and of each.
const HEAD: u64 = 48;
const RANGE: u64 = 16;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 14;

/// Size of the user block, of those that HDF5 allows, in which so many ranges can be left out.
pub(crate) fn room(ranges: usize) -> u64 {
    (HEAD + RANGE * ranges as u64).next_power_of_two().max(512)
}

/// Seals the file `place`, called `path` in messages, leaving out the ranges given, which are in order.
pub(crate) fn put(place: &Path, path: &Path, left_out: &[Range<u64>]) -> Result<(), FileError> {
    let failed = |error| FileError::system(path, "write the check sum of the file", &error);
    let mut file = OpenOptions::new().read(true).write(true).open(place).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    let mut head = MAGIC.to_vec();
    let numbers = [0, length, left_out.len() as u64].into_iter();
    for number in numbers.chain(left_out.iter().flat_map(|range| [range.start, range.end])) {
        head.extend(number.to_le_bytes());
    }
    let write = |file: &mut File, at, bytes: &[u8]| {
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    };
    write(&mut file, 0, &head).map_err(failed)?;
    let sum = sum(&mut file, left_out, length).map_err(failed)?;
    write(&mut file, SUM.start, &u64::from(sum).to_le_bytes()).map_err(failed)
}

/// Refuses a file that is none of ours or not as it was sealed.
pub(crate) fn check(path: &Path) -> Result<(), FileError> {
    let failed = |error| FileError::system(path, "read the file", &error);
    let mut file = File::open(path).map_err(|error| FileError::system(path, "open the file", &error))?;
    let length = file.metadata().map_err(failed)?.len();
    let mut head = [0; HEAD as usize];
    if length < HEAD || file.read_exact(&mut head).is_err() || !head.starts_with(MAGIC) {
        return Err(FileError::NoSeal { path: path.to_path_buf() });
    }
    let damaged = |what: String| Err(FileError::Damaged { path: path.to_path_buf(), what });
    let (words, _) = head[MAGIC.len()..].as_chunks().0.split_at(3);
    let &[written, sealed_length, ranges] = words else { return damaged("its head is cut off".into()) };
    let [written, sealed_length, ranges] = [written, sealed_length, ranges].map(u64::from_le_bytes);
    if sealed_length != length {
        return damaged(format!("it has {length} bytes where {sealed_length} were written"));
    }
    if ranges > (length - HEAD) / RANGE {
        return damaged(format!("it is too short for the {ranges} ranges that its head claims"));
    }
    let mut left_out = Vec::new();
    let mut end = HEAD + RANGE * ranges;
    let mut of_ranges = vec![0; (RANGE * ranges) as usize];
    file.read_exact(&mut of_ranges).map_err(failed)?;
    for [start, stop] in of_ranges.as_chunks().0.as_chunks().0 {
        let range = u64::from_le_bytes(*start)..u64::from_le_bytes(*stop);
        if range.start < end || range.end < range.start || length < range.end {
            return damaged(format!("bytes {range:?} of its histories are not in order"));
        }
        end = range.end;
        left_out.push(range);
    }
    let found = u64::from(sum(&mut file, &left_out, length).map_err(failed)?);
    if found == written {
        return Ok(());
    }
    damaged(format!("its check sum is {found:08x} where {written:08x} was written"))
}

/// Whether a file claims to be one of ours.
pub(crate) fn is_claimed(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == *MAGIC
}

/// CRC-32 of the bytes after the sum, up to `length`, that are in none of the ranges.
fn sum(file: &mut File, left_out: &[Range<u64>], length: u64) -> io::Result<u32> {
    let mut hasher = crc32fast::Hasher::new();
    let mut block = [0; BLOCK];
    let mut start = SUM.end;
    for range in left_out.iter().cloned().chain(once(length..length)) {
        file.seek(SeekFrom::Start(start))?;
        let mut rest = range.start - start;
        while rest > 0 {
            let part = &mut block[..rest.min(BLOCK as u64) as usize];
            file.read_exact(part)?;
            hasher.update(part);
            rest -= part.len() as u64;
        }
        start = range.end;
    }
    Ok(hasher.finalize())
}
