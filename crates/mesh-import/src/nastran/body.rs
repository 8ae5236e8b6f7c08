//! The body of a deck: its tetrahedra, names and materials, and a sentence on all that is not used.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use fem_tet10::Material;

use crate::beside::{Beside, DeckMass, DeckTie, Elastic};
use crate::deck_material::DeckMaterial;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::nastran::cards::{Bulk, Card};
use crate::nastran::kinds::{SHELLS, SOLIDS, is_silent, known};
use crate::nastran::systems::Space;
use crate::notes;
use crate::tetrahedra::{MISSING, Tetrahedra};
use crate::texts::{Place, Texts};

/// Names of groups of elements; more are none that anybody reads.
const MAX_GROUPS: usize = 1000;

/// Cards of a deck, as they are read.
#[derive(Default)]
struct Deck {
    space: Space,
    tetrahedra: Vec<Element>,
    triangles: Vec<Element>,
    solids: BTreeMap<String, (usize, Place)>,
    shells: HashSet<u64>,
    /// Material of each PSOLID.
    properties: BTreeMap<u64, u64>,
    /// Young's modulus, shear modulus, Poisson's ratio, density and damping.
    isotropic: HashMap<u64, [Option<f64>; 5]>,
    /// Kinds of materials that are not read.
    others: HashMap<u64, String>,
    masses: Vec<Mass>,
    ties: Vec<Tie>,
    mass_of_weight: f64,
    unused: BTreeMap<String, usize>,
    unknown: Option<(usize, Place)>,
}

struct Element {
    place: Place,
    label: u64,
    property: u64,
    nodes: Vec<u64>,
}

/// An RBE2 or RBE3: nodes that move with another.
struct Tie {
    place: Place,
    kind: &'static str,
    label: u64,
    point: u64,
    nodes: Vec<u64>,
}

/// A CONM2.
struct Mass {
    place: Place,
    node: u64,
    /// None where the offset is a position.
    system: Option<u64>,
    mass: f64,
    offset: [f64; 3],
    has_inertia: bool,
}

pub(super) fn imported(
    texts: &Texts<'_>,
    bulk: &Bulk<'_>,
    source: &Path,
    raise_order: bool,
) -> Result<Imported, ImportError> {
    let mut deck = Deck { mass_of_weight: 1.0, ..Deck::default() };
    for card in &bulk.cards {
        deck.take(texts, card)?;
    }
    if let Some((_, first)) = deck.solids.values().next() {
        let each: Vec<String> = deck.solids.iter().map(|(name, (count, _))| format!("{count} {name}")).collect();
        let found = format!("it has elements that are no tetrahedra: {}", each.join(", "));
        return Err(texts.refuse(
            *first,
            found,
            "mesh with ten-node tetrahedra (CTETRA), or give mass and stiffness of any elements in place of the mesh: `matrices` in \
             [body], which other programs write (docs/reference/matrices.md)",
        ));
    }
    let positions = deck.space.positions(texts)?;
    if positions.is_empty() {
        return Err(ImportError::Refused {
            source_name: source.display().to_string(),
            found: "it has no nodes".to_owned(),
            help: "check the file; its nodes are GRID cards".to_owned(),
        });
    }
    let rows: HashMap<u64, u32> = positions.iter().zip(0..).map(|((label, _), row)| (*label, row)).collect();
    let mut found = Tetrahedra {
        source: source.display().to_string(),
        node_tags: positions.iter().map(|(label, _)| *label).collect(),
        positions: positions.iter().map(|(_, position)| *position).collect(),
        ..Tetrahedra::default()
    };
    let mut notes = Vec::new();
    deck.elements(texts, &rows, &mut found, &mut notes)?;
    let with_tetrahedra: HashSet<u64> = deck.tetrahedra.iter().map(|element| element.property).collect();
    let mut beside = Beside::default();
    let materials = deck.materials(&with_tetrahedra, &mut beside, &mut notes);
    let mut left = deck.masses(texts, &rows, &found.positions, &mut beside)?;
    let mut ties = deck.ties(texts, &rows, &mut found)?;
    let count = found.elements.len();
    let (mesh, mut of_mesh) = found.mesh(raise_order)?;
    notes.append(&mut of_mesh);
    left.extend(deck.unused.iter().map(|(name, count)| format!("{count} {name}")));
    if let Some((count, place)) = deck.unknown {
        left.push(format!("{count} card(s) that are not known here, the first in {}", texts.named(place)));
    }
    if bulk.lines_after > 0 {
        left.push(format!("{} lines after ENDDATA", bulk.lines_after));
    }
    notes.extend(notes::not_used(count, &left));
    let materials = materials.into_iter().filter(|material| mesh.groups().contains(&material.group)).collect();
    ties.retain(|tie| mesh.parts().node_groups.iter().any(|group| group.name == tie.group));
    beside.ties = ties;
    Ok(Imported { mesh, notes, materials, beside })
}

