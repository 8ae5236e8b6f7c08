//! The head of a results file, as `src/head.rs` of `sealed` describes it, and seals that are made right again.

use keys::{Digest, Hash};
use serde_json::Value;
use std::ops::Range;

/// Bytes before the description.
const HEAD: usize = 72;

fn word(bytes: &[u8], at: usize) -> usize {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize
}

/// Bytes of the description.
pub fn description(bytes: &[u8]) -> Range<usize> {
    HEAD..HEAD.saturating_add(word(bytes, 32))
}

pub fn read(bytes: &[u8]) -> Value {
    serde_json::from_slice(&bytes[description(bytes)]).unwrap()
}

/// The metadata in a description.
pub fn metadata(description: &Value) -> Value {
    serde_json::from_str(description["texts"]["metadata"].as_str().unwrap()).unwrap()
}

/// Replaces the description, and makes the seal right again.
pub fn describe(bytes: &mut Vec<u8>, json: &str) {
    let end = bytes.windows(8).position(|window| window == b"\x89HDF\r\n\x1a\n").unwrap();
    if HEAD + json.len() <= end {
        bytes[HEAD..end].fill(0);
    }
    bytes.resize(bytes.len().max(HEAD + json.len()), 0);
    bytes[HEAD..HEAD + json.len()].copy_from_slice(json.as_bytes());
    bytes[32..40].copy_from_slice(&(json.len() as u64).to_le_bytes());
    let places = serde_json::from_str(json).map_or(Vec::new(), |description| places(&description, bytes.len()));
    seal(bytes, &places);
}

/// A dataset that a description claims: its bytes, and the digits of its hash.
#[derive(Debug, Clone)]
pub struct Place {
    pub bytes: Range<usize>,
    pub hash: Option<String>,
}

/// The datasets in their order in the file.
pub fn places(description: &Value, length: usize) -> Vec<Place> {
    let number = |value: &Value| value.as_u64().map_or(0, |number| number as usize);
    let datasets = description["datasets"].as_object().into_iter().flat_map(|datasets| datasets.values());
    let mut places: Vec<_> = datasets
        .map(|dataset| {
            let shape = dataset["shape"].as_array().cloned().unwrap_or_default();
            let each = if dataset["kind"] == "u32" || dataset["kind"] == "f32" { 4 } else { 8 };
            let size = shape.iter().map(number).fold(each, usize::saturating_mul);
            let start = number(&dataset["start"]);
            Place { bytes: start..start.saturating_add(size), hash: dataset["hash"].as_str().map(str::to_owned) }
        })
        .filter(|place| place.bytes.end <= length && !place.bytes.is_empty())
        .collect();
    places.sort_unstable_by_key(|place| place.bytes.start);
    places
}

/// Makes the length and all hashes right again.
pub fn seal(bytes: &mut [u8], places: &[Place]) {
    let length = bytes.len();
    bytes[24..32].copy_from_slice(&(length as u64).to_le_bytes());
    let described = description(bytes);
    let described = described.start..described.end.min(length);
    for Place { bytes: place, hash } in places {
        let Some(old) = hash.as_ref().filter(|hash| hash.len() == 64) else { continue };
        let right = Hash::of(&bytes[place.clone()]).to_string();
        let of_old = bytes[described.clone()].windows(64).position(|window| window == old.as_bytes());
        if let Some(at) = of_old.map(|at| described.start + at) {
            bytes[at..at + 64].copy_from_slice(right.as_bytes());
        }
    }
    let mut digest = Digest::new().numbers(&bytes[..40]).numbers(&bytes[described.clone()]);
    let mut start = described.end;
    for place in places.iter().map(|place| place.bytes.clone()).chain(std::iter::once(length..length)) {
        for block in bytes.get(start..place.start).unwrap_or_default().chunks(1 << 14) {
            digest = digest.numbers(block);
        }
        start = start.max(place.end);
    }
    bytes[40..72].copy_from_slice(digest.finish().as_bytes());
}
