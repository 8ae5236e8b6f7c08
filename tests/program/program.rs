//! The program and what it says, as tests call it from the root of the repository.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).canonicalize().unwrap()
}

/// The program with these arguments.
pub(crate) fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flexframe"));
    command.args(arguments).current_dir(root());
    command
}

/// The program in a folder, where nothing was computed before.
pub(crate) fn command_in(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = command(arguments);
    command.env("FLEXFRAME_CACHE", "").current_dir(folder);
    command
}

/// Its streams and its exit code.
pub(crate) fn flexframe(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

/// Standard output of a command that succeeds.
#[track_caller]
pub(crate) fn done(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = flexframe(arguments);
    assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The report of a command that succeeds, by `--json`.
#[track_caller]
pub(crate) fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&done(&[arguments, &["--json"]].concat())).unwrap()
}

/// A list of numbers in a report.
#[track_caller]
pub(crate) fn numbers(list: &Value) -> Vec<f64> {
    let numbers = list.as_array().unwrap_or_else(|| panic!("no list: {list}")).iter();
    numbers.map(|x| x.as_f64().unwrap_or_else(|| panic!("no number: {x}"))).collect()
}
