//! A first scene of a mesh runs as it is.

use std::path::Path;

use diagnostic::Kind;
use flexframe::new_scene::{ImportSettings, new_scene};
use flexframe::run::{self, RunSettings};
use flexframe::scene::{Body, BodySource};

const AS_IT_IS: ImportSettings =
    ImportSettings { mesh_size: None, raise_order: false, trust_geometry: false, hides_lines: false };

/// Closed form: the mass is ρV of a box of steel.
#[test]
fn it_names_groups_and_mass_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("bar \"1\".msh");
    std::fs::copy(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("crates/model/tests/data/bar.msh"),
        &mesh,
    )
    .unwrap();

    let (path, notes) = new_scene(&mesh, &AS_IT_IS, None, false).unwrap();
    assert!(notes.is_empty());
    assert_eq!(path, folder.path().join("bar \"1\".toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    // 200 x 10 x 10 mm of steel.
    for words in ["millimetres", "200.0 x 10.0 x 10.0 mm", "is 0.000157 Mg"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let body = Body::read(&path).unwrap();
    let BodySource::Meshed(meshed) = &body.source else { panic!("it has a mesh") };
    assert_eq!(meshed.mesh, mesh);
    let (models, report) = run::run(&body.into(), folder.path(), &RunSettings::default(), |_| ()).unwrap();
    let mass = models[0].body.mass;
    assert!((mass / 1.57e-4 - 1.0).abs() < 1e-9, "{mass}");
    let balances = &report.bodies[0].balances;
    assert!(balances.energy < 1e-3, "{:?}", balances.energy);

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
    Body::parse(&held, &path).unwrap();

    assert_eq!(new_scene(&mesh, &AS_IT_IS, None, false).unwrap_err().diagnosis().kind, Kind::Io);
    new_scene(&mesh, &AS_IT_IS, None, true).unwrap();
    // The mesh is not replaced by its scene.
    let before = std::fs::read(&mesh).unwrap();
    assert_eq!(new_scene(&mesh, &AS_IT_IS, Some(&mesh), true).unwrap_err().diagnosis().kind, Kind::Usage);
    assert_eq!(std::fs::read(&mesh).unwrap(), before);
    let elsewhere = tempfile::tempdir().unwrap();
    let (path, _) = new_scene(&mesh, &AS_IT_IS, Some(&elsewhere.path().join("a.toml")), false).unwrap();
    let BodySource::Meshed(meshed) = Body::read(path).unwrap().source else { panic!("it has a mesh") };
    assert_eq!(meshed.mesh, mesh.canonicalize().unwrap());
}

/// Closed form: the mass is the sum of ρV. A bracket of aluminium does not become one of steel.
#[test]
fn the_materials_of_a_deck_are_those_of_its_scene_and_another_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let geometry = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 5, 2, 1};\nBox(2) = {5, 0, 0, 1, 2, 1};\nCoherence;\n\
                    Physical Volume(\"arm\") = {1};\nPhysical Volume(\"head\") = {2};\n";
    std::fs::write(folder.path().join("bracket.geo"), geometry).unwrap();
    let mut gmsh = std::process::Command::new("gmsh");
    gmsh.args(["bracket.geo", "-3", "-order", "2", "-o", "bracket.inp"]).current_dir(folder.path());
    assert!(gmsh.output().unwrap().status.success());
    let mesh = folder.path().join("bracket.inp");
    let deck = std::fs::read_to_string(&mesh).unwrap();
    let alloy = "*MATERIAL, NAME=AW 6082\n*ELASTIC\n70e3, 0.33\n*DENSITY\n2.7e-9\n";
    let of = |sections: &str| {
        std::fs::write(&mesh, format!("{deck}{alloy}{sections}")).unwrap();
        let (path, notes) = new_scene(&mesh, &AS_IT_IS, None, true).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let body = Body::parse(&text, &path).unwrap();
        (text, flexframe::model::Model::build(&body, |_| ()).unwrap(), notes)
    };
    let both = "*SOLID SECTION, ELSET=arm, MATERIAL=AW 6082\n*SOLID SECTION, ELSET=head, MATERIAL=AW 6082\n";
    let (text, model, notes) = of(both);
    // 6 mm would look like metres: the density says more.
    for words in ["materials of its file look like millimetres", "\"AW 6082\"", "material = { young_modulus = 70000.0"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!((model.body.mass / (12.0 * 2.7e-9) - 1.0).abs() < 1e-9 && notes.is_empty(), "{notes:?}");
    assert!(model.meshed.unwrap().mesh_notes.is_empty());

    // Two materials.
    let steel =
        "*MATERIAL, NAME=steel\n*ELASTIC\n210e3, 0.3\n*DENSITY\n7.85e-9\n*SOLID SECTION, ELSET=head, MATERIAL=steel\n";
    let arm = "*SOLID SECTION, ELSET=arm, MATERIAL=AW 6082\n";
    let (text, model, notes) = of(&format!("{steel}{arm}"));
    assert!(text.contains("[body.materials]\n\"arm\" = { young_modulus = 70000.0"), "{text}");
    assert!((model.body.mass / (10.0 * 2.7e-9 + 2.0 * 7.85e-9) - 1.0).abs() < 1e-9 && notes.is_empty(), "{notes:?}");

    // A scene with one of its own keeps it, and says so.
    let own = text.replacen("density = 2.7e-9", "density = 2.8e-9", 1);
    let body = Body::parse(&own, folder.path().join("own.toml")).unwrap();
    let model = flexframe::model::Model::build(&body, |_| ()).unwrap();
    let notes = &model.meshed.as_ref().unwrap().mesh_notes;
    assert!((model.body.mass / (10.0 * 2.8e-9 + 2.0 * 7.85e-9) - 1.0).abs() < 1e-9);
    assert_eq!(notes.len(), 1, "{notes:?}");
    for words in ["gives arm the material AW 6082", "density = 2.7e-9", "density = 2.8e-9", "which is used"] {
        assert!(notes[0].contains(words), "{words}: {notes:?}");
    }

    // Elements without a material.
    let (text, _, notes) = of(arm);
    assert!(text.contains("# Steel.") && notes.len() == 1, "{text} {notes:?}");
    assert!(notes[0].contains("AW 6082") && notes[0].contains("not used, but steel"), "{notes:?}");
}
