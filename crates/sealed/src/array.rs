//! Arrays of numbers, and the kinds of numbers that a file has.

use std::borrow::Cow;

use bytemuck::Pod;
use serde::{Deserialize, Serialize};

/// An array; the last index runs fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Array<T> {
    /// Its length along each index; empty for a single number.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of the shape.
    pub values: Vec<T>,
}

/// A kind of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Floating-point numbers of 64 bits.
    F64,
    /// Floating-point numbers of 32 bits.
    F32,
    /// Unsigned integers of 64 bits.
    U64,
    /// Unsigned integers of 32 bits.
    U32,
}

impl Kind {
    /// Bytes of a number.
    pub fn bytes(self) -> usize {
        match self {
            Self::F64 | Self::U64 => 8,
            Self::F32 | Self::U32 => 4,
        }
    }
}

/// A number that a file may have.
pub trait Number: Pod {
    /// Its kind.
    const KIND: Kind;
    /// With its bytes in the other order.
    #[must_use]
    fn swapped(self) -> Self;
}

impl Number for f64 {
    const KIND: Kind = Kind::F64;

    fn swapped(self) -> Self {
        Self::from_bits(self.to_bits().swap_bytes())
    }
}

impl Number for f32 {
    const KIND: Kind = Kind::F32;

    fn swapped(self) -> Self {
        Self::from_bits(self.to_bits().swap_bytes())
    }
}

impl Number for u64 {
    const KIND: Kind = Kind::U64;

    fn swapped(self) -> Self {
        self.swap_bytes()
    }
}

impl Number for u32 {
    const KIND: Kind = Kind::U32;

    fn swapped(self) -> Self {
        self.swap_bytes()
    }
}

/// Bytes of an array; none where there are more than can be counted.
pub(crate) fn bytes(kind: Kind, shape: &[usize]) -> Option<u64> {
    let count = shape.iter().try_fold(1usize, |count, length| count.checked_mul(*length))?;
    count.checked_mul(kind.bytes()).map(|bytes| bytes as u64)
}

/// Numbers as they are in a file, the lowest byte first; no copy where they are so in memory, too.
pub fn little_endian<T: Number>(values: &[T]) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        return Cow::Borrowed(bytemuck::cast_slice(values));
    }
    let swapped: Vec<T> = values.iter().map(|value| value.swapped()).collect();
    Cow::Owned(bytemuck::cast_slice(&swapped).to_vec())
}
