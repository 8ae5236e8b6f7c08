//! The head of a body file: where its datasets are, in a form that is read without HDF5.
//!
//! It is in what HDF5 calls the user block and leaves alone.
//!
//! | bytes | what; numbers as the machine has them |
//! |---|---|
//! | 0–16 | `flexframe body`, a blank and a line feed |
//! | 16–20 | version of the format |
//! | 20–24 | 0x01020304, which tells the order of the bytes |
//! | 24–32 | bytes of the file |
//! | 32–40 | bytes of the description |
//! | 40–72 | BLAKE3 of bytes 0–40 and of the description |
//! | 72– | the description as JSON: `attributes` by name; `datasets` by path, with `kind`, `shape`, `start` (first byte, 0 where it is empty), `hash` (BLAKE3 of its bytes) |

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::array::{Kind, bytes};
use crate::error::BodyFileError;
use keys::{Digest, Hash};

const MAGIC: &[u8; 16] = b"flexframe body \n";
/// The version of the format that is written and read.
pub(crate) const VERSION: u32 = 1;
const BYTE_ORDER: u32 = 0x0102_0304;
const HEAD: u64 = 72;
/// The longest description that is read, in bytes.
const LONGEST: u64 = 64 << 20;

/// The datasets of a file, and their places.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// Texts by name.
    pub attributes: BTreeMap<String, String>,
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
    /// In hexadecimal digits.
    pub hash: String,
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
    pub fn write(&self, mut file: &File) -> io::Result<()> {
        let json = self.to_json();
        let mut head = MAGIC.to_vec();
        head.extend(VERSION.to_ne_bytes());
        head.extend(BYTE_ORDER.to_ne_bytes());
        head.extend(file.metadata()?.len().to_ne_bytes());
        head.extend((json.len() as u64).to_ne_bytes());
        let hash = hash(&head, json.as_bytes());
        head.extend(hash.as_bytes());
        head.extend(json.as_bytes());
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&head)
    }

    /// Reads the head of a file. Every dataset is within the file, after its head.
    pub fn read(mut file: &File, path: &Path) -> Result<Self, BodyFileError> {
        let failed = BodyFileError::system(path, "read the file");
        let mut head = [0; HEAD as usize];
        match file.seek(SeekFrom::Start(0)).and_then(|_| file.read_exact(&mut head)) {
            Ok(()) if head.starts_with(MAGIC) => {}
            Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(failed(error)),
            _ => return Err(BodyFileError::NotABody { path: path.to_owned() }),
        }
        let word = |at: usize| u32::from_ne_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let long = |at: usize| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&head[at..at + 8]);
            u64::from_ne_bytes(bytes)
        };
        match (word(16), word(20)) {
            (_, order) if order == BYTE_ORDER.swap_bytes() => {
                return Err(BodyFileError::OtherMachine { path: path.to_owned() });
            }
            (VERSION, BYTE_ORDER) => {}
            (found, BYTE_ORDER) => {
                return Err(BodyFileError::OtherVersion { path: path.to_owned(), found, expected: VERSION });
            }
            _ => return Err(BodyFileError::NotABody { path: path.to_owned() }),
        }
        let damaged = |what: String| BodyFileError::Damaged { path: path.to_owned(), what };
        let (sealed, described) = (long(24), long(32));
        let length = file.metadata().map_err(BodyFileError::system(path, "read the file"))?.len();
        if sealed != length {
            return Err(damaged(format!("it has {length} bytes where {sealed} were written")));
        }
        if described > LONGEST.min(length.saturating_sub(HEAD)) {
            return Err(damaged(format!("its head claims a description of {described} bytes")));
        }
        let mut json = vec![0; described as usize];
        file.read_exact(&mut json).map_err(BodyFileError::system(path, "read the file"))?;
        if hash(&head[..40], &json).as_bytes() != &head[40..] {
            return Err(damaged("its head has been changed".into()));
        }
        let description: Self = serde_json::from_slice(&json)
            .map_err(|error| damaged(format!("its head cannot be read from byte {} on", error.column())))?;
        let is_within = |place: &StoredArray| {
            let end = bytes(place.kind, &place.shape).and_then(|bytes| match bytes {
                0 => Some(length),
                _ if place.start < HEAD + described => None,
                _ => place.start.checked_add(bytes),
            });
            end.is_some_and(|end| end <= length)
        };
        match description.datasets.iter().find(|(_, place)| !is_within(place)) {
            Some((dataset, _)) => Err(damaged(format!("its dataset {dataset} is not within it"))),
            None => Ok(description),
        }
    }
}

fn hash(head: &[u8], json: &[u8]) -> Hash {
    Digest::new().numbers(head).numbers(json).finish()
}
