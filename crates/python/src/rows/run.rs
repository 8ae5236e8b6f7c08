//! Runs that write a results file, as the program does.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use flexframe::model::Builder;
use flexframe::run::{RunError, RunProgress, RunReport, RunSettings};
use pyo3::prelude::*;

use crate::builder::builder;
use crate::errors::{add_note, exception, warn};
use crate::interrupt::{Stop, interruptible};
use crate::rows::check::checked;
use crate::rows::results::read_results;
use crate::scene::Scene;

/// Runs the bodies of a scene as the program does, and writes their results to `<folder>/<name of the scene>.h5`.
/// Until the end they are in `<name>.part.h5` beside it, from which `resume` goes on after Ctrl-C or a crash. What is
/// there is replaced only with `overwrite`, and what the scene reads never; results of more than 1 GB are written only
/// with `large`. At its end rows are checked by the full nonlinear body, as many as cost no more than the body did: `check` of
/// the results, or with `check=False` none.
#[pyfunction]
#[pyo3(signature = (scene, folder, *, overwrite=false, large=false, check=true))]
pub(crate) fn run(
    py: Python<'_>,
    scene: Py<Scene>,
    folder: PathBuf,
    overwrite: bool,
    large: bool,
    check: bool,
) -> PyResult<Bound<'_, PyAny>> {
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    followed(py, [overwrite, large, check], builder, move |settings, progress| {
        flexframe::accuracy::run(&whole, &folder, settings, progress).map(|(_, report)| report)
    })
}

/// Goes on with a run that was cut off: the file is then the same as if it had not been, bit for bit. Another
/// results file in its place is replaced only with `overwrite`. `check` is that of `run`, and `trust_geometry` that of Scene.
#[pyfunction]
#[pyo3(signature = (file, *, overwrite=false, check=true, trust_geometry=false))]
pub(crate) fn resume(
    py: Python<'_>,
    file: PathBuf,
    overwrite: bool,
    check: bool,
    trust_geometry: bool,
) -> PyResult<Bound<'_, PyAny>> {
    followed(py, [overwrite, false, check], builder(py, trust_geometry)?, move |settings, progress| {
        flexframe::run::resume(&file, settings, progress)
    })
}

fn followed<'py>(
    py: Python<'py>,
    [overwrite, large, check]: [bool; 3],
    builder: Builder,
    work: impl FnOnce(&RunSettings, &mut dyn FnMut(RunProgress)) -> Result<RunReport, RunError> + Send + 'static,
) -> PyResult<Bound<'py, PyAny>> {
    let stop = Stop::default();
    let in_motion = Arc::new(AtomicBool::new(false));
    let settings = RunSettings { overwrite, large, check, stop: stop.flag(), builder, ..RunSettings::default() };
    let cache = settings.builder.cache.clone();
    let (told, moves) = (stop.clone(), in_motion.clone());
    let run = move || {
        work(&settings, &mut |progress| match progress {
            // Nothing is written yet.
            RunProgress::Build(_) => told.check(),
            RunProgress::Built => {
                // First said, then looked: who asks it to stop from here on waits for the file.
                moves.store(true, Ordering::Relaxed);
                told.check();
            }
            RunProgress::Estimate(_) | RunProgress::Motion(_) | RunProgress::Check(_) => {}
        })
    };
    // The motion stops by itself at its next row, and its rows are kept.
    let (report, raised) = interruptible(py, &stop, || in_motion.load(Ordering::Relaxed), run)?;
    warn(py, cache.notes().warnings)?;
    match (raised, report) {
        (Some(error), Err(stopped)) => {
            add_note(py, &error, &stopped.to_string());
            Err(error)
        }
        (Some(error), Ok(_)) => Err(error),
        (None, Ok(report)) => {
            let results = read_results(py, report.results)?;
            if let Some(check) = &report.check {
                results.setattr("check", checked(py, check)?)?;
            }
            Ok(results)
        }
        (None, Err(error)) => Err(exception(py, &error)),
    }
}
