//! State spaces as files.

use std::path::Path;

use diagnostic::{Failure, Kind};
use faer::Mat;
use linear::{Channel, MatArray, StateSpace, mat_file};
use serde_json::{Value, json};
use whole_file::write_whole;

use crate::files::write_error::WriteError;

/// Refuses an ending that no writer has.
pub(super) fn check_ending(path: &Path) -> Result<(), Failure> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("mat" | "json") => Ok(()),
        _ => Err(Kind::Usage.of(path).help("end its name so").says("expected a file that ends in .mat or .json")),
    }
}

/// Writes a state space: matrices A, B, C, D, and names and units of states, inputs and outputs.
pub(super) fn write(space: &StateSpace, path: &Path) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    }
    let bytes = match path.extension().and_then(|ending| ending.to_str()) {
        Some("mat") => matlab(space),
        _ => format!("{:#}\n", as_json(space)).into_bytes(),
    };
    Ok(write_whole(path, bytes).map_err(WriteError::of(path))?)
}

fn matlab(space: &StateSpace) -> Vec<u8> {
    let names = |list: &[Channel]| list.iter().map(|channel| channel.name.clone()).collect::<Vec<_>>();
    let units = |list: &[Channel]| list.iter().map(|channel| channel.unit.clone()).collect::<Vec<_>>();
    let lists = [
        ("states", names(&space.states)),
        ("inputs", names(&space.inputs)),
        ("outputs", names(&space.outputs)),
        ("state_units", units(&space.states)),
        ("input_units", units(&space.inputs)),
        ("output_units", units(&space.outputs)),
    ];
    let matrices = [("A", &space.a), ("B", &space.b), ("C", &space.c), ("D", &space.d)];
    let numbers = matrices.into_iter().map(|(name, matrix)| MatArray::Numbers(name, matrix));
    let words = lists.iter().map(|(name, list)| MatArray::Words(name, list.iter().map(String::as_str).collect()));
    mat_file(&numbers.chain(words).collect::<Vec<_>>())
}

fn as_json(space: &StateSpace) -> Value {
    let rows = |matrix: &Mat<f64>| -> Vec<Vec<f64>> {
        (0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect()).collect()
    };
    let channels = |list: &[Channel]| -> Vec<Value> {
        list.iter().map(|channel| json!({ "name": channel.name, "unit": channel.unit })).collect()
    };
    json!({
        "A": rows(&space.a),
        "B": rows(&space.b),
        "C": rows(&space.c),
        "D": rows(&space.d),
        "states": channels(&space.states),
        "inputs": channels(&space.inputs),
        "outputs": channels(&space.outputs),
    })
}
