//! Materials of a mesh file that are others than those of the scene.

use fem_tet10::{Material, Materials, Mesh};
use mesh_import::DeckMaterial;

/// Numbers that are apart by less, relative to the larger, are the same, written with fewer digits.
const APART: f64 = 0.01;

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

fn are_apart(a: &Material, b: &Material) -> bool {
    [(a.young_modulus, b.young_modulus), (a.poisson_ratio, b.poisson_ratio), (a.density, b.density)]
        .into_iter()
        .any(|(a, b)| (a - b).abs() > APART * a.abs().max(b.abs()))
}

fn numbers(material: &Material) -> String {
    let Material { young_modulus, poisson_ratio, density } = material;
    format!("young_modulus = {young_modulus:?}, poisson_ratio = {poisson_ratio:?}, density = {density:?}")
}
