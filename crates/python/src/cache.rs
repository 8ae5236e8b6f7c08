//! The user's cache, in which what was computed of a mesh is kept, as by the program.

use std::path::PathBuf;

use flexframe::scene::Cache;
use pyo3::prelude::*;

/// The module that is this library.
pub(crate) const MODULE: &str = "flexframe._flexframe";

/// The cache of the user, or none where there is none. Answers that another file than that of this library has computed are
/// not taken.
pub(crate) fn cache(py: Python<'_>, trust_geometry: bool) -> PyResult<Cache> {
    let library: PathBuf = py.import(MODULE)?.getattr("__file__")?.extract()?;
    let cache = Cache::of_user().of_program(library);
    if trust_geometry {
        cache.trust_geometry();
    }
    Ok(cache)
}
