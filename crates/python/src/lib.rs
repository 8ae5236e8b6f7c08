//! The Python package flexframe: its compiled part, the module `flexframe._flexframe`.
//!
//! The package is in `python/flexframe`; the types of everything here are in `_flexframe.pyi` there. One file per idea:
//! `dict` makes the text of a scene from a dict;
//! `scene`, `body` and `simulation` are the classes of these names;
//! `load`, `motion` and `faults` let Python functions act on a body;
//! `cache` keeps what was computed, `html` writes for notebooks;
//! `columns`, `row` and `results` give rows under the names of the columns of a results file;
//! `arrays` has the only unsafe code: numpy arrays that look into a body without a copy;
//! `interrupt` lets Ctrl-C stop long work; `threads` lets it be done in a forked process; `errors` turns errors into exceptions with the same words.

#![deny(unsafe_code)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)]

use pyo3::prelude::*;

mod arrays;
mod body;
mod builder;
mod columns;
mod constants;
mod dict;
mod errors;
mod faults;
mod html;
mod interrupt;
mod load;
mod motion;
mod numbers;
mod results;
mod row;
mod run;
mod scene;
mod simulation;
mod state;
mod threads;

/// The compiled part of the package flexframe.
#[pymodule]
mod _flexframe {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::body::Body;
    #[pymodule_export]
    use super::load::{Force, ModalForce};
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::results::read_results;
    #[pymodule_export]
    use super::row::Row;
    #[pymodule_export]
    use super::run::{resume, run};
    #[pymodule_export]
    use super::scene::{Scene, unpickled};
    #[pymodule_export]
    use super::simulation::{Reached, Simulation};
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        flexframe::forked::loaded();
        Ok(())
    }
}
