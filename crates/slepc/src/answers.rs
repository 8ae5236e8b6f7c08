//! Answers that a driver leaves.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::time::Duration;

use diagnostic::{Failure, Kind};
use foreign_program::open_ordinary;
use modal::{Eigenpairs, EngineStats, StaticAnswers};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::binary::read_vectors;
use crate::error::other_matrices;
use crate::folder::LOG;
use crate::json::json;

/// Bytes at the end of the log in which its last line is looked for.
const TAIL: u64 = 8192;

/// `modes.json`.
#[derive(Deserialize)]
struct Modes {
    digest: String,
    unknowns: usize,
    eigenvalues: Vec<f64>,
    residuals: Vec<f64>,
    below: f64,
    counted: usize,
    ranks: usize,
    petsc: [u32; 3],
    slepc: [u32; 3],
    factor_entries: usize,
    megabytes: usize,
    times: BTreeMap<String, f64>,
}

/// `statics-NAME.json`.
#[derive(Deserialize)]
struct Statics {
    digest: String,
    unknowns: usize,
    iterations: Vec<usize>,
    residuals: Vec<f64>,
}

/// The eigenpairs in a folder, of the matrices with this digest and number of rows, as many as are asked for.
pub(crate) fn eigenpairs(
    folder: &Path,
    digest: &str,
    unknowns: usize,
    requested: usize,
) -> Result<Eigenpairs, Failure> {
    let found: Modes = finished(folder, "modes.json", "")?;
    if found.digest != digest || found.unknowns != unknowns {
        return Err(other_matrices(folder));
    }
    let count = found.eigenvalues.len();
    if count < requested {
        let wrong = Kind::Input.of(folder).help("ask for fewer, or write the folder again: --write-only");
        return Err(wrong.says(format!("{count} modes, where {requested} are asked for")));
    }
    let time = |phase: &str| {
        let seconds = found.times.get(phase).copied().unwrap_or_default();
        Duration::try_from_secs_f64(seconds).unwrap_or_default()
    };
    let stats = EngineStats {
        below: found.below,
        counted: found.counted,
        ranks: found.ranks,
        petsc: found.petsc,
        slepc: found.slepc,
        factor_entries: found.factor_entries,
        megabytes: found.megabytes,
        factor_time: time("factor"),
        search_time: time("search"),
        count_time: time("count"),
    };
    let vectors = read_vectors(&folder.join("modes.petsc"), unknowns, count)?;
    Ok(Eigenpairs { eigenvalues: found.eigenvalues, vectors, residuals: found.residuals, stats })
}

/// The static responses to the forces with this name in a folder, of the matrices with this digest and number of rows.
pub(crate) fn static_answers(
    folder: &Path,
    name: &str,
    digest: &str,
    unknowns: usize,
) -> Result<StaticAnswers, Failure> {
    let asked = " (static responses: the scene asks for these, too, and their forces are written there now)";
    let found: Statics = finished(folder, &format!("statics-{name}.json"), asked)?;
    if found.digest != digest || found.unknowns != unknowns {
        return Err(other_matrices(folder));
    }
    let path = folder.join(format!("statics-{name}.petsc"));
    let displacements = read_vectors(&path, unknowns, found.residuals.len())?;
    Ok(StaticAnswers { displacements, iterations: found.iterations, residuals: found.residuals })
}

/// The file that the driver leaves last; `what` says what it is.
fn finished<T: DeserializeOwned>(folder: &Path, name: &str, what: &str) -> Result<T, Failure> {
    let path = folder.join(name);
    if folder.is_dir() && !path.exists() {
        let said = last_line(&folder.join(LOG)).map(|said| format!("; driver.log ends with: {said}"));
        let words =
            format!("{name} is not there{what}: the driver has not come to its end{}", said.unwrap_or_default());
        let help = "`sbatch job.sh` in that folder, or `bash job.sh`, and then this command again; what the driver says is in driver.log";
        return Err(Kind::Io.of(folder).help(help).says(words));
    }
    json(&path)
}

/// The last line of a file, which may be long.
fn last_line(path: &Path) -> Option<String> {
    let mut file = open_ordinary(path).ok()?;
    let size = file.metadata().ok()?.len();
    file.seek(SeekFrom::Start(size.saturating_sub(TAIL))).ok()?;
    let mut text = Vec::new();
    file.take(TAIL).read_to_end(&mut text).ok()?;
    let text = String::from_utf8_lossy(&text);
    text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
}