fn group_of(property: u64) -> String {
    format!("ref_{property}")
}

impl Deck {
    fn count(&mut self, name: &str) {
        *self.unused.entry(name.to_owned()).or_insert(0) += 1;
    }

    fn take(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        match card.name.as_str() {
            "GRID" => {
                self.space.grid(texts, card)?;
                if !matches!(card.field(7), "" | "0") {
                    self.count("GRID with a support (PS)");
                }
            }
            "GRDSET" => {
                self.space.default = card.whole(texts, 2)?.unwrap_or(0);
                if !matches!(card.field(7), "" | "0") {
                    self.count("GRDSET with supports (PS)");
                }
            }
            "CORD1R" | "CORD1C" | "CORD1S" | "CORD2R" | "CORD2C" | "CORD2S" => self.space.system(texts, card)?,
            "CTETRA" => {
                let element = tetrahedron(texts, card)?;
                self.tetrahedra.push(element);
            }
            "CTRIA3" | "CTRIAR" | "CTRIA6" => self.triangles.push(triangle(texts, card)?),
            "PSOLID" => {
                if self.properties.insert(card.label(texts, 1)?, card.label(texts, 2)?).is_some() {
                    let found = format!("PSOLID {} a second time", card.field(1));
                    return Err(texts.refuse(card.place, found, "give each property a number of its own"));
                }
            }
            "MAT1" => {
                let number = |field: usize| card.number(texts, field);
                let numbers = [number(2)?, number(3)?, number(4)?, number(5)?, number(8)?];
                if self.isotropic.insert(card.label(texts, 1)?, numbers).is_some() {
                    let found = format!("MAT1 {} a second time", card.field(1));
                    return Err(texts.refuse(card.place, found, "give each material a number of its own"));
                }
            }
            "PARAM" => match card.field(1).to_uppercase().as_str() {
                "WTMASS" => self.mass_of_weight = card.number(texts, 2)?.unwrap_or(1.0),
                "G" | "W3" | "W4" => self.count("PARAM of damping"),
                _ => {}
            },
            "CONM2" => {
                let system = if card.field(3) == "-1" { None } else { Some(card.whole(texts, 3)?.unwrap_or(0)) };
                let number = |field: usize| card.number_or_nought(texts, field);
                let mut has_inertia = false;
                for field in 9..=14 {
                    has_inertia |= number(field)? != 0.0;
                }
                self.masses.push(Mass {
                    place: card.place,
                    node: card.label(texts, 2)?,
                    system,
                    mass: number(4)?,
                    offset: [number(5)?, number(6)?, number(7)?],
                    has_inertia,
                });
            }
            "RBE2" => {
                self.count("RBE2 (in a scene: a marker with tie = \"rigid\")");
                self.tie(texts, card)?;
            }
            "RBE3" => {
                self.count("RBE3 (in a scene: a marker with tie = \"mean\")");
                self.tie(texts, card)?;
            }
            name if SOLIDS.contains(&name) => {
                self.solids.entry(name.to_owned()).or_insert((0, card.place)).0 += 1;
            }
            name if is_silent(name) => {}
            name => {
                if SHELLS.contains(&name) {
                    self.shells.insert(card.label(texts, 1)?);
                }
                if name.starts_with("MAT")
                    && let Ok(Some(label)) = card.whole(texts, 1)
                    && known(name).is_some_and(|name| !name.starts_with("MATT"))
                {
                    self.others.insert(label, name.to_owned());
                }
                match known(name) {
                    Some(name) => self.count(name),
                    None => self.unknown.get_or_insert((0, card.place)).0 += 1,
                }
            }
        }
        Ok(())
    }

