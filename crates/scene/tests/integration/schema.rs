//! The JSON schema of scenes against the scenes of the project.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Scene files of a folder and those within it.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(scenes(&path)),
            false if path.extension().is_some_and(|ending| ending == "toml") => found.push(path),
            false => {}
        }
    }
    found
}

/// Tells what the schema refuses in a scene; `None` where it takes it.
fn refusal(scene: &str) -> Option<String> {
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("scene.json", scene::json_schema()).unwrap();
    let mut schemas = boon::Schemas::new();
    let index = compiler.compile("scene.json", &mut schemas).unwrap();
    let scene: Value = toml::from_str(scene).unwrap();
    schemas.validate(&scene, index).err().map(|error| error.to_string())
}

#[test]
fn every_scene_of_the_examples_fits_the_schema() {
    let found = scenes(&root().join("examples"));
    assert!(found.len() > 20, "{found:?}");
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        if scene::Scene::parse(&text, &path).is_ok() {
            assert_eq!(refusal(&text), None, "{}", path.display());
        }
    }
}

#[test]
fn what_the_program_refuses_by_its_form_the_schema_refuses() {
    let scene = fs::read_to_string(root().join("examples/plate.toml")).unwrap();
    let changes = [
        ("flexible = 10", "flexibel = 10"),
        ("flexible = 10", "flexible = \"most\""),
        ("kind = \"force\"", "kind = \"push\""),
        ("amplitude = 50.0", "amplitude = 50.0\nradius = 3.0"),
        ("kind = \"half-sine\"", "kind = \"sawtooth\""),
        ("title =", "titel ="),
        ("[body]", "[bodies]\n[body]"),
    ];
    for (from, to) in changes {
        let changed = scene.replacen(from, to, 1);
        assert_ne!(changed, scene, "{from}");
        assert!(refusal(&changed).is_some(), "{to}");
        assert!(scene::Scene::parse(&changed, root().join("examples/plate.toml")).is_err(), "{to}");
    }
}

#[test]
fn keys_explain_themselves() {
    let schema = scene::json_schema();
    let mut silent = Vec::new();
    walk(&schema, "", &mut silent);
    assert!(silent.is_empty(), "keys without a description: {silent:?}");
    assert!(!schema.to_string().contains("[`"), "a link of Rust in a description");
}

/// Collects the properties that have no description, of their own or by what they refer to.
fn walk(schema: &Value, path: &str, silent: &mut Vec<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                for (key, property) in properties {
                    // Kinds are told by their names.
                    let told = key == "kind" || property.get("description").is_some();
                    if !told {
                        silent.push(format!("{path}/{key}"));
                    }
                }
            }
            object.iter().for_each(|(key, value)| walk(value, &format!("{path}/{key}"), silent));
        }
        Value::Array(list) => list.iter().for_each(|value| walk(value, path, silent)),
        _ => {}
    }
}

#[test]
fn a_history_may_be_a_string_alone() {
    let schema = scene::json_schema();
    let kinds = schema["definitions"]["History"]["oneOf"].as_array().unwrap();
    assert!(kinds.contains(&json!({ "const": "constant" })));
}
