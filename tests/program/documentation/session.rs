//! A shell in an empty folder with the examples, the meshes and the decks, as a reader has one.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use flexframe::fmu::marker;
use tempfile::TempDir;

use super::pages::{Block, Page};
use crate::program::root;

pub struct Session {
    folder: TempDir,
}

impl Session {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["examples", "meshes", "tests"] {
            std::os::unix::fs::symlink(fs::canonicalize(root().join(name)).unwrap(), folder.path().join(name)).unwrap();
        }
        // Bytes that pass for the library of FMUs, which is not built for these tests: ./dev fmu-test runs real ones.
        fs::write(folder.path().join(".library"), format!("{} fmi2DoStep", marker())).unwrap();
        Self { folder }
    }

    /// Runs the commands of a block; the first one that fails ends it. Gives all that they print.
    pub fn run(&mut self, page: &Page, block: &Block) -> String {
        let program = Path::new(env!("CARGO_BIN_EXE_flexframe")).parent().unwrap();
        let mut path = program.as_os_str().to_owned();
        path.push(":");
        path.push(env::var_os("PATH").unwrap());
        let output = Command::new("bash")
            .args(["-euo", "pipefail", "-c", &format!("exec 2>&1\n{}", block.text)])
            .current_dir(self.folder.path())
            .env("PATH", path)
            .env("FLEXFRAME_CACHE", self.folder.path().join(".cache"))
            .env("FLEXFRAME_FMU_LIBRARY", self.folder.path().join(".library"))
            .output()
            .unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{}:{}: {}{printed}", page.name, block.line, block.text);
        printed
    }

    /// The file of a name that the commands have made.
    pub fn file_named(&self, name: &str) -> Option<PathBuf> {
        find(self.folder.path(), name)
    }
}

fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    fs::read_dir(folder).unwrap().find_map(|entry| {
        let path = entry.unwrap().path();
        if path.is_symlink() {
            None
        } else if path.is_dir() {
            find(&path, name)
        } else {
            (path.file_name()? == name).then_some(path)
        }
    })
}
