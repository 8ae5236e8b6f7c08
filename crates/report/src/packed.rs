//! Bytes packed by gzip.

use std::io::Read;

use flate2::Compression;
use flate2::read::GzEncoder;

/// The bytes, packed by gzip.
pub(crate) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    // Reading from a list of bytes does not fail.
    let _ = GzEncoder::new(bytes, Compression::best()).read_to_end(&mut packed);
    packed
}
