//! The answers of commands on a few examples are those that are kept; `./dev golden` compares them on all.

use std::process::{Command, Stdio};

use crate::program::root;

#[test]
fn answers_are_those_that_are_kept() {
    let script = root().join("tests/golden/golden.py");
    let arguments = [env!("CARGO_BIN_EXE_flexframe"), "--quick", "--elsewhere"];
    let done = Command::new("python3").arg(script).args(arguments).stdin(Stdio::null()).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&[done.stdout, done.stderr].concat()));
}
