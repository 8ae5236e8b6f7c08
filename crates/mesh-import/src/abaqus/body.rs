//! The body of a deck: its tetrahedra, names and materials, and a sentence on all that is not used.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use fem_tet10::Material;

use crate::abaqus::deck::Deck;
use crate::abaqus::deck::referred;
use crate::abaqus::kinds::Kind;
use crate::abaqus::materials::Material as AbaqusMaterial;
use crate::abaqus::space::World;
use crate::beside::{Beside, DeckMass, DeckTie, Elastic};
use crate::deck_material::DeckMaterial;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::notes;
use crate::tetrahedra::Tetrahedra;
use crate::texts::Texts;

const FACES: [&str; 4] = ["S1", "S2", "S3", "S4"];

pub(super) fn imported(
    texts: &Texts<'_>,
    deck: &Deck,
    source: &Path,
    raise_order: bool,
) -> Result<Imported, ImportError> {
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
    let mut unused = deck.unused.clone();

    // Elements of shells are those of their sections.
    let mut shells: HashSet<u32> = HashSet::new();
    for space in 0..world.spaces.len() {
        for scope in world.spaces[space].scopes.clone() {
            for section in &scope.sections {
                if !section.is_solid
                    && let Some(members) = world.set(texts, false, space, &section.set.to_uppercase())?
                {
                    shells.extend(members.iter());
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
            Kind::Triangle(_) if !shells.contains(&at) => {
                let nodes = world.nodes_of(texts, number)?;
                triangle_of.insert(at, [nodes[0], nodes[1], nodes[2]]);
            }
            Kind::Mass => {}
            Kind::Triangle(_) | Kind::Other => *unused.entry(deck.types[element.of_type].clone()).or_insert(0) += 1,
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
    let masses = masses(texts, deck, &mut world, &mut unused)?;
    let mut beside = Beside { masses, ..Beside::default() };
    let materials = materials(texts, deck, &mut world, &mut beside, &mut notes)?;
    beside.ties = ties(texts, &mut world)?;
    for scope in world.spaces.iter().flat_map(|space| &space.scopes) {
        for tie in &scope.ties {
            let of = if tie.region.is_empty() { &tie.name } else { &tie.region };
            let kind = if tie.is_rigid { "rigid" } else { "mean" };
            let key = format!("*{} of {of} (in a scene: a marker with tie = \"{kind}\")", tie.keyword);
            *unused.entry(key).or_insert(0) += 1;
        }
    }
    let count = found.elements.len();
    let (mesh, mut of_mesh) = found.mesh(raise_order)?;
    notes.append(&mut of_mesh);
    let mut left: Vec<String> = unused.into_iter().map(|(name, count)| format!("{count} {name}")).collect();
    if let Some((count, place)) = deck.unknown {
        left.push(format!("{count} keyword(s) that are not known here, the first in {}", texts.named(place)));
    }
    notes.extend(notes::not_used(count, &left));
    let materials = materials.into_iter().filter(|material| mesh.groups().contains(&material.group)).collect();
    beside.ties.retain(|tie| {
        mesh.surface_groups().any(|surface| surface == tie.group)
            || mesh.parts().node_groups.iter().any(|group| group.name == tie.group)
    });
    Ok(Imported { mesh, notes, materials, beside })
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
    let has = |scope: &crate::abaqus::scope::Scope| {
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
fn masses(
    texts: &Texts<'_>,
    deck: &Deck,
    world: &mut World<'_>,
    unused: &mut BTreeMap<String, usize>,
) -> Result<Vec<DeckMass>, ImportError> {
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
                    masses.push(DeckMass { kind: "MASS".to_owned(), at, mass: mass.mass });
                }
            }
        }
    }
    let all = world.elements.iter().filter(|(_, element)| element.kind == Kind::Mass).count();
    if all > named.len() {
        let name = deck.types.iter().find(|name| *name == "MASS").map_or("MASS", String::as_str);
        *unused.entry(format!("{name} without a number")).or_insert(0) += all - named.len();
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
