//! The head of a sealed file: where its datasets are, in a form that is read without HDF5.
//!
//! HDF5 is a library of C: a damaged or forged file can make it crash, run for ever, or write to other files, which it
//! opens where the file says so, and no look at its answers can prevent that. So HDF5 makes files, but never opens one to
//! read it or to go on with it. The head is in what HDF5 calls the user block and leaves alone. All numbers are taken from
//! this one file.
//!
//! | bytes | what; integers in 64 bits, the lowest byte first |
//! |---|---|
//! | 0–24 | `flexframe FORMAT, v. N`, blanks and a line feed |
//! | 24–32 | bytes of the file |
//! | 32–40 | bytes of the description |
//! | 40–72 | BLAKE3 of bytes 0–40, of the description, and of all that is in no dataset |
//! | 72– | the description as JSON: `texts` by name; `datasets` by path, with `kind`, `shape`, `start` (first byte, 0 where it is empty), `hash` (BLAKE3 of its bytes; none while its numbers change) |

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use keys::{Digest, Hash};
use serde::{Deserialize, Serialize};

use crate::array::{Kind, bytes};
use crate::error::SealedError;
use crate::format::{Format, MAGIC};

const HEAD: u64 = 72;
/// Bytes before the hash.
const BEFORE_HASH: usize = 40;
/// The longest description that is read, in bytes. A scene has at most 1 MiB, and points and modes to match.
const LONGEST: u64 = 64 << 20;
/// Bytes that are read at a time.
const BLOCK: usize = 1 << 14;

/// The texts and the datasets of a file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// By name.
    pub texts: BTreeMap<String, String>,
    /// By path.
    pub datasets: BTreeMap<String, StoredArray>,
}

/// Where a dataset is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoredArray {
    pub kind: Kind,
    pub shape: Vec<usize>,
    pub start: u64,
    /// In hexadecimal digits; none while the numbers change.
    pub hash: Option<String>,
}

impl StoredArray {
    /// Its bytes in the file; `None` where they cannot be counted.
    pub fn range(&self) -> Option<Range<u64>> {
        let bytes = bytes(self.kind, &self.shape)?;
        Some(self.start..self.start.checked_add(bytes)?)
    }
}

impl Description {
    fn to_json(&self) -> String {
        // All its keys are texts: it cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Size of the user block, of those that HDF5 allows. Starts and hashes must have as many digits as they can come to have.
    pub fn user_block(&self) -> u64 {
        (HEAD + self.to_json().len() as u64).next_power_of_two().max(512)
    }

    /// Writes the head of a file that is otherwise complete.
    pub fn write(&self, mut file: &File, format: &'static Format) -> io::Result<()> {
        let json = self.to_json();
        let length = file.metadata()?.len();
        let mut head = format.magic().to_vec();
        [length, json.len() as u64].iter().for_each(|number| head.extend(number.to_le_bytes()));
        let hash = self.hash(file, &head, json.as_bytes(), length)?;
        head.extend(hash.as_bytes());
        head.extend(json.as_bytes());
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&head)
    }

    /// Reads the head of a file, whose datasets are within it, after its head. One whose numbers change shares its place with
    /// no other.
    pub fn read(mut file: &File, path: &Path, format: &'static Format) -> Result<Self, SealedError> {
        let failed = |error| SealedError::system(path, "read the file")(error);
        let mut head = [0; HEAD as usize];
        match file.seek(SeekFrom::Start(0)).and_then(|_| file.read_exact(&mut head)) {
            Ok(()) if head.starts_with(&format.magic()) => {}
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(failed(error)),
            _ => {
                let path = path.to_owned();
                return Err(match format.other_version(&head) {
                    Some(found) => SealedError::OtherVersion { path, format, found },
                    None => SealedError::NoSeal { path, format },
                });
            }
        }
        let damaged = |what: String| SealedError::Damaged { path: path.to_owned(), format, what };
        let [sealed, described] = [MAGIC, MAGIC + 8].map(|at| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&head[at..at + 8]);
            u64::from_le_bytes(bytes)
        });
        let length = file.metadata().map_err(failed)?.len();
        if sealed != length {
            return Err(damaged(format!("it has {length} bytes where {sealed} were written")));
        }
        if described > LONGEST.min(length.saturating_sub(HEAD)) {
            return Err(damaged(format!("its head claims a description of {described} bytes")));
        }
        let mut json = vec![0; described as usize];
        file.read_exact(&mut json).map_err(failed)?;
        // Without what stands there.
        let description: Self = serde_json::from_slice(&json)
            .map_err(|error| damaged(format!("its description cannot be read from byte {} on", error.column())))?;
        if let Some(dataset) = description.misplaced(HEAD + described..length) {
            return Err(damaged(format!("its dataset {dataset} is not within it, in a place of its own")));
        }
        let found = description.hash(file, &head[..BEFORE_HASH], &json, length).map_err(failed)?;
        if found.as_bytes() != &head[BEFORE_HASH..] {
            return Err(damaged("its head or its structure has been changed".into()));
        }
        Ok(description)
    }

    /// A dataset that is not within `free`, or that changes in the place of another.
    fn misplaced(&self, free: Range<u64>) -> Option<&str> {
        let mut places = Vec::new();
        for (path, array) in &self.datasets {
            match array.range() {
                Some(range) if range.is_empty() => {}
                Some(range) if free.start <= range.start && range.end <= free.end => {
                    places.push((range.start, range.end, array.hash.is_none(), path));
                }
                _ => return Some(path),
            }
        }
        places.sort_unstable();
        // Ends of all before, and of those that change.
        let [mut end, mut end_of_open] = [0; 2];
        for (start, stop, is_open, path) in places {
            if start < end_of_open || is_open && start < end {
                return Some(path);
            }
            end = end.max(stop);
            end_of_open = if is_open { stop } else { end_of_open };
        }
        None
    }

    /// Hash of the head and of all that is in no dataset.
    fn hash(&self, mut file: &File, head: &[u8], json: &[u8], length: u64) -> io::Result<Hash> {
        let mut digest = Digest::new().numbers(head).numbers(json);
        let mut places: Vec<Range<u64>> = self.datasets.values().filter_map(StoredArray::range).collect();
        places.retain(|range| !range.is_empty());
        places.sort_unstable_by_key(|range| range.start);
        let mut block = [0; BLOCK];
        let mut start = HEAD + json.len() as u64;
        for Range { start: end, end: next } in places.into_iter().chain(std::iter::once(length..length)) {
            if start < end {
                file.seek(SeekFrom::Start(start))?;
                let mut rest = end - start;
                while rest > 0 {
                    let part = &mut block[..rest.min(BLOCK as u64) as usize];
                    file.read_exact(part)?;
                    digest = digest.numbers(part);
                    rest -= part.len() as u64;
                }
            }
            start = start.max(next);
        }
        Ok(digest.finish())
    }
}
