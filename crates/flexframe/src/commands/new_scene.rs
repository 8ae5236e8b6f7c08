//! `flexframe new`: a first scene of a mesh, with comments, to be changed by its user.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use fem_tet10::{AssemblyError, Material, Materials, centroid_lumped_inertia};
pub use mesh_import::ImportSettings;
use mesh_import::{ImportError, Imported, MeshFile};
use whole_file::write_whole;

use crate::files::outputs::{OutputError, Written, outputs_of_mesh};
use crate::files::scene_file::from_root;
use crate::files::write_error::WriteError;
use crate::report::rounded;
use crate::rows::units::UnitLabels;

/// A scene that could not be made of a mesh.
#[derive(Debug, thiserror::Error)]
pub enum NewSceneError {
    /// The mesh cannot be read.
    #[error("{0}")]
    Mesh(#[from] ImportError),
    /// The mesh has no mass properties.
    #[error("{0}")]
    Assembly(#[from] AssemblyError),
    /// A file with the name of the scene is there.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// The scene cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// Consistent units, and steel in them.
struct System {
    length: &'static str,
    length_in_words: &'static str,
    mass: &'static str,
    steel: Material,
    /// Standard gravity.
    gravity: f64,
}

/// A mesh has no units. A body of more than this is taken to be in millimetres, a smaller one in metres.
const LONGEST_IN_METRES: f64 = 8.0;
/// A solid of less than this, kg/m³, is none: its density is in Mg/mm³.
const LIGHTEST_IN_METRES: f64 = 1e-3;

const METRES: System = System {
    length: "m",
    length_in_words: "metres",
    mass: "kg",
    steel: Material { young_modulus: 210e9, poisson_ratio: 0.3, density: 7850.0 },
    gravity: 9.81,
};

const MILLIMETRES: System = System {
    length: "mm",
    length_in_words: "millimetres",
    mass: "Mg",
    steel: Material { young_modulus: 210e3, poisson_ratio: 0.3, density: 7.85e-9 },
    gravity: 9810.0,
};

/// Reads a mesh and writes a scene of it, which can be run as it is: a body of steel, free in space, that spins and gets a
/// push. Groups, size and mass are read off the mesh. Returns the path of the scene (`scene`, or that of the mesh with
/// `.toml`), and what of the mesh was left out or should be known of it.
///
/// # Errors
/// [`NewSceneError`].
pub fn new_scene(
    mesh: &Path,
    settings: &ImportSettings,
    scene: Option<&Path>,
    overwrite: bool,
) -> Result<(PathBuf, Vec<String>), NewSceneError> {
    // Before a file is refused that has the name of the scene.
    let file = MeshFile::read(mesh, settings)?;
    let path = scene.map_or_else(|| mesh.with_extension("toml"), Path::to_owned);
    outputs_of_mesh(mesh, overwrite).claim_as(&Written::SCENE, &path)?;
    let mut read = file.mesh()?;
    read.notes.extend(file.remark());
    let text = text(&mut read, settings, &from_folder_of(&path, mesh))?;
    write_whole(&path, text).map_err(WriteError::of(&path))?;
    Ok((path, read.notes))
}

/// The same scene as a text, for whoever reads it from standard input in this folder; and what of the mesh was left out.
///
/// # Errors
/// [`NewSceneError`].
pub fn scene_text(mesh: &Path, settings: &ImportSettings) -> Result<(String, Vec<String>), NewSceneError> {
    let mut read = MeshFile::read(mesh, settings)?.mesh()?;
    let text = text(&mut read, settings, &from_folder_of(Path::new("stdin"), mesh))?;
    Ok((text, read.notes))
}

/// How the scene names the mesh: relative to its folder where the mesh is in it, from the root otherwise.
fn from_folder_of(scene: &Path, mesh: &Path) -> PathBuf {
    let [scene_at, mesh_at] = [scene, mesh].map(from_root);
    match scene_at.parent().and_then(|folder| mesh_at.strip_prefix(folder).ok()) {
        Some(relative) => relative.to_owned(),
        None => mesh_at,
    }
}

/// The text of the scene; what should be known of its materials is added to the notes.
fn text(read: &mut Imported, settings: &ImportSettings, mesh_path: &Path) -> Result<String, AssemblyError> {
    let given = given_materials(read);
    let mesh = &read.mesh;
    let size = mesh.size();
    let longest = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
    let thinnest = (0..3).min_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(2);
    let heaviest = given.iter().flat_map(|given| given.materials.values()).map(|material| material.density);
    let (is_in_millimetres, guessed_by) = match heaviest.reduce(f64::max) {
        Some(density) => (density < LIGHTEST_IN_METRES, "the densities of its file look"),
        None => (size[longest] > LONGEST_IN_METRES, "its size looks"),
    };
    let system = if is_in_millimetres { MILLIMETRES } else { METRES };
    let System { length, length_in_words, mass: mass_unit, steel, gravity } = system;
    let units = UnitLabels { length, mass: mass_unit, time: "s" };
    let materials = given.as_ref().map_or(Materials::Uniform(steel), GivenMaterials::all);
    let mass = centroid_lumped_inertia(mesh, &materials, &[])?.mass;
    let end = mesh.positions().iter().max_by(|a, b| a[longest].total_cmp(&b[longest])).copied().unwrap_or_default();
    let mut across = [0.0; 3];
    across[thinnest] = 1.0;
    let title = mesh_path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let parts = mesh.parts();
    let groups: Vec<String> = mesh.groups().iter().map(|name| quoted(name)).collect();
    let faces: Vec<String> = parts.surfaces.iter().map(|surface| quoted(&surface.name)).collect();
    let material = match &given {
        Some(given) => format!(
            "# As the mesh file has it: {}.\n",
            given.names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ")
        ),
        None => "# Steel.\n".to_owned(),
    } + &match &materials {
        Materials::Uniform(material) => format!("material = {}\n", inline(material)),
        Materials::ByGroup(of_groups) => {
            let each = of_groups.iter().map(|(group, material)| format!("{} = {}\n", quoted(group), inline(material)));
            format!("[body.materials]\n{}", each.collect::<String>())
        }
    };

    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write!(
        text,
        r#"# A first scene of a mesh of {nodes} nodes and {elements} elements. It runs as it is:
#     flexframe run THIS_FILE
# Every key is described in docs/reference/scene.md; `flexframe advise` says which effects the scene calls for.
title = {title}
# A mesh has no units; {guessed_by} like {length_in_words}. Nothing is converted: these are labels, and all numbers
# of the scene are in these units (forces in {force}, stresses in {stress}).
units = {{ length = "{length}", mass = "{mass_unit}", time = "s" }}

# {dx} x {dy} x {dz} {length}. Its mass, of this material, is {mass} {mass_unit}.
[body]
mesh = {mesh_path}
{import}{material}"#,
        force = units.force(),
        stress = units.stress(),
        nodes = mesh.positions().len(),
        elements = mesh.elements().len(),
        title = quoted(&title),
        dx = short(size[0]),
        dy = short(size[1]),
        dz = short(size[2]),
        mass = short(mass),
        import = import_keys(settings),
        mesh_path = quoted(&mesh_path.to_string_lossy()),
    );
    if !groups.is_empty() && matches!(materials, Materials::Uniform(_)) {
        let each: Vec<String> = groups.iter().map(|group| format!("{group} = {{ … }}")).collect();
        let _ = writeln!(text, "# Or a material for each group of the mesh: materials = {{ {} }}", each.join(", "));
    }
    let _ = write!(
        text,
        r"
[modes]
flexible = 10
damping_ratio = 0.01
"
    );
    let region = match faces.first() {
        Some(face) => format!("group = {face}"),
        None => format!("at = {end:?}\n# radius = {}", short(0.05 * size[longest])),
    };
    let _ = writeln!(
        text,
        "\n# What holds the body; without it the body is free. (A clamped one cannot spin: remove [initial] below.)"
    );
    if !faces.is_empty() {
        let _ = writeln!(text, "# Surfaces of the mesh: {}.", faces.join(", "));
    }
    let _ = write!(
        text,
        r#"# [[constraints]]
# kind = "clamp"
# {region}

# It spins, about one turn a second.
[initial]
angular_velocity = {spin:?}

# A push at one end: half the weight of the body, for a hundredth of a second.
[[loads]]
kind = "force"
at = {end:?}
direction = {across:?}
amplitude = {amplitude}
history = {{ kind = "half-sine", duration = 0.01 }}

[time]
end = 1.0
tolerance = 1e-4

# The motion of these points is written out.
[output.points]
end = {end:?}
"#,
        amplitude = short(0.5 * mass * gravity),
        spin = across.map(|axis| 6.3 * axis),
    );
    Ok(text)
}

/// The materials that a mesh file gives to all elements.
struct GivenMaterials {
    /// By group.
    materials: BTreeMap<String, Material>,
    /// Names in the file.
    names: Vec<String>,
}

impl GivenMaterials {
    /// One for the whole body where they are the same.
    fn all(&self) -> Materials {
        let mut materials = self.materials.values();
        match materials.next() {
            Some(first) if materials.all(|other| other == first) => Materials::Uniform(*first),
            _ => Materials::ByGroup(self.materials.clone()),
        }
    }
}

/// The materials of a mesh file, if they are those of all elements; a note says it where they are not.
fn given_materials(read: &mut Imported) -> Option<GivenMaterials> {
    let Imported { mesh, notes, materials: of_file } = read;
    let materials = of_file.iter().map(|deck| (deck.group.clone(), deck.material)).collect();
    let mut names: Vec<String> = of_file.iter().map(|deck| deck.name.clone()).collect();
    names.sort();
    names.dedup();
    if names.is_empty() {
        return None;
    }
    if let Err(error) = Materials::ByGroup(BTreeMap::clone(&materials)).of_elements(mesh) {
        notes.push(format!("the materials {} of the mesh file are not used, but steel: {error}", names.join(", ")));
        return None;
    }
    Some(GivenMaterials { materials, names })
}

/// A material as a table on one line.
fn inline(material: &Material) -> String {
    let Material { young_modulus, poisson_ratio, density } = material;
    format!("{{ young_modulus = {young_modulus:?}, poisson_ratio = {poisson_ratio:?}, density = {density:?} }}")
}

/// The keys of how a mesh is read, a line each.
fn import_keys(settings: &ImportSettings) -> String {
    let ImportSettings { mesh_size, raise_order, trust_geometry: _ } = settings;
    let size = mesh_size.map(|size| format!("mesh_size = {size:?}\n"));
    let raise = raise_order.then(|| "raise_order = true\n".to_owned());
    size.into_iter().chain(raise).collect()
}

/// A text as TOML has it, on one line, so that it may stand in a comment, too.
fn quoted(text: &str) -> String {
    let mut quoted = "\"".to_owned();
    for letter in text.chars() {
        // Writing to a string does not fail.
        let _ = match letter {
            '"' | '\\' => write!(quoted, "\\{letter}"),
            _ if letter.is_control() => write!(quoted, "\\u{:04x}", u32::from(letter)),
            _ => write!(quoted, "{letter}"),
        };
    }
    quoted + "\""
}

/// A number with three digits, as TOML has it.
fn short(value: f64) -> String {
    format!("{:?}", rounded(value, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quoted_text_is_one_line_and_read_back_as_it_was() {
        for text in ["plain", "it's \"quoted\"", "a\nb = 1", "\r\t\u{7f}\u{85}\\n", "é"] {
            let quoted = quoted(text);
            assert_eq!(quoted.lines().count(), 1, "{quoted}");
            let read: toml::Table = toml::from_str(&format!("# {quoted}\na = {quoted}\n")).unwrap();
            assert_eq!(read.get("a").and_then(toml::Value::as_str), Some(text));
        }
    }
}
