//! Bodies of mass and stiffness matrices from files.

mod beam;
mod calculix;
mod files;
mod refusals;
mod same_as_mesh;

use std::path::{Path, PathBuf};

use scene::Body;
use tempfile::TempDir;

/// A folder with the files of a body.
pub struct Files {
    folder: TempDir,
}

impl Files {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.file(name), text).unwrap();
    }

    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.file(name)).unwrap()
    }

    /// The text of a scene in the folder.
    pub fn text_of_scene(&self, body: &str, modes: &str, rest: &str, time: &str) -> String {
        format!(
            "title = \"Matrices\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\n{body}\n[modes]\n{modes}\n{rest}\n\
             [time]\n{time}\n"
        )
    }

    /// A scene in the folder.
    pub fn scene(&self, body: &str, modes: &str, rest: &str, time: &str) -> Body {
        let text = self.text_of_scene(body, modes, rest, time);
        Body::parse(&text, self.file("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// `[body]` of Matrix Market files.
pub const MARKET: &str = "matrices = { mass = \"M.mtx\", stiffness = \"K.mtx\", nodes = \"nodes.csv\" }";
