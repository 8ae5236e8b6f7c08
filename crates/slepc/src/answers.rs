//! What a driver leaves.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use modal::{Eigenpairs, EngineStats, StaticAnswers};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::binary::read_vectors;
use crate::error::SlepcError;
use crate::folder::LOG;

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

/// `statics.json`.
#[derive(Deserialize)]
struct Statics {
    unknowns: usize,
    iterations: Vec<usize>,
    residuals: Vec<f64>,
}

/// The eigenpairs in a folder, of the matrices with this digest and so many rows, and as many as are asked for.
pub(crate) fn eigenpairs(
    folder: &Path,
    digest: &str,
    unknowns: usize,
    requested: usize,
) -> Result<Eigenpairs, SlepcError> {
    let path = folder.join("modes.json");
    let found: Modes = match json(&path) {
        Err(SlepcError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound && folder.is_dir() => {
            return Err(SlepcError::NotFinished { folder: folder.to_owned(), said: last_line(&folder.join(LOG)) });
        }
        found => found?,
    };
    if found.digest != digest || found.unknowns != unknowns {
        return Err(SlepcError::OtherMatrices { folder: folder.to_owned() });
    }
    let count = found.eigenvalues.len();
    if count < requested {
        return Err(SlepcError::FewModes { folder: folder.to_owned(), found: count, requested });
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

/// The static answers in a folder.
pub(crate) fn static_answers(folder: &Path) -> Result<StaticAnswers, SlepcError> {
    let Statics { unknowns, iterations, residuals } = json(&folder.join("statics.json"))?;
    let displacements = read_vectors(&folder.join("statics.petsc"), unknowns, residuals.len())?;
    Ok(StaticAnswers { displacements, iterations, residuals })
}

fn json<T: DeserializeOwned>(path: &Path) -> Result<T, SlepcError> {
    let text = fs::read_to_string(path).map_err(SlepcError::io(path, "read it"))?;
    serde_json::from_str(&text).map_err(|error| SlepcError::Damaged { path: path.to_owned(), what: error.to_string() })
}

fn last_line(path: &Path) -> Option<String> {
    let text = fs::read(path).ok()?;
    let text = String::from_utf8_lossy(&text);
    text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
}
