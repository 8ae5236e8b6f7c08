//! The body of a deck: its tetrahedra, names and materials, and a sentence on all that is not used.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use fem_tet10::Material;

use crate::beside::{Beside, DeckMass, DeckTie, Elastic};
use crate::deck_material::DeckMaterial;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::own::abaqus::deck::Deck;
use crate::own::abaqus::deck::referred;
use crate::own::abaqus::kinds::Kind;
use crate::own::abaqus::materials::Material as AbaqusMaterial;
use crate::own::abaqus::space::World;
use crate::own::notes::Left;
use crate::own::systems::size;
use crate::own::tetrahedra::Tetrahedra;
use crate::own::texts::Texts;

const FACES: [&str; 4] = ["S1", "S2", "S3", "S4"];

pub(super) fn imported(
    texts: &Texts<'_>,
    mut deck: Deck,
    source: &Path,
    raise_order: bool,
) -> Result<Imported, ImportError> {
    let mut left = std::mem::take(&mut deck.left);
    let deck = &deck;
    let mut world = World::of(texts, deck)?;
    let refused = |found: String, help: &str| ImportError::Refused {
        source_name: source.display().to_string(),
        found,
        help: help.to_owned(),
    };
    if world.positions.is_empty() {
        return Err(refused("it has no nodes".to_owned(), "check the file"));
    }
    let mut notes = Vec::new();

    // Elements of shells are those of their sections, with a mass for each area.
    let mut shells: HashMap<u32, Option<f64>> = HashMap::new();
    for space in 0..world.spaces.len() {
        for scope in world.spaces[space].scopes.clone() {
            for section in &scope.sections {
                if !section.is_solid
                    && let Some(members) = world.set(texts, false, space, &section.set.to_uppercase())?
                {
                    let density = |name: &str| {
                        let material = deck.materials.iter().find(|known| known.name.eq_ignore_ascii_case(name));
                        material.and_then(AbaqusMaterial::density)
                    };
                    let mass = section.layers.as_ref().and_then(|layers| {
                        layers
                            .iter()
                            .map(|(material, thickness)| Some(density(material)? * thickness))
                            .sum::<Option<f64>>()
                    });
                    shells.extend(members.iter().map(|element| (*element, mass)));
                }
            }
        }
    }
    let mut found = Tetrahedra {
        source: source.display().to_string(),
        node_tags: world.node_labels.clone(),
        positions: world.positions.clone(),
        ..Tetrahedra::default()
    };
    let mut tetrahedron_of: HashMap<u32, u32> = HashMap::new();
    let mut triangle_of: HashMap<u32, [u32; 3]> = HashMap::new();
    let mut solids: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for number in 0..world.elements.len() {
        let (_, element) = world.elements[number];
        let at = number as u32;
        match element.kind {
            Kind::Tetrahedron(_) => {
                tetrahedron_of.insert(at, found.elements.len() as u32);
                found.elements.push(world.nodes_of(texts, number)?);
                found.element_tags.push(element.label);
            }
            Kind::Solid(_) => solids.entry(element.of_type).or_insert((0, number)).0 += 1,
            Kind::Triangle(_) if !shells.contains_key(&at) => {
                let nodes = world.nodes_of(texts, number)?;
                triangle_of.insert(at, [nodes[0], nodes[1], nodes[2]]);
            }
            Kind::Mass => {}
            Kind::Triangle(_) | Kind::Other => {
                let name = &deck.types[element.of_type];
                match shells.get(&at) {
                    Some(of_area) => {
                        left.heavy(name, of_area.zip(area(texts, &world, number)).map(|(mass, area)| mass * area))
                    }
                    None if HEAVY.iter().any(|start| name.starts_with(start)) => left.heavy(name, None),
                    None => left.count(name),
                }
            }
        }
    }
    if let Some((_, first)) = solids.values().next() {
        let each: Vec<String> = solids.iter().map(|(of, (count, _))| format!("{count} {}", deck.types[*of])).collect();
        let found = format!("it has elements that are no tetrahedra: {}", each.join(", "));
        return Err(texts.refuse(
            world.elements[*first].1.place,
            found,
            "mesh with ten-node tetrahedra (C3D10), or give mass and stiffness of any elements in place of the mesh: `matrices` in \
             [body], which CalculiX, Abaqus and others write (docs/reference/matrices.md)",
        ));
    }

    names(texts, &mut world, &mut found, &tetrahedron_of, &triangle_of, &mut notes)?;
    let masses = masses(texts, &mut world, &mut left)?;
    let mut beside = Beside { masses, ..Beside::default() };
    let materials = materials(texts, deck, &mut world, &mut beside, &mut notes)?;
    beside.ties = ties(texts, &mut world)?;
    let count = found.elements.len();
    let (mesh, mut of_mesh) = found.mesh(raise_order)?;
    notes.append(&mut of_mesh);
    if let Some((count, place)) = deck.unknown {
        left.say(format!("{count} keyword(s) that are not known here, the first in {}", texts.named(place)));
    }
    let materials = materials.into_iter().filter(|material| mesh.groups().contains(&material.group)).collect();
    let (ties, without): (Vec<_>, Vec<_>) =
        std::mem::take(&mut beside.ties).into_iter().partition(|tie| tie.is_of(&mesh));
    for DeckTie { kind, group, .. } in without {
        left.count(&format!("{kind} of {}", if group.is_empty() { "other regions" } else { &group }));
    }
    beside.ties = ties;
    notes.extend(left.sentence(count));
    Ok(Imported { mesh, notes, materials, beside })
}

