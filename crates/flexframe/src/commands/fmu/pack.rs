//! Packs an FMU.

use std::fmt;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};

use diagnostic::{Diagnostic, Failure, Kind};
use model::{BuildProgress, Builder, Needs, StartError};
use scene::{Body, BodySource, Flexible, MeshedBody, Scene, Shared};
use sealed::{Format, SealedFile};
use serde::Serialize;
use whole_file::{TemporaryFolder, write_whole};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::description::describe;
use super::library::Library;
use super::manifest::unreadable;
use super::manifest::{MANIFEST, Manifest, PackedBody};
use super::model::FmuModel;
use super::packed_scene::PackedScene;
use super::packed_scene::cannot_pack;
use super::variables::Source;
use crate::files::json;
use crate::files::write_error::WriteError;

/// How an FMU is packed.
#[derive(Debug, Clone, Default)]
pub struct FmuSettings {
    /// The library for it; otherwise the one that the environment names, or the one beside the program.
    pub library: Option<PathBuf>,
}

/// Report of `flexframe fmu`.
#[derive(Debug, Clone, Serialize)]
pub struct FmuReport {
    /// The FMU.
    #[serde(serialize_with = "json::path")]
    pub fmu: PathBuf,
    /// Its identifier in `modelDescription.xml`.
    pub guid: String,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Number of outputs.
    pub outputs: usize,
    /// Number of variables that can be looked at besides.
    pub locals: usize,
    /// Bytes of the file.
    pub bytes: usize,
}

impl fmt::Display for FmuReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fmu, guid, inputs, outputs, locals, bytes } = self;
        writeln!(f, "{}", fmu.display())?;
        writeln!(f, "  FMI      2.0 for co-simulation, {:.1} MB, guid {guid}", *bytes as f64 / 1e6)?;
        writeln!(f, "  inputs   {}, held between communication points", inputs.len())?;
        writeln!(f, "  outputs  {outputs}, and {locals} variables to look at")
    }
}

impl FmuReport {
    fn new(output: &Path, fmu: &FmuModel, manifest: Manifest, bytes: usize) -> Self {
        let count = |is: bool| {
            let of = |source: Source| matches!(source, Source::Row { is_output, .. } if is_output == is);
            fmu.variables.iter().filter(|variable| of(variable.source)).count()
        };
        let is_input = |source: Source| matches!(source, Source::Input(_));
        let inputs = fmu.variables.iter().filter(|variable| is_input(variable.source));
        Self {
            fmu: output.to_owned(),
            guid: manifest.guid,
            inputs: inputs.map(|variable| variable.name.clone()).collect(),
            outputs: count(true),
            locals: count(false),
            bytes,
        }
    }
}

/// The scene that a body file was made of, with its body from there.
///
/// # Errors
/// [`Failure`] for a file that is no body file of this version, and for a scene that breaks a rule.
pub fn scene_of_body(file: &Path) -> Result<Body, Failure> {
    let body = SealedFile::open(file, Format::BODY)?;
    let text = body.text("scene").ok_or_else(|| {
        let help = "make it again: flexframe reduce SCENE -o FILE";
        Kind::Input.of(file).help(help).says("no scene is in this file")
    })?;
    let mut scene: toml::Table = toml::from_str(text).map_err(cannot_pack)?;
    let name = std::path::absolute(file).unwrap_or_else(|_| file.to_owned()).display().to_string();
    scene.insert("body".to_owned(), toml::Table::from_iter([("file".to_owned(), toml::Value::from(name))]).into());
    let text = toml::to_string(&scene).map_err(cannot_pack)?;
    Ok(Body::parse(&text, file)?)
}

/// Packs the bodies of a scene as an FMU, whole or not at all.
///
/// # Errors
/// [`Failure`].
pub fn pack(
    scene: &Scene,
    builder: &Builder,
    output: &Path,
    settings: &FmuSettings,
    mut progress: impl FnMut(BuildProgress),
) -> Result<FmuReport, Failure> {
    let scenes = &scene.bodies[..];
    scenes.iter().try_for_each(check)?;
    let is_tied = scene.has_ties();
    if scene.joints.is_empty() && scene.springs.is_empty() && scene.bushings.is_empty() {
        // One of several that are tied.
        let tied = scenes.iter().find_map(|body| Some((body, StartError::refuse_tied(body).err()?)));
        if let Some((body, source)) = tied {
            return Err(source.in_file(&body.path));
        }
    }
    let library = Library::find(settings.library.as_deref())?;
    let temporary = TemporaryFolder::new().map_err(WriteError::of(output))?;
    let resources = temporary.path();
    let (mut names, mut bodies) = (Vec::new(), Vec::new());
    let file = is_tied.then(|| pack_whole(scene, resources, &mut names)).transpose()?;
    for (i, body) in scenes.iter().enumerate() {
        if let Some(file) = &file {
            bodies.push(PackedBody { name: body.name.clone(), scene: file.clone() });
            continue;
        }
        // The only body of its own scene has no number.
        let prefix = body.name.as_ref().map_or_else(String::new, |_| format!("{}-", i + 1));
        bodies.push(pack_body((body, builder), resources, &prefix, &mut names, &mut progress)?);
    }
    let manifest = Manifest::of(resources, &names, (bodies, file))?;
    // What is packed is what will be opened. Its files have been found by now; messages name the scene that was given.
    let opened = manifest.system(resources)?;
    let mut opened =
        opened.with_shared(|shared| Shared { path: scene.path.clone(), text: scene.text.clone(), ..shared });
    for (opened, given) in opened.bodies.iter_mut().zip(scenes) {
        opened.source.clone_from(&given.source);
    }
    let fmu = FmuModel::new(opened, &Builder::default(), progress)?;
    let text = serde_json::to_string_pretty(&manifest).map_err(cannot_pack)?;
    std::fs::write(resources.join(MANIFEST), text).map_err(WriteError::of(&resources.join(MANIFEST)))?;
    names.push(MANIFEST.to_owned());

    let identifier = c_identifier(output);
    let bytes = zipped(resources, &names, &library, &identifier, || describe(&fmu, &manifest, &identifier))
        .map_err(WriteError::of(output))?;
    write_whole(output, &bytes).map_err(WriteError::of(output))?;
    Ok(FmuReport::new(output, &fmu, manifest, bytes.len()))
}