    /// Elements and the groups of their properties.
    fn elements(
        &mut self,
        texts: &Texts<'_>,
        rows: &HashMap<u64, u32>,
        found: &mut Tetrahedra,
        notes: &mut Vec<String>,
    ) -> Result<(), ImportError> {
        let nodes_of = |element: &Element| -> Result<Vec<u32>, ImportError> {
            let row = |label: &u64| {
                if *label == 0 {
                    return Ok(MISSING);
                }
                rows.get(label).copied().ok_or_else(|| {
                    let found = format!("element {} has node {label}, which is not there", element.label);
                    texts.refuse(element.place, found, "check the nodes of the deck, and that all its files are there")
                })
            };
            element.nodes.iter().map(row).collect()
        };
        let mut seen = HashSet::new();
        let mut groups: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        for (element, row) in self.tetrahedra.iter().zip(0..) {
            if !seen.insert(element.label) {
                let found = format!("element {} is there twice", element.label);
                return Err(texts.refuse(element.place, found, "number its elements anew"));
            }
            found.elements.push(nodes_of(element)?);
            found.element_tags.push(element.label);
            groups.entry(element.property).or_default().push(row);
        }
        let mut surfaces: BTreeMap<u64, Vec<[u32; 3]>> = BTreeMap::new();
        let mut shells = 0;
        for element in &self.triangles {
            if self.shells.contains(&element.property) {
                shells += 1;
                continue;
            }
            let nodes = nodes_of(element)?;
            surfaces.entry(element.property).or_default().push([nodes[0], nodes[1], nodes[2]]);
        }
        if shells > 0 {
            self.unused.insert("triangles with PSHELL or PCOMP".to_owned(), shells);
        }
        if groups.len().max(surfaces.len()) > MAX_GROUPS {
            let count = groups.len().max(surfaces.len());
            notes.push(format!("the elements have {count} properties, which make no groups"));
            return Ok(());
        }
        found.groups = groups.into_iter().map(|(property, members)| (group_of(property), members)).collect();
        found.surfaces = surfaces.into_iter().map(|(property, members)| (group_of(property), members)).collect();
        Ok(())
    }

    /// Masses on nodes; a sentence on each whose place is not known.
    fn masses(
        &mut self,
        texts: &Texts<'_>,
        rows: &HashMap<u64, u32>,
        positions: &[[f64; 3]],
        beside: &mut Beside,
    ) -> Result<Vec<String>, ImportError> {
        let mut elsewhere = (0, 0.0);
        let mut with_inertia = 0;
        for Mass { place, node, system, mass, offset, has_inertia } in &self.masses {
            with_inertia += usize::from(*has_inertia);
            let Some(at) = rows.get(node).map(|row| positions[*row as usize]) else {
                let found = format!("CONM2 at node {node}, which is not there");
                return Err(texts.refuse(
                    *place,
                    found,
                    "check the nodes of the deck, and that all its files are there",
                ));
            };
            let mass = mass * self.mass_of_weight;
            let place = match system {
                None => Some(*offset),
                Some(_) if *offset == [0.0; 3] => Some(at),
                Some(system) => {
                    let offset = self.space.vector(texts, *place, *system, *offset)?;
                    offset.map(|offset| std::array::from_fn(|i| at[i] + offset[i]))
                }
            };
            match place {
                Some(_) if mass == 0.0 => {}
                Some(at) => beside.masses.push(DeckMass { kind: "CONM2".to_owned(), at, mass }),
                None => elsewhere = (elsewhere.0 + 1, elsewhere.1 + mass),
            }
        }
        let mut left = Vec::new();
        if elsewhere.0 > 0 {
            left.push(format!("{} CONM2 with offsets in systems of angles ({:.4e})", elsewhere.0, elsewhere.1));
        }
        if with_inertia > 0 {
            left.push(format!("moments of inertia of {with_inertia} CONM2"));
        }
        Ok(left)
    }

    /// Takes an RBE2 or RBE3.
    fn tie(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        let (label, mut nodes) = (card.label(texts, 1)?, Vec::new());
        let is_label = |field: usize| {
            let text = card.field(field);
            !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
        };
        let (kind, point) = if card.name == "RBE2" {
            // A number with a point at the end is one of thermal expansion.
            nodes.extend((4..=card.len()).filter(|field| is_label(*field)).map(|field| card.label(texts, field)));
            ("RBE2", card.label(texts, 2)?)
        } else {
            // Weight, directions and nodes, again and again; words begin what is of another kind.
            let mut field = 5;
            while field <= card.len() && !card.field(field).starts_with(|letter: char| letter.is_ascii_alphabetic()) {
                if card.field(field).contains('.') {
                    field += 2;
                } else {
                    if is_label(field) {
                        nodes.push(card.label(texts, field));
                    }
                    field += 1;
                }
            }
            ("RBE3", card.label(texts, 3)?)
        };
        let nodes = nodes.into_iter().collect::<Result<_, _>>()?;
        self.ties.push(Tie { place: card.place, kind, label, point, nodes });
        Ok(())
    }