/// Beginnings of the names of elements with a mass that is not known here: beams, trusses, shells, membranes.
const HEAVY: [&str; 10] = ["B2", "B3", "PIPE", "T2D", "T3D", "S4", "S8", "S9", "M3D", "ROTARYI"];

/// The area of a shell with three or four sides.
fn area(texts: &Texts<'_>, world: &World<'_>, element: usize) -> Option<f64> {
    let nodes = world.nodes_of(texts, element).ok()?;
    let corners = match nodes.len() {
        3 | 6 => 3,
        4 | 8 | 9 => 4,
        _ => return None,
    };
    size(&nodes.iter().take(corners).map(|node| world.positions[*node as usize]).collect::<Vec<_>>())
}

/// Groups of elements, surfaces and nodes. A name that several parts or the assembly have is that of the assembly, and has the
/// name of the part before it otherwise.
fn names(
    texts: &Texts<'_>,
    world: &mut World<'_>,
    found: &mut Tetrahedra,
    tetrahedron_of: &HashMap<u32, u32>,
    triangle_of: &HashMap<u32, [u32; 3]>,
    notes: &mut Vec<String>,
) -> Result<(), ImportError> {
    let mut empty = Vec::new();
    let free = std::cell::OnceCell::new();
    for space in 0..world.spaces.len() {
        for scope in world.spaces[space].scopes.clone() {
            let sections: HashSet<String> = scope.sections.iter().map(|section| section.set.to_uppercase()).collect();
            for set in &scope.element_sets.list {
                let key = set.name.to_uppercase();
                if set.internal && !sections.contains(&key) {
                    continue;
                }
                // A set for a support, which CAE writes beside its nodes under the same name, is meant by its nodes.
                if scope.node_sets.number(&key).is_some() && !sections.contains(&key) {
                    continue;
                }
                let Some(members) = world.set(texts, false, space, &key)? else { continue };
                let tetrahedra: Vec<u32> = members.iter().filter_map(|e| tetrahedron_of.get(e)).copied().collect();
                let triangles: Vec<[u32; 3]> = members.iter().filter_map(|e| triangle_of.get(e)).copied().collect();
                let is_alone = members.iter().all(|e| !tetrahedron_of.contains_key(e) && !triangle_of.contains_key(e));
                let name = shown(world, space, &set.name);
                if is_alone {
                    // Sets of what is counted elsewhere need no words of their own.
                    if members.is_empty() {
                        empty.push(name);
                    }
                    continue;
                }
                if !tetrahedra.is_empty() {
                    found.groups.push((name.clone(), tetrahedra));
                }
                if !triangles.is_empty() {
                    found.surfaces.push((name, triangles));
                }
            }
            for surface in &scope.surfaces {
                let name = shown(world, space, &surface.name);
                let (mut nodes, mut triangles, mut lost) = (Vec::new(), Vec::new(), 0);
                for (reference, face, place) in &surface.faces {
                    let mut members = Vec::new();
                    world.referred(texts, surface.of_nodes, space, reference, *place, 0, &mut members)?;
                    if surface.of_nodes {
                        nodes.extend(members);
                        continue;
                    }
                    let number = FACES.iter().position(|known| known == face);
                    let tetrahedra: HashSet<usize> =
                        members.iter().filter_map(|e| tetrahedron_of.get(e)).map(|e| *e as usize).collect();
                    match number {
                        Some(number) => triangles.extend(
                            members
                                .iter()
                                .filter_map(|e| tetrahedron_of.get(e))
                                .map(|e| found.corners(*e as usize, number)),
                        ),
                        None if face.is_empty() => {
                            let free = free.get_or_init(|| found.free_faces());
                            triangles
                                .extend(free.iter().filter(|(e, _)| tetrahedra.contains(e)).map(|(_, face)| *face));
                        }
                        None => triangles.extend(members.iter().filter_map(|e| triangle_of.get(e))),
                    }
                    lost += members.len() - tetrahedra.len().min(members.len());
                }
                if surface.of_nodes {
                    found.node_groups.push((name, nodes));
                } else {
                    if lost > 0 {
                        notes.push(format!("the surface {name} has faces of {lost} elements that are no tetrahedra"));
                    }
                    found.surfaces.push((name, triangles));
                }
            }
            for set in &scope.node_sets.list {
                let key = set.name.to_uppercase();
                // The nodes of a set of elements with a section are those of its group.
                if set.internal || (sections.contains(&key) && scope.element_sets.number(&key).is_some()) {
                    continue;
                }
                let Some(members) = world.set(texts, true, space, &key)? else { continue };
                let name = shown(world, space, &set.name);
                if members.is_empty() {
                    notes.push(format!("the node set {name} has no nodes"));
                } else {
                    found.node_groups.push((name, members.to_vec()));
                }
            }
        }
    }
    if let Some(last) = empty.pop() {
        let others = empty.len();
        notes.push(match others {
            0 => format!("the element set {last} has no tetrahedra and no triangles of six nodes"),
            _ => format!("the element set {last} and {others} more have no tetrahedra and no triangles of six nodes"),
        });
    }
    Ok(())
}

