//! A first scene of a mesh runs as it is.

use std::path::Path;

use flexframe::new_scene::{NewSceneError, new_scene};
use flexframe::run::{self, RunSettings};
use flexframe::scene::{Body, ImportSettings, Scene};

const AS_IT_IS: ImportSettings = ImportSettings { mesh_size: None, raise_order: false, trust_geometry: false };

#[test]
fn it_names_groups_and_mass_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("bar \"1\".msh");
    std::fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/scene/tests/data/bar.msh"), &mesh).unwrap();

    let (path, notes) = new_scene(&mesh, &AS_IT_IS, None, false).unwrap();
    assert!(notes.is_empty());
    assert_eq!(path, folder.path().join("bar \"1\".toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    // 200 x 10 x 10 mm of steel.
    for words in ["millimetres", "200.0 x 10.0 x 10.0 mm", "is 0.000157 Mg"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let scene = Scene::read(&path).unwrap();
    let Body::Meshed(body) = &scene.body else { panic!("it has a mesh") };
    assert_eq!(body.mesh, mesh);
    let (model, report) = run::run(&scene, folder.path(), &RunSettings::default(), |_| ()).unwrap();
    assert!((model.body.mass / 1.57e-4 - 1.0).abs() < 1e-9, "{}", model.body.mass);
    assert!(report.balances.energy < 1e-3, "{:?}", report.balances.energy);

    // The clamp in the comments is one, too, once [initial] is removed as they say.
    assert!(text.contains("remove [initial]"));
    let held: String = text
        .lines()
        .map(|line| match line.strip_prefix("# ") {
            Some(key) if key.starts_with("[[") || key.starts_with("kind") || key.starts_with("group") => key,
            Some(key) if key.starts_with("at =") || key.starts_with("radius") => key,
            _ => line,
        })
        .filter(|line| !line.starts_with("[initial]") && !line.starts_with("angular_velocity"))
        .collect::<Vec<_>>()
        .join("\n");
    assert!(held.contains("\n[[constraints]]"));
    Scene::parse(&held, &path).unwrap();

    assert!(matches!(new_scene(&mesh, &AS_IT_IS, None, false), Err(NewSceneError::Exists { .. })));
    new_scene(&mesh, &AS_IT_IS, None, true).unwrap();
    // The mesh is not replaced by its scene.
    let before = std::fs::read(&mesh).unwrap();
    assert!(matches!(new_scene(&mesh, &AS_IT_IS, Some(&mesh), true), Err(NewSceneError::Exists { .. })));
    assert_eq!(std::fs::read(&mesh).unwrap(), before);
    let elsewhere = tempfile::tempdir().unwrap();
    let (path, _) = new_scene(&mesh, &AS_IT_IS, Some(&elsewhere.path().join("a.toml")), false).unwrap();
    let Body::Meshed(body) = Scene::read(path).unwrap().body else { panic!("it has a mesh") };
    assert_eq!(body.mesh, mesh.canonicalize().unwrap());
}
