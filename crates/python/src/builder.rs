//! The builder of bodies, with the cache of the user, as in the program.

use std::path::PathBuf;

use flexframe::model::{Builder, Cache};
use pyo3::prelude::*;

/// The module that is this library.
pub(crate) const MODULE: &str = "flexframe._flexframe";

/// A builder with the cache of the user, if there is one. Answers that another file than that of this library has computed are
/// not taken.
pub(crate) fn builder(py: Python<'_>, trust_geometry: bool) -> PyResult<Builder> {
    let library: PathBuf = py.import(MODULE)?.getattr("__file__")?.extract()?;
    Ok(Builder { trust_geometry, ..Builder::with_cache(Cache::of_user().of_program(library)) })
}
