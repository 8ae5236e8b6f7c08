//! `flexframe new`: a first scene of a mesh, with comments, to be changed by its user.

use std::collections::{BTreeMap, HashSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use fem_tet10::{AssemblyError, Material, Materials, Mesh, centroid_lumped_inertia};
pub use mesh_import::ImportSettings;
use mesh_import::{Beside, DeckMass, DeckTie, Imported, MeshFile};
use modal::TiedPoint;
use nalgebra::Vector3;
use whole_file::write_whole;

use crate::files::outputs::{Written, outputs_of_mesh};
use crate::files::scene_file::from_root;
use crate::files::write_error::WriteError;
use crate::report::rounded;
use crate::rows::units::UnitLabels;

/// Consistent units, and steel in them.
#[derive(Clone, Copy)]
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
/// Solids for which decks are written: Young's modulus, Pa, density, kg/m³, and speed of sound, m/s.
const SOLIDS: [[f64; 2]; 3] = [[1e6, 1.2e12], [10.0, 2.3e4], [300.0, 1.5e4]];
/// Young's modulus of metals and stiff plastics, Pa, where no density is given.
const STIFF: [f64; 2] = [5e8, 1.2e12];

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

/// Units in which decks are written, by the force that goes with them: N, N, lbf, lbf, dyn, mN.
const SYSTEMS: [System; 6] = [
    METRES,
    MILLIMETRES,
    System {
        length: "in",
        length_in_words: "inches (stress in psi)",
        mass: "lbf s²/in",
        steel: Material { young_modulus: 3.046e7, poisson_ratio: 0.3, density: 7.345e-4 },
        gravity: 386.09,
    },
    System {
        length: "ft",
        length_in_words: "feet",
        mass: "slug",
        steel: Material { young_modulus: 4.386e9, poisson_ratio: 0.3, density: 15.23 },
        gravity: 32.174,
    },
    System {
        length: "cm",
        length_in_words: "centimetres, with grams",
        mass: "g",
        steel: Material { young_modulus: 2.1e12, poisson_ratio: 0.3, density: 7.85 },
        gravity: 981.0,
    },
    System {
        length: "mm",
        length_in_words: "millimetres, with kilograms",
        mass: "kg",
        steel: Material { young_modulus: 2.1e8, poisson_ratio: 0.3, density: 7.85e-6 },
        gravity: 9810.0,
    },
];

impl System {
    fn labels(&self) -> UnitLabels<'static> {
        UnitLabels { length: self.length, mass: self.mass, time: "s" }
    }

    /// True if a material with these numbers is a solid in these units.
    fn fits(&self, young_modulus: f64, density: f64) -> bool {
        let in_si = |value: f64, powers| self.labels().in_si(powers).map_or(f64::NAN, |factor| value * factor);
        let (young, density) = (in_si(young_modulus, [-1, 1, -2]), in_si(density, [-3, 1, 0]));
        let found = [young, density, (young / density).sqrt()];
        SOLIDS.iter().zip(found).all(|([least, most], value)| (*least..=*most).contains(&value))
    }
}

/// The units of a mesh, and how they were guessed.
fn system_of(mesh: &Mesh, given: Option<&GivenMaterials>, beside: &Beside) -> (System, String) {
    let longest = mesh.size().into_iter().fold(0.0, f64::max);
    let by_size = if longest > LONGEST_IN_METRES { MILLIMETRES } else { METRES };
    let materials = || given.iter().flat_map(|given| given.materials.values());
    let like = |of: &str, system: System| (system, format!("{of} like {}", system.length_in_words));
    if materials().next().is_some() {
        let fits = |system: &&System| materials().all(|material| system.fits(material.young_modulus, material.density));
        return match SYSTEMS.iter().find(fits) {
            Some(system) => like("the materials of its file look", *system),
            None => (
                by_size,
                format!(
                    "Young's modulus and density of its file fit no set of units that is known here (a density by weight, such as \
                     lb/in³, is to be divided by gravity); its size looks like {}",
                    by_size.length_in_words
                ),
            ),
        };
    }
    let moduli = || beside.without_density.iter().map(|elastic| elastic.young_modulus);
    let is_stiff = |system: &&System| {
        let factor = system.labels().in_si([-1, 1, -2]).unwrap_or(f64::NAN);
        moduli().all(|young| (STIFF[0]..=STIFF[1]).contains(&(young * factor)))
    };
    match SYSTEMS[..3].iter().find(is_stiff).filter(|_| moduli().next().is_some()) {
        Some(system) => like("Young's modulus of its file looks", *system),
        None => like("its size looks", by_size),
    }
}

