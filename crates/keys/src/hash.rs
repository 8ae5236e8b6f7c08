//! Hashes of contents: BLAKE3, of which no two contents are known to have the same, not even on purpose, and which is as fast
//! as the memory.

use std::borrow::Cow;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::str::FromStr;

use bytemuck::NoUninit;

/// More bytes than these are hashed on all cores.
const PARALLEL: usize = 1 << 20;
/// Bytes of a file that are read at a time.
const BLOCK: usize = 4 << 20;

/// The hash of a content, 32 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Hash([u8; 32]);

impl Hash {
    /// The hash of some numbers.
    pub fn of<T: NoUninit>(values: &[T]) -> Self {
        let mut hasher = blake3::Hasher::new();
        update(&mut hasher, bytemuck::cast_slice(values));
        Self(*hasher.finalize().as_bytes())
    }

    /// The hash of some lists of numbers, which is that of one list with all of them.
    pub fn of_lists<'a, T: NoUninit>(lists: impl IntoIterator<Item = Cow<'a, [T]>>) -> Self {
        let mut hasher = blake3::Hasher::new();
        lists.into_iter().for_each(|list| update(&mut hasher, bytemuck::cast_slice(&list)));
        Self(*hasher.finalize().as_bytes())
    }

    /// The hash of the bytes of a file.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn of_file(path: &Path) -> io::Result<Self> {
        HashedReader::new(File::open(path)?).finish()
    }

    /// Its bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

/// From hexadecimal digits.
impl FromStr for Hash {
    type Err = blake3::HexError;

    fn from_str(digits: &str) -> Result<Self, Self::Err> {
        blake3::Hash::from_hex(digits).map(|hash| Self(*hash.as_bytes()))
    }
}

/// In hexadecimal digits.
impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

/// Hashes what is read through it: what is known of a file is of the bytes that were read, whatever becomes of the file.
#[derive(Debug)]
pub struct HashedReader<R> {
    reader: R,
    hasher: Box<blake3::Hasher>,
}

impl<R: Read> HashedReader<R> {
    /// Around a reader of which nothing has been read yet.
    pub fn new(reader: R) -> Self {
        Self { reader, hasher: Box::default() }
    }

    /// The hash of what has been read.
    pub fn so_far(&self) -> Hash {
        Hash(*self.hasher.finalize().as_bytes())
    }

    /// Reads what is left. Returns the hash of all.
    ///
    /// # Errors
    /// Errors of the reader.
    pub fn finish(mut self) -> io::Result<Hash> {
        let mut block = vec![0; BLOCK];
        while self.read(&mut block)? > 0 {}
        Ok(self.so_far())
    }
}

impl<R: Read> Read for HashedReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(bytes)?;
        update(&mut self.hasher, &bytes[..count]);
        Ok(count)
    }
}

/// Makes one hash of several parts. Where a part ends is hashed with it.
#[derive(Debug, Clone, Default)]
pub struct Digest(blake3::Hasher);

impl Digest {
    /// The digest of nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// With a text.
    #[must_use]
    pub fn text(self, text: &str) -> Self {
        self.numbers(text.as_bytes())
    }

    /// With numbers.
    #[must_use]
    pub fn numbers<T: NoUninit>(mut self, values: &[T]) -> Self {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        update(&mut self.0, bytes);
        self
    }

    /// With a hash.
    #[must_use]
    pub fn hash(self, hash: &Hash) -> Self {
        self.numbers(&hash.0)
    }

    /// The hash of all of it.
    pub fn finish(self) -> Hash {
        Hash(*self.0.finalize().as_bytes())
    }
}

fn update(hasher: &mut blake3::Hasher, bytes: &[u8]) {
    if bytes.len() > PARALLEL {
        hasher.update_rayon(bytes)
    } else {
        hasher.update(bytes)
    };
}