/// Refuses a body that cannot be packed.
fn check(body: &Body) -> Result<(), Failure> {
    if let (true, BodySource::Meshed(meshed)) = (body.tied, &body.source)
        && meshed.mesh.extension().is_none_or(|ending| ending != "msh")
    {
        let help = "convert it with gmsh or meshio: the FMU holds the meshes of tied bodies, and reads them without other programs";
        return Err(body.refuse("body.mesh", "a mesh of another format", "one in MSH 4.1 (.msh)", help).into());
    }
    if matches!(body.source, BodySource::Matrices(_)) {
        let (found, expected) =
            ("a body of matrices, which no body file holds yet", "a body with a mesh, or a rigid one");
        return Err(body.refuse("body.matrices", found, expected, "give the body a mesh to pack it").into());
    }
    if let (false, BodySource::Meshed(meshed)) = (body.tied, &body.source)
        && !meshed.tied_masses.is_empty()
    {
        let found = "masses beside the body, which the body file in an FMU does not have";
        let help = format!("{}: the FMU of bodies in joints holds their meshes", MeshedBody::WITHOUT_TIED_MASSES);
        return Err(body.refuse("body.tied_masses", found, "`point_masses`, or none", help).into());
    }
    if !matches!(body.modes.flexible, Flexible::Count(_)) {
        let help = "give the number of modes to keep; `flexframe modes` shows their frequencies";
        let found = "\"auto\", which goes by the loads of the scene";
        return Err(body
            .refuse("modes.flexible", found, "a number, since nobody knows the forces from outside", help)
            .into());
    }
    Ok(())
}

/// Writes the scene of bodies that are tied together, its tables and meshes into the resources, and adds their names.
fn pack_whole(scene: &Shared, resources: &Path, names: &mut Vec<String>) -> Result<String, Failure> {
    let folder = scene.path.parent().unwrap_or(Path::new(""));
    let packed = PackedScene::of_system(&scene.text, folder)?;
    let name = "scene.toml".to_owned();
    let place = resources.join(&name);
    std::fs::write(&place, &packed.text).map_err(WriteError::of(&place))?;
    names.push(name.clone());
    for (from, name) in packed.tables {
        std::fs::copy(&from, resources.join(&name)).map_err(unreadable(&from))?;
        names.push(name);
    }
    Ok(name)
}

/// Writes the scene of a body, its tables and its body file into the resources, and adds their names.
fn pack_body(
    (scene, builder): (&Body, &Builder),
    resources: &Path,
    prefix: &str,
    names: &mut Vec<String>,
    progress: &mut impl FnMut(BuildProgress),
) -> Result<PackedBody, Failure> {
    let [scene_name, body_name] = ["scene.toml", "body.h5"].map(|name| format!("{prefix}{name}"));
    let body_file = (!matches!(scene.source, BodySource::Rigid(_))).then_some(body_name);
    let folder = scene.path.parent().unwrap_or(Path::new(""));
    let packed = PackedScene::new(&scene.text_alone, folder, body_file.as_deref(), prefix)?;
    let place = resources.join(&scene_name);
    std::fs::write(&place, &packed.text).map_err(WriteError::of(&place))?;
    names.push(scene_name.clone());
    for (from, name) in packed.tables {
        let to = resources.join(&name);
        std::fs::copy(&from, to).map_err(unreadable(&from))?;
        names.push(name);
    }
    if let Some(body_file) = body_file {
        builder.needing(Needs::external_inputs()).write_body(scene, &resources.join(&body_file), false, progress)?;
        names.push(body_file);
    }
    Ok(PackedBody { name: scene.name.clone(), scene: scene_name })
}

/// The name of a file as a name in C.
fn c_identifier(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match name.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => name,
        _ => format!("fmu_{name}"),
    }
}

fn zipped(
    resources: &Path,
    names: &[String],
    library: &Library,
    identifier: &str,
    description: impl FnOnce() -> io::Result<Vec<u8>>,
) -> io::Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    zip.start_file("modelDescription.xml", options)?;
    zip.write_all(&description()?)?;
    for name in names {
        let path = resources.join(name);
        let is_large = path.metadata()?.len() > u64::from(u32::MAX) / 2;
        zip.start_file(format!("resources/{name}"), options.large_file(is_large))?;
        io::copy(&mut std::fs::File::open(path)?, &mut zip)?;
    }
    let Library { bytes, folder, ending } = library;
    zip.start_file(format!("binaries/{folder}/{identifier}{ending}"), options.unix_permissions(0o755))?;
    zip.write_all(bytes)?;
    Ok(zip.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_becomes_a_name_in_c() {
        for (file, name) in [("out/blade.fmu", "blade"), ("rotor blade-2.fmu", "rotor_blade_2"), ("2.fmu", "fmu_2")] {
            assert_eq!(c_identifier(Path::new(file)), name);
        }
    }
}
