//! Scenes whose mesh is of another format than MSH 4.1. (All formats: `mesh-import/tests/formats.rs`.)

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::program::command_in;

/// `flexframe modes` of a steel bar from this file, in a folder that has it.
fn modes(folder: &Path, body: &str, gmsh: &str, cache: &Path) -> Output {
    let scene = format!(
        "title = \"bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\n{body}\n\
         material = {{ young_modulus = 210e3, poisson_ratio = 0.3, density = 7.85e-9 }}\n[modes]\nflexible = 3\n\
         [time]\nend = 1.0\nstep = 0.1\n"
    );
    std::fs::write(folder.join("bar.toml"), scene).unwrap();
    command_in(folder, &["modes", "bar.toml", "--json"])
        .env("FLEXFRAME_PYTHON", "no python")
        .env("FLEXFRAME_GMSH", gmsh)
        .env("FLEXFRAME_CACHE", cache)
        .output()
        .unwrap()
}

/// Closed form: the first bending frequency by Euler and Bernoulli.
#[test]
fn geometry_and_first_order_meshes_give_modes_and_are_meshed_once() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("crates/model/tests/data/");
    std::fs::copy(data.join("bar.geo"), folder.path().join("bar.geo")).unwrap();
    let cache = tempfile::tempdir().unwrap();
    let found = |body: &str, gmsh: &str| -> Value {
        let output = modes(folder.path(), body, gmsh, cache.path());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let first = |report: &Value| report["body"]["natural_frequencies"][0].as_f64().unwrap();
    let geometry = found("mesh = \"bar.geo\"", "gmsh");
    // Euler and Bernoulli: 4.73² √(EI/(ρAL⁴))/2π; shear and rotatory inertia take a per cent.
    let beam =
        4.73004_f64.powi(2) * (210e3 / 7.85e-9_f64 * 100.0 / 12.0).sqrt() / 200.0_f64.powi(2) / std::f64::consts::TAU;
    assert!((first(&geometry) / beam - 1.0).abs() < 0.02, "{} {beam}", first(&geometry));
    // Read from the cache: gmsh is not asked again, and all is the same to the last bit.
    let again = found("mesh = \"bar.geo\"", "no gmsh");
    assert_eq!(geometry["body"]["natural_frequencies"], again["body"]["natural_frequencies"]);

    let gmsh = Command::new("gmsh")
        .args(["-3", "-format", "msh41", "-v", "0", "bar.geo", "-o", "linear.msh"])
        .current_dir(folder.path())
        .status();
    assert!(gmsh.unwrap().success());
    let raised = found("mesh = \"linear.msh\"\nraise_order = true", "gmsh");
    assert!((first(&raised) / first(&geometry) - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_missing_and_what_does_not_fit_is_said() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bar.vtu"), "<a>\n").unwrap();
    std::fs::write(folder.path().join("bar.msh"), "").unwrap();
    for (body, code, words) in [
        ("mesh = \"bar.vtu\"", 6, &["bar.vtu", "meshio", "`no python` cannot be started", "pip install meshio"][..]),
        ("mesh = \"bar.msh\"\nmesh_size = 2.0", 3, &["`body.mesh_size`", "a size for a mesh that is there"]),
        ("mesh = \"bar.geo\"\nmesh_size = -2.0", 3, &["`body.mesh_size`", "greater than 0"]),
        ("file = \"bar.h5\"\nraise_order = true", 3, &["`body."]),
        ("mesh = \"bar.geo\"", 3, &["bar.geo", "No such file"]),
    ] {
        let output = modes(folder.path(), body, "gmsh", Path::new(""));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{body}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{body}: {said}");
    }
}
