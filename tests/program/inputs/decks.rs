//! `flexframe new` of decks, and what commands say of what a deck has and a scene has not. Needs gmsh.

use std::path::Path;
use std::process::Command;

use flexframe::campbell::{AboutRest, CampbellSettings, Speeds, campbell};
use flexframe::fmu::{FmuSettings, pack};
use flexframe::model::{Builder, Model};
use flexframe::new_scene::{ImportSettings, scene_text};
use flexframe::scene::Body;

use crate::program::{done, json, numbers};

/// The bar of 200 x 10 x 10 as a deck of this ending, with more lines before its end.
fn deck(folder: &Path, name: &str, more: &str) -> String {
    let geometry = concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/model/tests/data/bar.geo");
    let path = folder.join(name);
    let gmsh = Command::new("gmsh").args(["-3", "-order", "2", "-v", "0", geometry, "-o"]).arg(&path).status();
    assert!(gmsh.unwrap().success());
    let text = std::fs::read_to_string(&path).unwrap().replace("ENDDATA", "");
    std::fs::write(&path, text + more).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Closed form: the mass of the bar, 200 x 10 x 10 times its density, and those of the deck; a mass beside the body is carried by it. Units are
/// inches by the material.
#[test]
fn a_scene_of_a_deck_has_its_units_its_material_and_its_masses() {
    let folder = tempfile::tempdir().unwrap();
    let more = "PSOLID,1,7\nMAT1,7,1.+7,,.33,2.54-4\nGRID,90001,,210.,0.,0.\nCONM2,90002,5,,.1\nCONM2,90003,90001,,.5\n\
                CONM2,90006,90005,,.7\nGRID,90005,,300.,0.,0.\nRBE3,90004,,90001,123456,1.,123,5,6\n,7,8\nCBAR,90005,1,1,2,0.,0.,1.\n";
    let mesh = deck(folder.path(), "bar.bdf", more);
    let scene = folder.path().join("bar.toml");
    let said = done(&["new", &mesh]);
    assert!(said.contains("wrote"), "{said}");
    let text = std::fs::read_to_string(&scene).unwrap();
    for words in [
        "the materials of its file look like inches (stress in psi)",
        "(forces in lbf, stresses in psi)",
        "units = { length = \"in\", mass = \"lbf s²/in\", time = \"s\" }",
        "{ at = [200.0, -5.0, -5.0], mass = 0.1 }",
        "tied_masses = [\n    { at = [210.0, 0.0, 0.0], mass = 0.5, group = \"RBE3_90004\" },",
        "young_modulus = 10000000.0, poisson_ratio = 0.33, density = 0.000254",
        "# Node sets of the mesh: \"RBE3_90004\".",
        "# [body.markers.\"RBE3_90004\"]",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let report = |scene: &Path| {
        let report = json(&["modes", scene.to_str().unwrap()]);
        let warnings: Vec<String> =
            report["warnings"].as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect();
        (report, warnings)
    };
    let (found, warnings) = report(&scene);
    let mass = found["body"]["mass"].as_f64().unwrap();
    assert!((mass / (20_000.0 * 2.54e-4 + 0.6) - 1.0).abs() < 1e-4, "{mass}");
    let [cards, masses] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(cards.contains("read: 768 tetrahedra; not used: 1 CBAR (mass not known)"), "{cards}");
    assert!(masses.contains("not used: 1 CONM2 (7.0000e-1"), "{masses}");
    // Without them the masses are told.
    let without = folder.path().join("without.toml");
    let is_mass = |line: &&str| line.contains("mass = 0.") || line.contains("_masses") || *line == "]";
    std::fs::write(&without, text.lines().filter(|line| !is_mass(line)).collect::<Vec<_>>().join("\n")).unwrap();
    let (found, warnings) = report(&without);
    let ties = "not used: 1 RBE3 (in a scene: a marker with group = \"RBE3_90004\" and tie = \"mean\")";
    for words in ["not used: 3 CONM2 (1.3000e0", ties] {
        assert!(warnings.iter().any(|text| text.contains(words)), "{words}: {warnings:?}");
    }
    assert_eq!(numbers(&found["body"]["natural_frequencies"]).len(), 10);
}

/// Closed form: the numbers of the deck.
#[test]
fn a_deck_without_a_density_keeps_its_elasticity() {
    let folder = tempfile::tempdir().unwrap();
    let more = "*NSET, NSET=end\n1,2,3,4\n*SOLID SECTION, ELSET=bar, MATERIAL=alu\n*MATERIAL, NAME=ALU\n*ELASTIC\n70000., .33\n";
    let mesh = deck(folder.path(), "bar.inp", more);
    done(&["new", &mesh]);
    let text = std::fs::read_to_string(folder.path().join("bar.toml")).unwrap();
    for words in [
        "young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9",
        "It gives no density",
        "length = \"mm\"",
        "# Node sets of the mesh: \"end\".",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let found = json(&["modes", folder.path().join("bar.toml").to_str().unwrap()]);
    assert!(found["warnings"].to_string().contains("the material alu of bar has no *DENSITY"), "{}", found["warnings"]);
}

/// Independent reference: mass and frequencies of each deck in `tests/decks` by the finite elements of
/// `crates/verification/decks/elements.py` and, within its integration, by CalculiX (`./dev decks`; docs/evidence/decks.md).
#[test]
fn decks_of_all_kinds_have_the_masses_and_frequencies_of_other_programs() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/decks"));
    let numbers = std::fs::read_to_string(folder.join("numbers.csv")).unwrap();
    let settings = ImportSettings::default();
    for row in numbers.lines().skip(1) {
        let (name, wanted) = row.split_once(',').unwrap();
        let wanted: Vec<f64> = wanted.split(',').map(|number| number.parse().unwrap()).collect();
        let path = folder.join(name);
        let (text, notes) = scene_text(&path, &settings).unwrap_or_else(|error| panic!("{name}: {error}"));
        // Static shapes of a marker and few modes are not enough for these digits.
        let count = if text.contains("\n[body.markers") { "flexible = 10" } else { "flexible = 3" };
        let scene = Body::parse(&text.replace("flexible = 10", count), folder.join("scene.toml")).unwrap();
        let model = Model::build(&scene, |_| ()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = [vec![model.body.mass], model.natural_frequencies()].concat();
        // Short fields have five digits.
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found / wanted - 1.0).abs() < 3e-5, "{name}: {found} for {wanted}");
        }
        if name == "calculix.inp" {
            // CalculiX 2.20, with `*BOUNDARY` FIX,1,3 in the deck.
            let commented = "# [[constraints]]\n# kind = \"clamp\"\n# group = \"FIX\"";
            assert!(text.contains(commented), "{text}");
            let held = text.replace(commented, &commented.replace("# ", "")).replace("angular_velocity = ", "# ");
            let model = Model::build(&Body::parse(&held, folder.join("held.toml")).unwrap(), |_| ()).unwrap();
            for (found, wanted) in model.natural_frequencies().iter().zip([2039.548, 4684.613, 9362.699]) {
                assert!((found / wanted - 1.0).abs() < 2e-4, "held: {found} for {wanted}");
            }
        }
        if name == "nastran_rbe3_off.bdf" {
            let refused = |from: &str, to: &str| {
                let scene = Body::parse(&text.replace(from, to), folder.join("other.toml"));
                let scene = scene.map_err(|error| error.to_string());
                scene
                    .and_then(|scene| Model::build(&scene, |_| ()).map_err(|error| error.to_string()))
                    .map(|_| ())
                    .unwrap_err()
            };
            for (from, to, words) in [
                ("flexible = 10", "flexible = 10\nlarge = 1", "a body with masses beside it"),
                ("flexible = 10", "flexible = 10\nabout = \"auto\"", "masses beside it"),
                ("group = \"RBE3_9003\" }", "group = \"nowhere\" }", "body.tied_masses[0].group"),
                ("mass = 3e-5", "mass = 0.0", "body.tied_masses[0].mass"),
            ] {
                let said = refused(from, to);
                assert!(said.contains(words), "{to}: {said}");
            }
            let folder = tempfile::tempdir().unwrap();
            let counted = text.replace("flexible = 10", "flexible = 1");
            let scene = Body::parse(&counted, path.with_extension("toml")).unwrap();
            let settings = FmuSettings { library: Some("none".into()) };
            let packed =
                pack(&scene.clone().into(), &Builder::default(), &folder.path().join("x.fmu"), &settings, |_| ());
            let said = packed.unwrap_err().to_string();
            for words in ["body.tied_masses", "fixed joints: the FMU of bodies in joints"] {
                assert!(said.contains(words), "{words}: {said}");
            }
            let settings = CampbellSettings {
                axis: Some([0.0, 0.0, 1.0]),
                joint: None,
                speeds: Speeds { start: 0.0, end: 1e-3, count: 2 },
                orders: Vec::new(),
                about_rest: AboutRest::Auto,
            };
            let report = campbell(&scene.clone().into(), &Builder::default(), &settings, |_| ()).unwrap();
            let said = "rest     not found of a body with masses beside it (`tied_masses`): vibrations about the undeformed body";
            assert!(report.to_string().contains(said), "{report}");
        }
        let known: &[&str] = match name {
            "salome.med" => &["are turned"],
            "abaqus_cae.inp" => &["node set RP has no nodes", "not used: 1 *STEP"],
            "calculix.inp" => &["not used: 1 *STEP"],
            "nastran_rbe2.bdf" => &["1 CBAR (1.2560e-7), 1 CMASS2 in single directions (1.0000e-6), 1 CTRIA3 ("],
            _ => &[],
        };
        assert_eq!(notes.len(), known.len(), "{name}: {notes:?}");
        assert!(known.iter().zip(&notes).all(|(words, note)| note.contains(words)), "{name}: {notes:?}");
    }
}