    /// Ties as groups of nodes.
    fn ties(
        &self,
        texts: &Texts<'_>,
        rows: &HashMap<u64, u32>,
        found: &mut Tetrahedra,
    ) -> Result<Vec<DeckTie>, ImportError> {
        let mut ties = Vec::new();
        for Tie { place, kind, label, point, nodes } in &self.ties {
            let row = |node: &u64| {
                rows.get(node).copied().ok_or_else(|| {
                    let found = format!("{kind} {label} has node {node}, which is not there");
                    texts.refuse(*place, found, "check the nodes of the deck, and that all its files are there")
                })
            };
            let nodes = nodes.iter().map(row).collect::<Result<_, _>>()?;
            let at = Some(found.positions[row(point)? as usize]);
            let group = format!("{kind}_{label}");
            ties.push(DeckTie { kind: (*kind).to_owned(), group: group.clone(), is_rigid: *kind == "RBE2", at });
            found.node_groups.push((group, nodes));
        }
        Ok(ties)
    }

    /// The materials of the properties that tetrahedra have.
    fn materials(
        &self,
        with_tetrahedra: &HashSet<u64>,
        beside: &mut Beside,
        notes: &mut Vec<String>,
    ) -> Vec<DeckMaterial> {
        let mut found = Vec::new();
        for (property, label) in self.properties.iter().filter(|(property, _)| with_tetrahedra.contains(property)) {
            let group = group_of(*property);
            let Some([young, shear, poisson, density, damping]) = self.isotropic.get(label) else {
                let found = match self.others.get(label) {
                    Some(kind) => format!("it is of kind {kind}, and only MAT1 is"),
                    None => "there is none of that number".to_owned(),
                };
                notes.push(format!("the material {label} of {group} is not read: {found}"));
                continue;
            };
            // Each follows from the two others.
            let poisson_ratio = match (poisson, young, shear) {
                (Some(poisson), ..) => *poisson,
                (None, Some(young), Some(shear)) if *shear > 0.0 => young / (2.0 * shear) - 1.0,
                _ => 0.0,
            };
            let young_modulus = match (young, shear) {
                (Some(young), _) => *young,
                (None, Some(shear)) if poisson.is_some() => 2.0 * shear * (1.0 + poisson_ratio),
                _ => 0.0,
            };
            let density = density.unwrap_or(0.0) * self.mass_of_weight;
            if young_modulus > 0.0 && poisson_ratio > -1.0 && poisson_ratio < 0.5 && density > 0.0 {
                let name = format!("MAT1 {label}");
                let material = Material { young_modulus, poisson_ratio, density };
                found.push(DeckMaterial { group: group.clone(), name, material });
            } else if young_modulus > 0.0 && poisson_ratio > -1.0 && poisson_ratio < 0.5 && density == 0.0 {
                notes.push(format!(
                    "the material MAT1 {label} of {group} has no density (its Young's modulus is {young_modulus:?}, its Poisson's ratio \
                     {poisson_ratio:?})"
                ));
                let name = format!("MAT1 {label}");
                beside.without_density.push(Elastic { group: group.clone(), name, young_modulus, poisson_ratio });
            } else {
                notes.push(format!(
                    "the material MAT1 {label} of {group} is not read: Young's modulus {young_modulus}, Poisson's ratio \
                     {poisson_ratio}, density {density}"
                ));
            }
            if damping.is_some_and(|damping| damping != 0.0) {
                notes.push(format!("the damping GE of the material MAT1 {label} is not read"));
            }
        }
        found
    }
}

/// A tetrahedron: four corners, and ten nodes where any on an edge is there. Those that are missing are 0.
fn tetrahedron(texts: &Texts<'_>, card: &Card<'_>) -> Result<Element, ImportError> {
    let label = card.label(texts, 1)?;
    let count = card.len().saturating_sub(2);
    if !(4..=10).contains(&count) {
        let found = format!("CTETRA {label} with {count} nodes, expected 4 to 10");
        return Err(texts.refuse(card.place, found, "check the card and the lines that continue it"));
    }
    let mut nodes = (3..=6).map(|field| card.label(texts, field)).collect::<Result<Vec<_>, _>>()?;
    if count > 4 {
        for field in 7..=12 {
            nodes.push(card.whole(texts, field)?.unwrap_or(0));
        }
    }
    Ok(Element { place: card.place, label, property: card.whole(texts, 2)?.unwrap_or(label), nodes })
}

/// The corners of a triangle. Nodes on its edges may be missing, and what is after them is its thickness and angle.
fn triangle(texts: &Texts<'_>, card: &Card<'_>) -> Result<Element, ImportError> {
    let label = card.label(texts, 1)?;
    let nodes = (3..=5).map(|field| card.label(texts, field)).collect::<Result<_, _>>()?;
    Ok(Element { place: card.place, label, property: card.whole(texts, 2)?.unwrap_or(label), nodes })
}
