//! The names of the files of a scene.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use scene::{Scene, Shared, System};

/// The results file of the bodies of a scene in a folder: `pair.h5` of `pair.toml`, and `pair.left.h5` of one of its bodies, `left`,
/// without the others.
pub fn results_path(system: &System, folder: &Path) -> PathBuf {
    folder.join(match &system.bodies[..] {
        [body] => name_of_body(body, ".h5"),
        _ => name_of(system, None, ".h5"),
    })
}

/// The name of the body file of a body beside its results file: `plate.body.h5`, and `pair.left.body.h5` of one of several.
pub(crate) fn body_file_name(scene: &Scene) -> OsString {
    name_of_body(scene, ".body.h5")
}

/// The name of a file of one body; with its name where its scene has others.
fn name_of_body(scene: &Scene, ending: &str) -> OsString {
    name_of(scene, scene.name.as_ref().filter(|_| scene.bodies_of_file > 1), ending)
}

fn name_of(scene: &Shared, body: Option<&String>, ending: &str) -> OsString {
    let mut name = scene.path.file_stem().unwrap_or("results".as_ref()).to_owned();
    if let Some(body) = body {
        name.push(".");
        name.push(body);
    }
    name.push(ending);
    name
}
