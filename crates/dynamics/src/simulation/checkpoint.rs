//! A run's state as bytes, so that it can be taken up again in another process.
//!
//! States are encoded by serde and postcard. Counts and optional values take the same room whatever they are, so that all
//! checkpoints of a run are equally long, and a file can have a place for them.

use std::borrow::Borrow;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::SetupError;

/// A checkpoint that cannot be made, or that does not belong to the run that is to go on from it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum CheckpointError {
    /// It was made by a run of something else.
    #[error(
        "the checkpoint is that of another run: {what} has changed since; put back what was changed, or run the scene again from its beginning"
    )]
    Changed { what: String },
    /// It was written by another version of the program.
    #[error(
        "the checkpoint is in version {found} of its data, and this program reads version {expected}: it was written by another version of \
         flexframe; run the scene again from its beginning"
    )]
    Version { found: u32, expected: u32 },
    /// The bytes are too few, too many, or hold no state.
    #[error("the checkpoint cannot be decoded: {0}; run the scene again from its beginning")]
    Encoding(#[from] postcard::Error),
    /// A state with lists of the wrong length, or with numbers that are not finite.
    #[error("the checkpoint does not hold a state of this run: {0}; run the scene again from its beginning")]
    State(#[from] SetupError),
    /// A value that no run can have left.
    #[error(
        "the checkpoint does not hold a state of this run: {what} is out of its range; run the scene again from its beginning"
    )]
    Value { what: &'static str },
}

/// The bytes of a value.
///
/// # Errors
/// [`CheckpointError::Encoding`] for a type that postcard cannot encode.
pub fn encode(value: &impl Serialize) -> Result<Vec<u8>, CheckpointError> {
    Ok(postcard::to_allocvec(value)?)
}

/// The value of [`encode`]d bytes. Its sizes and numbers are still to be checked.
///
/// # Errors
/// [`CheckpointError::Encoding`] for bytes that are not those of such a value.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointError> {
    match postcard::take_from_bytes(bytes)? {
        (value, []) => Ok(value),
        _ => Err(postcard::Error::DeserializeBadEncoding.into()),
    }
}

/// Bytes as words, the last filled up with zeros.
pub(crate) fn to_words(bytes: &[u8]) -> Vec<u64> {
    let word = |chunk: &[u8]| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    };
    bytes.chunks(8).map(word).collect()
}

/// The value of the words of encoded bytes, in front of which is the version of the data.
pub(crate) fn from_words<T: DeserializeOwned>(version: u32, words: &[u64]) -> Result<T, CheckpointError> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let (found, rest) = postcard::take_from_bytes::<u32>(&bytes)?;
    if found != version {
        return Err(CheckpointError::Version { found, expected: version });
    }
    let (value, rest) = postcard::take_from_bytes(rest)?;
    match rest.len() < 8 && rest.iter().all(|byte| *byte == 0) {
        true => Ok(value),
        false => Err(postcard::Error::DeserializeBadEncoding.into()),
    }
}

/// Refuses what does not hold.
///
/// # Errors
/// [`CheckpointError::Value`].
pub fn expect(what: &'static str, holds: bool) -> Result<(), CheckpointError> {
    if holds { Ok(()) } else { Err(CheckpointError::Value { what }) }
}

/// Refuses counts beyond 2⁶⁰, which no run reaches and which could overflow.
///
/// # Errors
/// [`CheckpointError::Value`].
pub fn counts(counts: &[u64]) -> Result<(), CheckpointError> {
    expect("a count", counts.iter().all(|count| *count <= 1 << 60))
}

/// Refuses numbers that are not finite.
///
/// # Errors
/// [`CheckpointError::Value`].
pub fn finite<N: Borrow<f64>>(what: &'static str, numbers: impl IntoIterator<Item = N>) -> Result<(), CheckpointError> {
    expect(what, numbers.into_iter().all(|number| number.borrow().is_finite()))
}

/// Serde for a count that takes the same room whatever it is.
pub use postcard::fixint::le as fixed_room;

/// Serde for an optional value that takes the same room whether it is there or not.
pub mod equal_room {
    use super::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes whether there is a value, and it or a default.
    ///
    /// # Errors
    /// Errors of the serializer.
    pub fn serialize<T, S>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error>
    where
        T: Serialize + Default + Copy,
        S: Serializer,
    {
        (value.is_some(), value.unwrap_or_default()).serialize(serializer)
    }

    /// Reads it.
    ///
    /// # Errors
    /// Errors of the deserializer.
    pub fn deserialize<'de, T, D>(deserializer: D) -> Result<Option<T>, D::Error>
    where
        T: Deserialize<'de>,
        D: Deserializer<'de>,
    {
        let (is_there, value) = <(bool, T)>::deserialize(deserializer)?;
        Ok(is_there.then_some(value))
    }
}
