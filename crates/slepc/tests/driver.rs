//! The driver alone, on matrices that tempt it to miss eigenvalues. Needs SLEPc (`./dev test` sees to it).

use std::fs;
use std::process::{Command, Output};

use serde_json::{Value, json};

/// Rows of the matrices.
const SIZE: usize = 60;
/// Rigid motions: eigenvalues 0.
const RIGID: usize = 2;

/// A diagonal matrix in PETSc's binary form.
fn diagonal(values: &[f64]) -> Vec<u8> {
    let size = values.len() as i32;
    let heads = [1_211_216, size, size, size].into_iter();
    let words = heads.chain(values.iter().map(|_| 1)).chain(0..size);
    words.flat_map(i32::to_be_bytes).chain(values.iter().flat_map(|value| value.to_be_bytes())).collect()
}

/// A unit vector.
fn unit(row: usize) -> impl Iterator<Item = u8> {
    let values = (0..SIZE).flat_map(move |i| f64::from(u8::from(i == row)).to_be_bytes());
    [1_211_214, SIZE as i32].into_iter().flat_map(i32::to_be_bytes).chain(values)
}

/// A driver whose searches find of repeated eigenvalues one copy, as they would without rounding.
const ONE_COPY: &str = r#"
def one_copy(driver, eps, count, found, search=Driver.search):
    pairs = search(driver, eps, count, found)
    return [pair for k, pair in enumerate(pairs) if all(abs(pair[0] - other[0]) > 1e-6 for other in pairs[:k])]


Driver.search = one_copy
"#;
/// A driver whose searches never find the smallest eigenvalues.
const BLIND: &str = r#"
def blind(driver, eps, count, found, search=Driver.search):
    return [pair for pair in search(driver, eps, count, found) if pair[0] > 1.5]


Driver.search = blind
"#;

/// The eigenvalues that the driver finds beside the rigid motions, and its answer.
fn solve(eigenvalues: &[f64], modes: usize, search: &str) -> (Vec<f64>, Value) {
    // Ranks that wait for one another take the processor: two for SLEPc's own search, one where there are many searches.
    let ranks = if search.is_empty() { "2" } else { "1" };
    let (output, answer) = run(eigenvalues, modes, search, ranks);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&answer.unwrap()).unwrap();
    let found = answer["eigenvalues"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    (found, answer)
}

/// Runs the driver with another search, and reads its answer if there is one.
fn run(eigenvalues: &[f64], modes: usize, search: &str, ranks: &str) -> (Output, Option<Vec<u8>>) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.path().join(name), bytes).unwrap();
    let stiffness: Vec<f64> = [0.0; RIGID].iter().chain(eigenvalues).copied().collect();
    write("K.petsc", diagonal(&stiffness));
    write("M.petsc", diagonal(&vec![1.0; SIZE]));
    write("rigid.petsc", (0..RIGID).flat_map(unit).collect());
    let problem = json!({
        "digest": "", "unknowns": SIZE, "modes": modes, "available": SIZE - RIGID, "rigid": RIGID, "shift": 1.0,
        "tolerance": 1e-10,
    });
    write("problem.json", problem.to_string().into_bytes());
    let driver = include_str!("../src/driver.py").strip_suffix("main()\n").unwrap();
    write("driver.py", format!("{driver}{search}\nmain()\n").into_bytes());
    let python = std::env::var("FLEXFRAME_MPI_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut command = Command::new("mpirun");
    // As the library starts it: one thread a rank, since threads of BLAS that wait take the processor from the ranks, and a folder
    // of its own for the files of Open MPI, for the tests run at the same time.
    command.args(["-n", ranks, &python]).arg(folder.path().join("driver.py"));
    command.env("OMP_NUM_THREADS", "1").env("TMPDIR", folder.path());
    (command.output().unwrap(), fs::read(folder.path().join("modes.json")).ok())
}

/// Closed form: the entries of a diagonal matrix.
#[test]
fn eigenvalues_that_a_search_misses_are_seen_by_the_count_and_found_by_the_next() {
    let eigenvalues: Vec<f64> = (0..SIZE - RIGID).map(|i| i.saturating_sub(4).max(1) as f64).collect();
    assert_eq!(eigenvalues[..8], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0]);
    for search in ["", ONE_COPY] {
        let (found, answer) = solve(&eigenvalues, 4, search);
        assert!(search.is_empty() || answer["searches"] == json!(6), "a copy each: {answer}");
        assert!(found.len() > 6 && answer["counted"] == json!(found.len() + RIGID), "{answer}");
        for (found, expected) in found.iter().zip(&eigenvalues) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
}

/// Closed form: the entries of a diagonal matrix.
#[test]
fn the_count_is_taken_beside_a_cluster_and_not_in_it() {
    // Twelve together where eight are searched at first: there is no gap among them.
    let eigenvalues: Vec<f64> = (0..SIZE - RIGID).map(|i| 1.0 + (i / 12) as f64).collect();
    for search in ["", ONE_COPY] {
        let (found, answer) = solve(&eigenvalues, 4, search);
        assert!(search.is_empty() || answer["searches"] == json!(12), "a copy each: {answer}");
        assert_eq!((found.len() % 12, answer["counted"].as_u64()), (0, Some((found.len() + RIGID) as u64)), "{answer}");
        assert!(found[..12].iter().all(|value| (value - 1.0).abs() < 1e-12), "{found:?}");
    }
}

/// A search that finds none of the missing eigenvalues is the last, and the error says how many are missing.
#[test]
fn a_search_that_brings_nothing_ends_the_driver() {
    let eigenvalues: Vec<f64> = (0..SIZE - RIGID).map(|i| 1.0 + i.saturating_sub(2) as f64).collect();
    assert_eq!(eigenvalues[..4], [1.0, 1.0, 1.0, 2.0]);
    let (output, answer) = run(&eigenvalues, 4, BLIND, "1");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(!output.status.success() && answer.is_none(), "{said}");
    assert!(said.contains("in 2 searches, none by the last, and 3 more by a count"), "{said}");
}
