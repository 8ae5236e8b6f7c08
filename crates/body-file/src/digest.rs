//! Hashes of contents: BLAKE3, of which no two contents are known to have the same, not even on purpose, and which is as fast
//! as the memory.

use std::fmt;

use bytemuck::NoUninit;

/// More bytes than these are hashed on all cores.
const PARALLEL: usize = 1 << 20;

/// The hash of a content, 32 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Hash([u8; 32]);

impl Hash {
    /// Of some numbers.
    pub fn of<T: NoUninit>(values: &[T]) -> Self {
        let mut hasher = blake3::Hasher::new();
        update(&mut hasher, bytemuck::cast_slice(values));
        Self(*hasher.finalize().as_bytes())
    }

    /// Its bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

/// In hexadecimal digits.
impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

/// Makes one hash of several parts. Where a part ends is hashed with it.
#[derive(Debug, Clone, Default)]
pub struct Digest(blake3::Hasher);

impl Digest {
    /// Of nothing yet.
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
    if bytes.len() > PARALLEL { hasher.update_rayon(bytes) } else { hasher.update(bytes) };
}
