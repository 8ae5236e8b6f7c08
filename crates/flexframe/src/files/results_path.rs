//! The name of the results file of a scene.

use std::path::{Path, PathBuf};

use scene::Scene;

/// The results file of a scene in a folder: `plate.h5` of `plate.toml`, and `pair.left.h5` of the body `left` in `pair.toml`.
pub fn results_path(scene: &Scene, folder: &Path) -> PathBuf {
    let mut name = scene.path.file_stem().unwrap_or("results".as_ref()).to_owned();
    if let Some(body) = &scene.name {
        name.push(".");
        name.push(body);
    }
    name.push(".h5");
    folder.join(name)
}
