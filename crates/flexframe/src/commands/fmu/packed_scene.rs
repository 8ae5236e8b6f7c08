//! The text of a scene for an FMU, which names no file outside of it.

use std::fmt;
use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use toml::{Table, Value};

/// The refusal of a scene whose text could not be changed to the text that the FMU holds.
pub(super) fn cannot_pack(error: impl fmt::Display) -> Failure {
    let help = "run it by `flexframe run`, and correct what that says; if it runs, please report this";
    Kind::Input.alone().help(help).says(format!("the scene cannot be written for the FMU: {error}"))
}

/// A scene that finds everything in its own folder.
pub(super) struct PackedScene {
    pub text: String,
    /// Tables of histories and of measured modes, and of a system its meshes: where they are, and their names in the FMU.
    pub tables: Vec<(PathBuf, String)>,
}

impl PackedScene {
    /// The packed form of a scene in a folder. With a `body_file`, the body becomes that of it; names of tables begin with
    /// `prefix`.
    pub fn new(text: &str, folder: &Path, body_file: Option<&str>, prefix: &str) -> Result<Self, Failure> {
        let mut scene: Table = toml::from_str(text).map_err(cannot_pack)?;
        if let Some(file) = body_file {
            let body = Table::from_iter([("file".to_owned(), Value::from(file))]);
            scene.insert("body".to_owned(), Value::Table(body));
        }
        let mut tables = Vec::new();
        for (_, value) in scene.iter_mut().filter(|(key, _)| *key != "body") {
            take_tables(value, folder, prefix, &mut tables);
        }
        let text = toml::to_string(&scene).map_err(cannot_pack)?;
        Ok(Self { text, tables })
    }

    /// The packed form of a scene of bodies that are tied together: with their meshes, since body files have no markers.
    pub fn of_system(text: &str, folder: &Path) -> Result<Self, Failure> {
        let mut scene: Table = toml::from_str(text).map_err(cannot_pack)?;
        let mut files = Vec::new();
        scene.iter_mut().for_each(|(_, value)| take_tables(value, folder, "", &mut files));
        if let Some(body) = scene.get_mut("body") {
            take_mesh(body, folder, &mut files);
        }
        if let Some(Value::Table(bodies)) = scene.get_mut("bodies") {
            bodies.iter_mut().for_each(|(_, body)| take_mesh(body, folder, &mut files));
        }
        let text = toml::to_string(&scene).map_err(cannot_pack)?;
        Ok(Self { text, tables: files })
    }
}

/// Names the mesh or the body file of a body anew.
fn take_mesh(body: &mut Value, folder: &Path, files: &mut Vec<(PathBuf, String)>) {
    for key in ["mesh", "file"] {
        if let Some(Value::String(file)) = body.get_mut(key) {
            let path = folder.join(&*file);
            let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
            let name = format!("{key}{}{ending}", files.len() + 1);
            files.push((path, name.clone()));
            *file = name;
        }
    }
}

/// Names the files of all histories of the kind "table" in `value` anew, and those of measured modes.
fn take_tables(value: &mut Value, folder: &Path, prefix: &str, tables: &mut Vec<(PathBuf, String)>) {
    match value {
        Value::Array(entries) => entries.iter_mut().for_each(|entry| take_tables(entry, folder, prefix, tables)),
        Value::Table(table) => {
            let is_table = table.get("kind").and_then(Value::as_str) == Some("table");
            if let Some(Value::String(file)) = table.get_mut("file").filter(|_| is_table) {
                let name = format!("{prefix}table{}.csv", tables.len() + 1);
                tables.push((folder.join(&*file), name.clone()));
                *file = name;
            }
            if let Some(Value::String(file)) = table.get_mut("measured") {
                let name = format!("{prefix}table{}.csv", tables.len() + 1);
                tables.push((folder.join(&*file), name.clone()));
                *file = name;
            }
            table.iter_mut().for_each(|(_, value)| take_tables(value, folder, prefix, tables));
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_body_and_the_tables_are_those_of_the_fmu() {
        let text = r#"
            title = "t"
            [body]
            mesh = "../meshes/ring.msh"
            material = { young_modulus = 1.0, poisson_ratio = 0.3, density = 1.0 }
            [[loads]]
            kind = "gravity"
            history = { kind = "table", file = "a/gravity.csv" }
            [[loads]]
            kind = "force"
            history = { kind = "product", factors = [{ kind = "step", at = 1.0 }, { kind = "table", file = "/b.csv" }] }
        "#;
        let packed = PackedScene::new(text, Path::new("scenes"), Some("body.h5"), "").unwrap();
        let scene: Table = toml::from_str(&packed.text).unwrap();
        assert_eq!(scene["body"].as_table().unwrap(), &Table::from_iter([("file".to_owned(), Value::from("body.h5"))]));
        assert_eq!(scene["loads"][0]["history"]["file"].as_str(), Some("table1.csv"));
        assert_eq!(scene["loads"][1]["history"]["factors"][1]["file"].as_str(), Some("table2.csv"));
        let from: Vec<&Path> = packed.tables.iter().map(|(path, _)| path.as_path()).collect();
        assert_eq!(from, [Path::new("scenes/a/gravity.csv"), Path::new("/b.csv")]);
    }
}