/// The name of a set in the mesh.
fn shown(world: &World<'_>, space: usize, name: &str) -> String {
    let plain = name.replace('"', "'").split_whitespace().collect::<Vec<_>>().join(" ");
    let key = name.to_uppercase();
    let has = |scope: &crate::own::abaqus::scope::Scope| {
        scope.node_sets.number(&key).is_some()
            || scope.element_sets.number(&key).is_some()
            || scope.surfaces.iter().any(|surface| surface.name.eq_ignore_ascii_case(name))
    };
    let others = world.spaces.iter().enumerate().filter(|(other, _)| *other != space);
    let is_taken = others.flat_map(|(_, other)| &other.scopes).any(|scope| has(scope));
    if is_taken && !world.spaces[space].prefix.is_empty() {
        format!("{}.{plain}", world.spaces[space].prefix)
    } else {
        plain
    }
}

/// Regions that move with a reference node.
fn ties(texts: &Texts<'_>, world: &mut World<'_>) -> Result<Vec<DeckTie>, ImportError> {
    let mut found = Vec::new();
    for space in 0..world.spaces.len() {
        for tie in world.spaces[space].scopes.clone().iter().flat_map(|scope| &scope.ties) {
            let mut nodes = Vec::new();
            if !tie.point.is_empty() {
                world.referred(texts, true, space, &referred(&tie.point, None), tie.place, 0, &mut nodes)?;
            }
            let at = nodes.first().map(|node| world.positions[*node as usize]);
            let group = shown(world, space, &tie.region);
            found.push(DeckTie { kind: format!("*{}", tie.keyword), group, is_rigid: tie.is_rigid, at });
        }
    }
    Ok(found)
}

