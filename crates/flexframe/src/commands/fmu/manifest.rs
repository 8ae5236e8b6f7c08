//! List of the resources of an FMU, so that missing and damaged ones are found.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use diagnostic::{Failure, Kind};
use keys::{Digest, Hash};
use scene::{Body, Scene};
use serde::{Deserialize, Serialize};

/// Its name among the resources.
pub const MANIFEST: &str = "manifest.json";

/// The list of the resources of an FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Identifier of the FMU in `modelDescription.xml`, in braces.
    pub guid: String,
    /// The version of flexframe that has packed it.
    pub program_version: String,
    /// The bodies.
    pub bodies: Vec<PackedBody>,
    /// The file of the scene of all bodies, where they are tied together.
    pub system: Option<String>,
    /// The BLAKE3 hash of every other file.
    pub files: BTreeMap<String, String>,
}

/// A body among the resources of an FMU.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PackedBody {
    /// Its name; none of a single one.
    pub name: Option<String>,
    /// The file of the scene of it alone.
    pub scene: String,
}

impl Manifest {
    /// The list of the files in a folder, and of the bodies in them; `names` are relative to it.
    pub(super) fn of(
        folder: &Path,
        names: &[String],
        (bodies, system): (Vec<PackedBody>, Option<String>),
    ) -> Result<Self, Failure> {
        let mut files = BTreeMap::new();
        let program_version = env!("CARGO_PKG_VERSION").to_owned();
        let mut digest = Digest::new().text(&program_version);
        for name in names {
            let path = folder.join(name);
            let hash = Hash::of_file(&path).map_err(unreadable(&path))?;
            digest = digest.text(name).hash(&hash);
            files.insert(name.clone(), hash.to_string());
        }
        for PackedBody { name, scene } in &bodies {
            digest = digest.text(name.as_deref().unwrap_or_default()).text(scene);
        }
        let digits = digest.finish().to_string();
        let part = |from: usize, to: usize| digits.get(from..to).unwrap_or_default();
        let guid = format!("{{{}-{}-{}-{}-{}}}", part(0, 8), part(8, 12), part(12, 16), part(16, 20), part(20, 32));
        Ok(Self { guid, program_version, bodies, system, files })
    }

    /// Reads the manifest of an unpacked FMU, and checks every file that it names.
    ///
    /// # Errors
    /// [`Failure`] for a folder without a manifest, an FMU of another version, and files that are missing or have changed.
    pub fn checked(resources: &Path) -> Result<Self, Failure> {
        let path = resources.join(MANIFEST);
        let text = std::fs::read_to_string(&path).map_err(missing(&path))?;
        let manifest: Self = serde_json::from_str(&text).map_err(|_| damaged(&path))?;
        if manifest.program_version != env!("CARGO_PKG_VERSION") {
            let (found, own) = (&manifest.program_version, env!("CARGO_PKG_VERSION"));
            let words = format!("the resources of this FMU are those of flexframe {found}, its library is of {own}");
            return Err(Kind::Input
                .alone()
                .found(found)
                .expected(own)
                .help("pack it again: flexframe fmu")
                .says(words));
        }
        for (name, expected) in &manifest.files {
            let path = resources.join(name);
            let found = Hash::of_file(&path).map_err(missing(&path))?;
            if found.to_string() != *expected {
                return Err(damaged(&path));
            }
        }
        Ok(manifest)
    }

    /// The bodies, and what ties them together.
    pub(super) fn system(&self, resources: &Path) -> Result<Scene, Failure> {
        if let Some(file) = &self.system {
            return Ok(Scene::read(resources.join(file))?);
        }
        let body = |PackedBody { name, scene }: &PackedBody| -> Result<Body, Failure> {
            Ok(Body { name: name.clone(), ..Body::read(resources.join(scene))? })
        };
        let bodies = self.bodies.iter().map(body).collect::<Result<Vec<Body>, Failure>>()?;
        let first = bodies
            .first()
            .ok_or_else(|| Kind::Input.alone().help("give one or more").says("there is no body to pack"))?
            .clone();
        Ok(Scene { bodies, ..first.into() })
    }
}

/// The error of a file that cannot be read.
pub(super) fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> Failure {
    move |error| Kind::Io.of(path).help("check its name and its permissions").says(format!("cannot be read: {error}"))
}

fn missing(path: &Path) -> impl FnOnce(io::Error) -> Failure {
    let help = "unpack the whole FMU again, or pack it again: flexframe fmu";
    move |error| Kind::Io.of(path).help(help).says(format!("a resource of the FMU cannot be read: {error}"))
}

fn damaged(path: &Path) -> Failure {
    let help = "unpack the FMU again, or pack it again: flexframe fmu";
    Kind::Input.of(path).help(help).says("this resource of the FMU has been changed or damaged")
}