/// Reads a mesh and writes a scene of it, which can be run as it is: a body of steel, free in space, that spins and gets a
/// push. Groups, size and mass are read off the mesh. Returns the path of the scene (`scene`, or that of the mesh with
/// `.toml`), and what of the mesh was left out or should be known of it.
///
/// # Errors
/// [`Failure`].
pub fn new_scene(
    mesh: &Path,
    settings: &ImportSettings,
    scene: Option<&Path>,
    overwrite: bool,
) -> Result<(PathBuf, Vec<String>), Failure> {
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
/// [`Failure`].
pub fn scene_text(mesh: &Path, settings: &ImportSettings) -> Result<(String, Vec<String>), Failure> {
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
    let (system, guess) = system_of(mesh, given.as_ref(), &read.beside);
    let System { length, mass: mass_unit, steel, gravity, .. } = system;
    let units = system.labels();
    let without_density = match given {
        Some(_) => None,
        None => elastic_materials(mesh, &read.beside, &steel),
    };
    let own = given.as_ref().or(without_density.as_ref());
    let materials = own.map_or(Materials::Uniform(steel), GivenMaterials::all);
    let mass = centroid_lumped_inertia(mesh, &materials, &[])?.mass;
    let end = mesh.positions().iter().max_by(|a, b| a[longest].total_cmp(&b[longest])).copied().unwrap_or_default();
    let mut across = [0.0; 3];
    across[thinnest] = 1.0;
    let title = mesh_path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let parts = mesh.parts();
    let groups: Vec<String> = mesh.groups().iter().map(|name| quoted(name)).collect();
    let faces: Vec<String> = parts.surfaces.iter().map(|surface| quoted(&surface.name)).collect();
    let material = match own {
        Some(own) => format!(
            "# As the mesh file has it: {}.{}\n",
            own.names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", "),
            if given.is_some() {
                ""
            } else {
                " It gives no density: these are densities of steel, or of aluminium where the modulus is."
            }
        ),
        None => "# Steel.\n".to_owned(),
    } + &match &materials {
        Materials::Uniform(material) => format!("material = {}\n", inline(material)),
        Materials::ByGroup(of_groups) => {
            let each = of_groups.iter().map(|(group, material)| format!("{} = {}\n", quoted(group), inline(material)));
            format!("[body.materials]\n{}", each.collect::<String>())
        }
    };

    let (masses, carriers) = masses(mesh, &read.beside, &mut read.notes);
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write!(
        text,
        r#"# A first scene of a mesh of {nodes} nodes and {elements} elements. It runs as it is:
#     flexframe run THIS_FILE
# Every key is described in docs/reference/scene.md; `flexframe advise` says which effects the scene calls for.
title = {title}
# A mesh has no units; {guess}. Nothing is converted: these are labels, and all numbers
# of the scene are in these units (forces in {force}, stresses in {stress}).
units = {{ length = "{length}", mass = "{mass_unit}", time = "s" }}

# {dx} x {dy} x {dz} {length}. Its mass, of this material, is {mass} {mass_unit}.
[body]
mesh = {mesh_path}
{import}{masses}{material}"#,
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
    let is_tie = |name: &str| read.beside.ties.iter().any(|tie| tie.group == name);
    // Decks often have a set of all nodes.
    let some = 3..mesh.positions().len();
    let node_set = parts.node_groups.iter().find(|group| some.contains(&group.nodes.len()) && !is_tie(&group.name));
    let region = match faces.first().cloned().or(node_set.map(|group| quoted(&group.name))) {
        Some(group) => format!("group = {group}"),
        None => format!("at = {end:?}\n# radius = {}", short(0.05 * size[longest])),
    };
    let _ = writeln!(
        text,
        "\n# What holds the body; without it the body is free. (A clamped one cannot spin: remove [initial] below.)"
    );
    if !faces.is_empty() {
        let _ = writeln!(text, "# Surfaces of the mesh: {}.", faces.join(", "));
    }
    if !parts.node_groups.is_empty() {
        let names: Vec<String> = parts.node_groups.iter().map(|group| quoted(&group.name)).collect();
        let _ = writeln!(text, "# Node sets of the mesh: {}.", names.join(", "));
    }
    let _ = write!(
        text,
        r#"# [[constraints]]
# kind = "clamp"
# {region}
{markers}
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
        markers = markers(mesh, &read.beside, &carriers, &mut read.notes),
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
    let Imported { mesh, notes, materials: of_file, .. } = read;
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

/// Young's moduli and Poisson's ratios that a mesh file gives to all elements, with a density of our own.
fn elastic_materials(mesh: &Mesh, beside: &Beside, steel: &Material) -> Option<GivenMaterials> {
    let all = &beside.without_density;
    let material = |young_modulus: f64, poisson_ratio| {
        let is_aluminium = (ALUMINIUM[0]..=ALUMINIUM[1]).contains(&(young_modulus / steel.young_modulus));
        let density = steel.density * if is_aluminium { LIGHTER } else { 1.0 };
        Material { young_modulus, poisson_ratio, density }
    };
    let materials: BTreeMap<_, _> = all
        .iter()
        .map(|elastic| (elastic.group.clone(), material(elastic.young_modulus, elastic.poisson_ratio)))
        .collect();
    let mut names: Vec<String> = all.iter().map(|elastic| elastic.name.clone()).collect();
    names.sort();
    names.dedup();
    let is_of_all = !names.is_empty() && Materials::ByGroup(materials.clone()).of_elements(mesh).is_ok();
    is_of_all.then_some(GivenMaterials { materials, names })
}

/// Young's modulus of aluminium and its density, those of steel being 1.
const ALUMINIUM: [f64; 2] = [0.3, 0.37];
const LIGHTER: f64 = 2700.0 / 7850.0;

/// The masses of a mesh file as lines of `[body]`: those of a tie move with its nodes, others sit on the body. A note tells of those that
/// nothing carries. Returns the groups of these ties, too.
fn masses(mesh: &Mesh, beside: &Beside, notes: &mut Vec<String>) -> (String, HashSet<String>) {
    let (mut on_body, mut tied, mut count) = (String::new(), String::new(), 0);
    let (mut is_left, mut carriers) = (Vec::new(), HashSet::new());
    for DeckMass { node, at, mass, .. } in &beside.masses {
        let carries = |tie: &&DeckTie| {
            let nodes = mesh.group_nodes(&tie.group).unwrap_or_default();
            (1..=MAX_CARRIERS).contains(&nodes.len()) && TiedPoint::new(*mass, *at, nodes, mesh.positions()).is_some()
        };
        let mut ties = beside.ties.iter().filter(|tie| tie.at == Some(*node));
        let carrier = ties.find(carries);
        if *mass <= 0.0 || count == MAX_MASSES || carrier.is_none() && mesh.locate(*at).is_err() {
            is_left.push((*at, *mass));
            continue;
        }
        count += 1;
        // Writing to a string does not fail.
        let _ = match carrier {
            Some(tie) => {
                carriers.insert(tie.group.clone());
                writeln!(tied, "    {{ at = {at:?}, mass = {mass:?}, group = {} }},", quoted(&tie.group))
            }
            None => writeln!(on_body, "    {{ at = {at:?}, mass = {mass:?} }},"),
        };
    }
    notes.extend(beside.unused_masses(|mass| !is_left.contains(&(mass.at, mass.mass))));
    let lists = [("point_masses", on_body, ""), ("tied_masses", tied, ", on the ties that carry them")];
    let list = |(key, lines, where_): &(&str, String, &str)| {
        format!("# Masses of the mesh file{where_}.\n{key} = [\n{lines}]\n")
    };
    (lists.iter().filter(|(_, lines, _)| !lines.is_empty()).map(list).collect(), carriers)
}

/// Masses of a scene, and nodes that carry one.
const MAX_MASSES: usize = 1000;
const MAX_CARRIERS: usize = 500;

/// The ties of a mesh file as markers. Rigid ones are active, since the body is stiffer with them; means change nothing until a joint or a
/// spring holds them, and are comments. A note tells of rigid ones that a marker cannot be, and of means that carry no mass.
fn markers(mesh: &Mesh, beside: &Beside, carriers: &HashSet<String>, notes: &mut Vec<String>) -> String {
    let mut text = String::new();
    let (mut taken, mut active) = (HashSet::new(), HashSet::new());
    for DeckTie { kind, group, is_rigid, .. } in &beside.ties {
        let nodes = mesh.group_nodes(group).unwrap_or_default();
        let is_active = *is_rigid
            && active.len() < MAX_RIGID
            && nodes.len() <= MAX_RIGID_NODES
            && are_wide(mesh, &nodes)
            && nodes.iter().all(|node| !taken.contains(node))
            && active.insert(group);
        let (mark, tie) = (if is_active { "" } else { "# " }, if *is_rigid { "rigid" } else { "mean" });
        if is_active {
            taken.extend(nodes);
        }
        // Names of markers have neither points nor slashes.
        let name = quoted(&group.replace(['.', '/'], "_"));
        let group = quoted(group);
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "\n# {kind} of the mesh file: a marker, which joints, springs and bushings may hold, too (docs/reference/systems.md).\n\
             {mark}[body.markers.{name}]\n{mark}group = {group}\n{mark}tie = \"{tie}\"\n"
        );
    }
    notes.extend(
        beside.unused_ties(|tie| active.contains(&tie.group) || !tie.is_rigid && carriers.contains(&tie.group)),
    );
    text
}

/// Markers with rigid nodes that a scene gets by itself, and nodes of one at most.
const MAX_RIGID: usize = 10;
const MAX_RIGID_NODES: usize = 100;

/// True if the nodes are not all on a line.
fn are_wide(mesh: &Mesh, nodes: &[u32]) -> bool {
    let at = |node: &u32| Vector3::from(mesh.positions()[*node as usize]);
    let [first, rest @ ..] = nodes else { return false };
    let arms = || rest.iter().map(|node| at(node) - at(first));
    let longest = arms().max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).unwrap_or_default();
    let square = longest.norm_squared();
    arms().any(|arm| arm.norm_squared() * square - arm.dot(&longest).powi(2) > 1e-6 * square * square)
}

/// A material as a table on one line.
fn inline(material: &Material) -> String {
    let Material { young_modulus, poisson_ratio, density } = material;
    format!("{{ young_modulus = {young_modulus:?}, poisson_ratio = {poisson_ratio:?}, density = {density:?} }}")
}

/// The keys of how a mesh is read, a line each.
fn import_keys(settings: &ImportSettings) -> String {
    let ImportSettings { mesh_size, raise_order, .. } = settings;
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
