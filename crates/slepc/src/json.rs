//! JSON files.

use std::path::Path;

use diagnostic::Failure;
use foreign_program::read_at_most;
use serde::de::DeserializeOwned;

use crate::error::{damaged, failed};

/// Bytes that a file of the driver may have: some numbers for each mode.
const MOST: u64 = 64 << 20;

/// Content of a file.
pub(crate) fn json<T: DeserializeOwned>(path: &Path) -> Result<T, Failure> {
    let text = read_at_most(path, MOST).map_err(failed(path, "read it"))?;
    serde_json::from_slice(&text).map_err(|error| damaged(path, error.to_string()))
}