/// Masses on nodes.
fn masses(texts: &Texts<'_>, world: &mut World<'_>, left: &mut Left) -> Result<Vec<DeckMass>, ImportError> {
    let (mut named, mut masses) = (HashSet::new(), Vec::new());
    for space in 0..world.spaces.len() {
        for scope in world.spaces[space].scopes.clone() {
            for mass in &scope.masses {
                let Some(members) = world.set(texts, false, space, &mass.set.to_uppercase())? else { continue };
                for element in members.iter().filter(|e| world.elements[**e as usize].1.kind == Kind::Mass) {
                    named.insert(*element);
                    let at = world.positions[world.nodes_of(texts, *element as usize)?[0] as usize];
                    if mass.mass == 0.0 {
                        continue;
                    }
                    masses.push(DeckMass { kind: "MASS".to_owned(), node: at, at, mass: mass.mass });
                }
            }
        }
    }
    for (number, (_, element)) in world.elements.iter().enumerate() {
        if element.kind == Kind::Mass && !named.contains(&(number as u32)) {
            left.heavy("MASS without a number", None);
        }
    }
    Ok(masses)
}

/// The materials of solid sections.
fn materials(
    texts: &Texts<'_>,
    deck: &Deck,
    world: &mut World<'_>,
    beside: &mut Beside,
    notes: &mut Vec<String>,
) -> Result<Vec<DeckMaterial>, ImportError> {
    let mut found = Vec::new();
    let mut used = HashSet::new();
    for space in 0..world.spaces.len() {
        for section in world.spaces[space].scopes.clone().iter().flat_map(|scope| &scope.sections) {
            used.insert(section.material.to_uppercase());
            used.extend(section.layers.iter().flatten().map(|(material, _)| material.to_uppercase()));
            if !section.is_solid {
                continue;
            }
            let key = section.set.to_uppercase();
            let written = world.spaces[space].scopes.iter().find_map(|scope| {
                scope.element_sets.number(&key).map(|number| scope.element_sets.list[number].name.clone())
            });
            // In a deck without parts a section may name a set of an instance.
            let group = match (&written, section.set.split_once('.')) {
                (None, Some((_, set))) if world.set(texts, false, space, &key)?.is_none() => set.to_owned(),
                (Some(name), _) => shown(world, space, name),
                _ => section.set.clone(),
            };
            let material = deck.materials.iter().find(|known| known.name.eq_ignore_ascii_case(&section.material));
            let numbers = match material {
                Some(material) => material.numbers(),
                None => Err("there is no *MATERIAL of this name".to_owned()),
            };
            match numbers {
                Ok([young_modulus, poisson_ratio, density])
                    if young_modulus > 0.0 && poisson_ratio > -1.0 && poisson_ratio < 0.5 && density > 0.0 =>
                {
                    let name = material.map_or_else(String::new, |material| material.name.clone());
                    let material = Material { young_modulus, poisson_ratio, density };
                    found.push(DeckMaterial { group, name, material });
                }
                Ok([young, poisson, density]) => notes.push(format!(
                    "the material {} of {group} is not read: Young's modulus {young}, Poisson's ratio {poisson}, density {density}",
                    section.material
                )),
                Err(why) => {
                    let elastic = material.and_then(AbaqusMaterial::without_density);
                    match elastic.filter(|[young, poisson]| *young > 0.0 && *poisson > -1.0 && *poisson < 0.5) {
                        Some([young_modulus, poisson_ratio]) => {
                            let name = section.material.clone();
                            notes.push(format!(
                                "the material {name} of {group} has no *DENSITY (its Young's modulus is {young_modulus:?}, its Poisson's \
                                 ratio {poisson_ratio:?})"
                            ));
                            beside.without_density.push(Elastic { group, name, young_modulus, poisson_ratio });
                        }
                        None => notes.push(format!("the material {} of {group} is not read: {why}", section.material)),
                    }
                }
            }
        }
    }
    for material in deck.materials.iter().filter(|material| !used.contains(&material.name.to_uppercase())) {
        notes.push(format!("the material {} is not read: no *SOLID SECTION names it", material.name));
    }
    Ok(found)
}
