//! The names of the files of a scene.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use scene::{Body, Scene, Shared};

/// The results file of the bodies of a scene in a folder: `pair.h5` of `pair.toml`, and `pair.left.h5` of one of its bodies, `left`,
/// without the others.
pub fn results_path(scene: &Scene, folder: &Path) -> PathBuf {
    folder.join(match &scene.bodies[..] {
        [body] => name_of_body(body, ".h5"),
        _ => name_of(scene, None, ".h5"),
    })
}

/// The name of the body file of a body beside its results file: `plate.body.h5`, and `pair.left.body.h5` of one of several.
pub(crate) fn body_file_name(body: &Body) -> OsString {
    name_of_body(body, ".body.h5")
}

/// The name of a file of one body; with its name where its scene has others.
fn name_of_body(body: &Body, ending: &str) -> OsString {
    name_of(body, body.name.as_ref().filter(|_| body.bodies_of_file > 1), ending)
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
