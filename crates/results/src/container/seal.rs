//! The seal of a results file: a description of it, and a check sum of what is not to change any more.
//!
//! HDF5 is a library of C: a damaged or forged file can make it crash, run for ever, or write to other files, which it
//! opens where the file says so, and no look at its answers can prevent that. So HDF5 makes results files, but never
//! opens one to read it or to go on with it. A file begins, in what HDF5 calls the user block and leaves alone, with a
//! description that says all that the reader must know: the metadata, and where the numbers are. The reader takes the
//! numbers from there, within this one file. A check sum finds damage. Of an unfinished file, whose structure is written
//! once and never touched again, it leaves out the numbers of the histories and the checkpoints. That of a finished one
//! is of all of it.
//!
//! | bytes | what, integers in 64 bits, the lowest byte first |
//! |---|---|
//! | 0–24 | `flexframe results, v. 6` and a line feed |
//! | 24–32 | CRC-32 of all bytes after it that are not left out |
//! | 32–40 | bytes of the file |
//! | 40–48 | bytes of the description |
//! | 48– | the description as JSON: `rows`, `checkpoint_words`, `starts` (first byte of the times, of each history and of the checkpoints, 0 where there is nothing), `arrays` (shapes of the bodies: `body`, `path`, `shape`, `start`), `metadata` |

use crate::FileError;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::iter::once;
use std::ops::Range;
use std::path::Path;

const MAGIC: &[u8; 24] = b"flexframe results, v. 6\n";

/// The version in it.
pub(crate) const VERSION: &str = "6";

/// Bytes of the magic text that are those of every version.
const ANY_VERSION: usize = 21;

/// Where the sum is.
const SUM: Range<u64> = 24..32;

/// Bytes before the description.
pub(crate) const HEAD: u64 = 48;

/// The longest description that is read, in bytes. A scene has at most 1 MiB, and not so many points and modes.
const LONGEST: u64 = 64 << 20;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 14;

/// Size of the user block, of those that HDF5 allows, for a description of that many bytes.
pub(crate) fn room(description: u64) -> u64 {
    (HEAD + description).next_power_of_two().max(512)
}

/// Bytes of a file that are not read for its check sum.
#[derive(Debug)]
pub(crate) struct Apart<'s> {
    pub range: Range<u64>,
    /// Check sum of the bytes, where it is known; without it they are left out.
    pub sum: Option<&'s crc32fast::Hasher>,
}

/// Seals the file, called `path` in messages, without a look at the ranges given, which are in order.
pub(crate) fn put(file: &File, path: &Path, description: &[u8], apart: &[Apart<'_>]) -> Result<(), FileError> {
    let failed = |error| FileError::system(path, "write the check sum of the file", &error);
    let length = file.metadata().map_err(failed)?.len();
    let mut head = MAGIC.to_vec();
    [0, length, description.len() as u64].iter().for_each(|number| head.extend(number.to_le_bytes()));
    head.extend(description);
    let write = |mut file: &File, at, bytes: &[u8]| {
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    };
    write(file, 0, &head).map_err(failed)?;
    let sum = sum(file, apart, length).map_err(failed)?;
    write(file, SUM.start, &u64::from(sum).to_le_bytes()).map_err(failed)
}

/// The description. Refuses a file that flexframe did not write, or whose length has changed.
pub(crate) fn description(mut file: &File, path: &Path) -> Result<Vec<u8>, FileError> {
    let failed = |error| FileError::system(path, "read the file", &error);
    let length = file.metadata().map_err(failed)?.len();
    let (_, sealed_length, described) = head(file, path)?;
    let damaged = |what: String| Err(FileError::Damaged { path: path.to_path_buf(), what });
    if sealed_length != length {
        return damaged(format!("it has {length} bytes where {sealed_length} were written"));
    }
    if described > LONGEST.min(length - HEAD) {
        return damaged(format!("its head claims a description of {described} bytes"));
    }
    let mut description = vec![0; described as usize];
    file.read_exact(&mut description).map_err(failed)?;
    Ok(description)
}

/// Refuses a file that is not as it was sealed. The ranges apart are in order, and within the file.
pub(crate) fn check(file: &File, path: &Path, apart: &[Apart<'_>]) -> Result<(), FileError> {
    let (written, length, _) = head(file, path)?;
    let found = sum(file, apart, length).map_err(|error| FileError::system(path, "read the file", &error))?;
    if u64::from(found) == written {
        return Ok(());
    }
    let what = format!("its check sum is {found:08x} where {written:08x} was written");
    Err(FileError::Damaged { path: path.to_path_buf(), what })
}

/// Check sum, length of the file, and length of its description, as its head has them.
fn head(mut file: &File, path: &Path) -> Result<(u64, u64, u64), FileError> {
    let mut head = [0; HEAD as usize];
    let outcome = file.seek(SeekFrom::Start(0)).and_then(|_| file.read_exact(&mut head));
    match (outcome, head[MAGIC.len()..].as_chunks().0) {
        (Ok(()), &[sum, length, described]) if head.starts_with(MAGIC) => {
            Ok((u64::from_le_bytes(sum), u64::from_le_bytes(length), u64::from_le_bytes(described)))
        }
        (Err(error), _) if error.kind() != io::ErrorKind::UnexpectedEof => {
            Err(FileError::system(path, "read the file", &error))
        }
        _ => Err(match other_version(&head) {
            Some(found) => FileError::OtherVersion { path: path.to_path_buf(), found, expected: VERSION },
            None => FileError::NoSeal { path: path.to_path_buf() },
        }),
    }
}

/// The version that a head claims, where it is another one.
fn other_version(head: &[u8]) -> Option<String> {
    let claimed = head.get(ANY_VERSION..MAGIC.len()).filter(|_| head.starts_with(&MAGIC[..ANY_VERSION]))?;
    let version = std::str::from_utf8(claimed).ok()?.trim();
    let is_number = !version.is_empty() && version.bytes().all(|byte| byte.is_ascii_digit());
    (is_number && version != VERSION).then(|| version.to_owned())
}

/// True if a file claims to be one of ours, of any version.
pub(crate) fn is_claimed(path: &Path) -> bool {
    let mut magic = [0; ANY_VERSION];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && MAGIC.starts_with(&magic)
}

/// CRC-32 of the bytes after the sum, up to `length`, but for those that are left out.
fn sum(mut file: &File, apart: &[Apart<'_>], length: u64) -> io::Result<u32> {
    let mut hasher = crc32fast::Hasher::new();
    let mut block = [0; BLOCK];
    let mut start = SUM.end;
    for Apart { range, sum } in apart.iter().chain(once(&Apart { range: length..length, sum: None })) {
        file.seek(SeekFrom::Start(start))?;
        let mut rest = range.start - start;
        while rest > 0 {
            let part = &mut block[..rest.min(BLOCK as u64) as usize];
            file.read_exact(part)?;
            hasher.update(part);
            rest -= part.len() as u64;
        }
        if let Some(sum) = sum {
            hasher.combine(sum);
        }
        start = range.end;
    }
    Ok(hasher.finalize())
}
