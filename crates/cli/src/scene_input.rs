//! The scene of a command: a file or standard input, with values set on the command line.

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::Failure;
use flexframe::fmu::scene_of_body;
use flexframe::given_file::GivenFile;
use scene::{AssignError, Body, Scene, assign, text_from, text_of};
use toml::Value;

use crate::cli_error::option;

/// Name of standard input.
const STANDARD_INPUT: &str = "-";
/// Its name in messages and in names of output; paths in its scene are relative to the folder that the user is in.
const NAME: &str = "stdin";

#[derive(Debug, Clone, Args)]
pub struct SceneInput {
    /// The scene file, or - for standard input (paths in it are relative to the current folder then).
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Set a key of the scene, such as time.end=0.5 or loads[0].amplitude=20; may be given many times.
    ///
    /// The value is written as in the scene file; what is not TOML is taken as text, so that quotes may be left out.
    #[arg(long, value_name = "KEY=VALUE", value_parser = assignment)]
    set: Vec<(String, Value)>,
    /// One body of a scene of several.
    #[arg(long, value_name = "NAME")]
    body: Option<String>,
}

impl SceneInput {
    /// As [`Self::read_scene`], of a body file, too: then it is the scene that it was made of.
    pub fn read_scene_or_body_file(self) -> Result<Scene, Failure> {
        if !self.scene.extension().is_some_and(|extension| extension == "h5" || extension == "hdf5") {
            return self.read_scene();
        }
        GivenFile::expect(&self.scene, &[GivenFile::Scene, GivenFile::Body], "a scene file or a body file")?;
        let body = scene_of_body(&self.scene)?;
        let text = assigned(&body.text_alone, &self.set)?;
        Ok(Body::parse(&text, &self.scene)?.into())
    }

    /// The results file that was given in the place of a scene, if one was. It has a scene of its own, which is not to be changed.
    pub fn results(&self) -> Result<Option<&Path>, Failure> {
        match (GivenFile::of(&self.scene), &self.set[..]) {
            (Some(GivenFile::Results), []) => Ok(Some(&self.scene)),
            (Some(GivenFile::Results), _) => {
                let found = "a results file, whose motion has been computed";
                Err(option("--set", found, "a scene", "leave --set out, or give the scene file"))
            }
            _ => Ok(None),
        }
    }

    /// Reads the scene of one body, sets the values, and checks it.
    pub fn read(self) -> Result<Body, Failure> {
        let body = self.body.clone();
        let (text, path) = self.text()?;
        Ok(Body::parse_body(&text, path, body.as_deref())?)
    }

    /// Reads all bodies with what ties them together, or the one that was named.
    pub fn read_scene(self) -> Result<Scene, Failure> {
        if self.body.is_some() {
            return Ok(self.read()?.into());
        }
        let (text, path) = self.text()?;
        Ok(Scene::parse(&text, path)?)
    }

    /// The text with the values set, and where it comes from.
    fn text(self) -> Result<(String, PathBuf), Failure> {
        let (text, path) = if self.scene == Path::new(STANDARD_INPUT) {
            let path = PathBuf::from(NAME);
            (text_from(std::io::stdin().lock(), &path)?, path)
        } else {
            GivenFile::expect(&self.scene, &[GivenFile::Scene], "a scene file")?;
            (text_of(&self.scene)?, self.scene)
        };
        Ok((assigned(&text, &self.set)?, path))
    }
}

/// The text of a scene with values set.
fn assigned(text: &str, set: &[(String, Value)]) -> Result<String, Failure> {
    assign(text, set).map_err(|AssignError { key, found, expected }| {
        let help = "name the key as messages about the scene do; docs/reference/scene.md lists them";
        option("--set", format!("`{key}`, {found}"), expected, help)
    })
}

/// A key and its value.
fn assignment(text: &str) -> Result<(String, Value), String> {
    let (key, value) = text.split_once('=').ok_or("expected KEY=VALUE, such as time.end=0.5")?;
    let (key, value) = (key.trim(), value.trim());
    let table: Option<toml::Table> = toml::from_str(&format!("value = {value}")).ok();
    let parsed = table.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    Ok((key.to_owned(), parsed.unwrap_or_else(|| Value::String(value.to_owned()))))
}
