//! JSON files.

use std::fs;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::SlepcError;

/// What a file has.
pub(crate) fn json<T: DeserializeOwned>(path: &Path) -> Result<T, SlepcError> {
    let text = fs::read_to_string(path).map_err(SlepcError::io(path, "read it"))?;
    serde_json::from_str(&text).map_err(|error| SlepcError::Damaged { path: path.to_owned(), what: error.to_string() })
}
