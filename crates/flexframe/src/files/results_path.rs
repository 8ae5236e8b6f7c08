//! The names of the files of a scene.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use scene::Scene;

/// The results file of the bodies of a scene in a folder: `pair.h5` of `pair.toml`, and `pair.left.h5` of its body `left` alone.
/// `None` without a body.
pub fn results_path<'s>(scenes: impl IntoIterator<Item = &'s Scene>, folder: &Path) -> Option<PathBuf> {
    let mut scenes = scenes.into_iter();
    let first = scenes.next()?;
    let body = first.name.as_deref().filter(|_| scenes.next().is_none());
    Some(folder.join(name_of(first, body, ".h5")))
}

/// The name of the body file of a body beside its results file: `plate.body.h5`, and `pair.left.body.h5` of one of several.
pub(crate) fn body_file_name(scene: &Scene) -> OsString {
    name_of(scene, scene.name.as_deref(), ".body.h5")
}

fn name_of(scene: &Scene, body: Option<&str>, ending: &str) -> OsString {
    let mut name = scene.path.file_stem().unwrap_or("results".as_ref()).to_owned();
    if let Some(body) = body {
        name.push(".");
        name.push(body);
    }
    name.push(ending);
    name
}
