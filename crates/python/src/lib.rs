//! The Python package flexframe: its compiled part, the module `flexframe._flexframe`.
//!
//! The package is in `python/flexframe`; the types of everything here are in `_flexframe.pyi` there.
//! `scene`, `body`, `system` and `motion::simulation` are the classes of these names; `builder` has the cache of the user;
//! `motion` lets Python functions act on a body; `rows` gives rows under the names of the columns of a results file;
//! `linear` gives the matrices of linear models to `linear.py`, `parameters` the reports on rates and fits to `parameters.py`;
//! `values` takes numbers and dicts and gives arrays and tables: the only unsafe code is in `arrays`, which look into a body without a
//! copy; `interrupt` lets Ctrl-C stop long work; `threads` lets it be done in a forked process; `errors` turns errors into exceptions
//! with the same words.

#![deny(unsafe_code)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)]

use pyo3::prelude::*;

mod body;
mod builder;
mod errors;
mod interrupt;
mod linear;
mod motion;
mod parameters;
mod reports;
mod rows;
mod scene;
mod system;
mod threads;
mod values;

/// The compiled part of the package flexframe.
#[pymodule]
mod _flexframe {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::body::Body;
    #[pymodule_export]
    use super::linear::linearized;
    #[pymodule_export]
    use super::motion::joint_equation::JointEquation;
    #[pymodule_export]
    use super::motion::joint_force::JointForce;
    #[pymodule_export]
    use super::motion::load::{Force, ModalForce};
    #[pymodule_export]
    use super::motion::marker_force::{MarkerForce, RelativeMotion};
    #[pymodule_export]
    use super::motion::seen::Motion;
    #[pymodule_export]
    use super::motion::simulation::{Reached, Simulation};
    #[pymodule_export]
    use super::parameters::{fitted, gradients};
    #[pymodule_export]
    use super::reports::{CommandReport, campbell_report, frf_report, psd_report, shock_report, srs_report};
    #[pymodule_export]
    use super::rows::results::read_results;
    #[pymodule_export]
    use super::rows::row::Row;
    #[pymodule_export]
    use super::rows::run::{resume, run};
    #[pymodule_export]
    use super::scene::{Scene, unpickled};
    #[pymodule_export]
    use super::system::System;
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        flexframe::forked::loaded();
        Ok(())
    }
}
