//! The names of the files of a scene.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use scene::Scene;

/// The results file of the bodies of a scene in a folder: `pair.h5` of `pair.toml`, and `pair.left.h5` of one of its bodies, `left`,
/// without the others. `None` without a body.
pub fn results_path<'s>(scenes: impl IntoIterator<Item = &'s Scene>, folder: &Path) -> Option<PathBuf> {
    let mut scenes = scenes.into_iter();
    let first = scenes.next()?;
    let is_alone = scenes.next().is_none();
    Some(folder.join(name_of(first, is_alone, ".h5")))
}

/// The name of the body file of a body beside its results file: `plate.body.h5`, and `pair.left.body.h5` of one of several.
pub(crate) fn body_file_name(scene: &Scene) -> OsString {
    name_of(scene, true, ".body.h5")
}

/// The name of a file of a scene; with the name of its body where the file is of this body alone and there are others.
fn name_of(scene: &Scene, is_alone: bool, ending: &str) -> OsString {
    let mut name = scene.path.file_stem().unwrap_or("results".as_ref()).to_owned();
    if let Some(body) = scene.name.as_ref().filter(|_| is_alone && scene.has_others) {
        name.push(".");
        name.push(body);
    }
    name.push(ending);
    name
}
