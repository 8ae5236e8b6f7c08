//! Materials, masses and ties of a mesh file that are others than those of the scene.

use fem_tet10::{Material, Materials, Mesh};
use mesh_import::{Beside, DeckMass, DeckMaterial, DeckTie};
use scene::{Marker, MarkerPlace, MeshedBody, Region, Tie};

/// Numbers that are apart by less, relative to the larger, are the same, written with fewer digits.
const APART: f64 = 0.01;
/// Places that are apart by less of the size of the mesh are the same.
const ON: f64 = 1e-6;

/// Says which materials of a mesh file are not those that the scene gives to the same elements.
pub(crate) fn other_materials(mesh: &Mesh, of_file: &[DeckMaterial], of_scene: &Materials) -> Vec<String> {
    // What the scene's materials lack is refused elsewhere.
    let of_elements = if of_file.is_empty() { None } else { of_scene.of_elements(mesh).ok() };
    let Some(of_elements) = of_elements else { return Vec::new() };
    let other = |deck: &DeckMaterial| {
        let group = mesh.groups().iter().position(|name| *name == deck.group)?;
        let members = of_elements.iter().enumerate().filter(|(e, _)| mesh.element_groups(*e).contains(&group));
        let used = members.map(|(_, material)| material).find(|material| are_apart(material, &deck.material))?;
        Some(format!(
            "the mesh file gives {} the material {} ({}); the scene has {}, which is used",
            deck.group,
            deck.name,
            numbers(&deck.material),
            numbers(used)
        ))
    };
    of_file.iter().filter_map(other).collect()
}

/// Says which masses of a mesh file the scene has not.
pub(crate) fn other_masses(mesh: &Mesh, of_file: &Beside, of_scene: &MeshedBody) -> Option<String> {
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() <= ON * mesh.diagonal());
    // Several masses of the file at one place are one of the scene.
    let at_place =
        |at: [f64; 3]| of_file.masses.iter().filter(|mass| near(mass.at, at)).map(|mass| mass.mass).sum::<f64>();
    let is_used = |deck: &DeckMass| {
        let on_body = of_scene.point_masses.iter().map(|mass| (mass.at, mass.mass));
        let beside_it = of_scene.tied_masses.iter().map(|mass| (mass.at, mass.mass));
        let of_scene: f64 = on_body.chain(beside_it).filter(|(at, _)| near(*at, deck.at)).map(|(_, mass)| mass).sum();
        let of_deck = at_place(deck.at);
        (of_scene - of_deck).abs() <= APART * of_deck.abs().max(of_scene.abs())
    };
    of_file.unused_masses(is_used)
}

/// Says which ties of a mesh file no marker of the scene is.
pub(crate) fn other_ties(of_file: &Beside, markers: &[Marker], of_scene: &MeshedBody) -> Option<String> {
    let is_used = |deck: &DeckTie| {
        // The mean of nodes changes nothing but what it carries.
        let carries = !deck.is_rigid && of_scene.tied_masses.iter().any(|mass| mass.group == deck.group);
        carries
            || markers.iter().any(|marker| {
                let is_there =
                    matches!(&marker.place, MarkerPlace::Region(Region::Group(group)) if *group == deck.group);
                is_there && (marker.tie == Tie::Rigid) == deck.is_rigid
            })
    };
    of_file.unused_ties(is_used)
}

fn are_apart(a: &Material, b: &Material) -> bool {
    [(a.young_modulus, b.young_modulus), (a.poisson_ratio, b.poisson_ratio), (a.density, b.density)]
        .into_iter()
        .any(|(a, b)| (a - b).abs() > APART * a.abs().max(b.abs()))
}

fn numbers(material: &Material) -> String {
    let Material { young_modulus, poisson_ratio, density } = material;
    format!("young_modulus = {young_modulus:?}, poisson_ratio = {poisson_ratio:?}, density = {density:?}")
}
