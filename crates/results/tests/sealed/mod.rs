//! The head of a results file, as `src/seal.rs` describes it, and seals that are made right again.

use serde_json::Value;
use std::ops::Range;

/// Bytes before the description.
const HEAD: usize = 48;

fn word(bytes: &[u8], at: usize) -> usize {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize
}

/// Bytes of the description.
pub fn description(bytes: &[u8]) -> Range<usize> {
    HEAD..HEAD + word(bytes, 40)
}

pub fn read(bytes: &[u8]) -> Value {
    serde_json::from_slice(&bytes[description(bytes)]).unwrap()
}

/// Replaces the description, and makes the seal right again.
pub fn describe(bytes: &mut Vec<u8>, json: &str) {
    let end = bytes.windows(8).position(|window| window == b"\x89HDF\r\n\x1a\n").unwrap();
    if HEAD + json.len() <= end {
        bytes[HEAD..end].fill(0);
    }
    bytes.resize(bytes.len().max(HEAD + json.len()), 0);
    bytes[HEAD..HEAD + json.len()].copy_from_slice(json.as_bytes());
    bytes[40..48].copy_from_slice(&(json.len() as u64).to_le_bytes());
    let left_out = serde_json::from_str(json).map_or(Vec::new(), |description| left_out(&description, bytes.len()));
    seal(bytes, &left_out);
}

/// Bytes of the histories and checkpoints that a description claims, in their order in the file; none of a finished file.
pub fn left_out(description: &Value, length: usize) -> Vec<Range<usize>> {
    let number = |value: &Value| value.as_u64().map_or(0, |number| number as usize);
    let Some(words) = description["checkpoint_words"].as_u64() else { return Vec::new() };
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let body = &description["metadata"]["bodies"][0];
    let modes = list(&body["model"]["frequencies"]).len();
    let points = list(&body["point_names"]).len();
    // Time, then the body, and the energy of the system.
    let widths = [1, 4, 3, 3, 3, 3, modes, modes, 1, 1, 1, 1, 1, 3, 3, 3, 3];
    let widths = widths.into_iter().chain(std::iter::repeat_n(3 * points, 4)).chain([1]);
    let sizes = widths.map(|width| number(&description["rows"]).saturating_mul(8 * width));
    let sizes = sizes.chain([(words as usize).saturating_mul(16)]);
    let mut ranges: Vec<_> = (list(&description["starts"]).iter().map(number).zip(sizes))
        .map(|(start, size)| start..start.saturating_add(size))
        .filter(|range| range.end <= length && !range.is_empty())
        .collect();
    ranges.sort_unstable_by_key(|range| range.start);
    ranges
}

/// Makes length and check sum right again.
pub fn seal(bytes: &mut [u8], left_out: &[Range<usize>]) {
    let length = bytes.len();
    bytes[32..40].copy_from_slice(&(length as u64).to_le_bytes());
    let mut sum = crc32fast::Hasher::new();
    let mut start = 32;
    for range in left_out.iter().cloned().chain(std::iter::once(length..length)) {
        sum.update(bytes.get(start..range.start).unwrap_or_default());
        start = range.end;
    }
    bytes[24..32].copy_from_slice(&u64::from(sum.finalize()).to_le_bytes());
}
