//! The body of a deck: its tetrahedra, names and materials, and a sentence on all that is not used.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use fem_tet10::Material;

use crate::beside::{Beside, DeckTie, Elastic};
use crate::deck_material::DeckMaterial;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::own::nastran::card::Card;
use crate::own::nastran::cards::Bulk;
use crate::own::nastran::kinds::{SOLIDS, is_silent, known};
use crate::own::nastran::masses::Masses;
use crate::own::nastran::sections::{SHELLS, Sections};
use crate::own::nastran::systems::Space;
use crate::own::notes::Left;
use crate::own::tetrahedra::{MISSING, Tetrahedra};
use crate::own::texts::{Place, Texts};

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
    /// Densities of materials of all kinds.
    densities: HashMap<u64, f64>,
    masses: Masses,
    sections: Sections,
    ties: Vec<Tie>,
    mass_of_weight: f64,
    left: Left,
    unknown: Option<(usize, Place)>,
}

struct Element {
    place: Place,
    /// The name of its card.
    name: String,
    label: u64,
    property: u64,
    nodes: Vec<u64>,
}

impl Element {
    /// An element of a card, which is its own property where it names none.
    fn new(texts: &Texts<'_>, card: &Card<'_>, label: u64, nodes: Vec<u64>) -> Result<Self, ImportError> {
        let property = card.whole(texts, 2)?.unwrap_or(label);
        Ok(Self { place: card.place, name: card.name.clone(), label, property, nodes })
    }
}

/// An RBE2 or RBE3: nodes that move with another.
struct Tie {
    place: Place,
    kind: &'static str,
    label: u64,
    point: u64,
    nodes: Vec<u64>,
    /// False if it ties in some directions only.
    is_whole: bool,
    /// False if its nodes have other weights than each other.
    is_even: bool,
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
    let position_of = |node: u64| rows.get(&node).map(|row| found.positions[*row as usize]);
    let Deck { masses, space, sections, densities, mass_of_weight, left, .. } = &mut deck;
    beside.masses = masses.found(texts, space, &position_of, *mass_of_weight, left)?;
    let density_of = |material: u64| densities.get(&material).map(|density| density * *mass_of_weight);
    for (name, mass) in sections.masses(&position_of, &density_of, *mass_of_weight) {
        left.heavy(name, mass);
    }
    let ties = deck.ties(texts, &rows, &mut found)?;
    for tie in deck.ties.iter().filter(|tie| tie.is_whole && !tie.is_even) {
        notes.push(format!("the weights of {} {} are taken as equal", tie.kind, tie.label));
    }
    for (property, name) in &bulk.names {
        // A name that several properties have is a group of them all.
        let members = (deck.tetrahedra.iter().zip(0..)).filter(|(element, _)| element.property == *property);
        let members: Vec<u32> = members.map(|(_, row)| row).collect();
        match found.groups.iter_mut().find(|(known, _)| known == name) {
            _ if members.is_empty() => {}
            Some((_, known)) => known.extend(members),
            None => found.groups.push(((*name).to_owned(), members)),
        }
    }
    let count = found.elements.len();
    let (mesh, mut of_mesh) = found.mesh(raise_order)?;
    notes.append(&mut of_mesh);
    if let Some((count, place)) = deck.unknown {
        deck.left.say(format!("{count} card(s) that are not known here, the first in {}", texts.named(place)));
    }
    if bulk.lines_after > 0 {
        deck.left.say(format!("{} lines after ENDDATA", bulk.lines_after));
    }
    notes.extend(deck.left.sentence(count));
    let materials = materials.into_iter().filter(|material| mesh.groups().contains(&material.group)).collect();
    beside.ties = ties.into_iter().filter(|tie| tie.is_of(&mesh)).collect();
    Ok(Imported { mesh, notes, materials, beside })
}

fn group_of(property: u64) -> String {
    format!("ref_{property}")
}

impl Deck {
    fn take(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        if self.masses.take(texts, card, &mut self.left)? || self.sections.take(texts, card)? {
            return Ok(());
        }
        // A density that cannot be read is that of a mass that is not known.
        let density = match card.name.as_str() {
            "MAT1" => card.number(texts, 5),
            "MAT2" | "MAT8" => card.number(texts, 8),
            _ => Ok(None),
        };
        if let (Ok(Some(density)), Ok(label)) = (density, card.label(texts, 1)) {
            self.densities.insert(label, density);
        }
        match card.name.as_str() {
            "GRID" => {
                self.space.grid(texts, card)?;
                if !matches!(card.field(7), "" | "0") {
                    self.left.count("GRID with a support (PS)");
                }
            }
            "GRDSET" => {
                self.space.default = card.whole(texts, 2)?.unwrap_or(0);
                if !matches!(card.field(7), "" | "0") {
                    self.left.count("GRDSET with supports (PS)");
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
                "G" | "W3" | "W4" => self.left.count("PARAM of damping"),
                _ => {}
            },
            "RBE2" | "RBE3" => self.tie(texts, card)?,
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
                    Some(name) => self.left.count(name),
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
        for element in &self.triangles {
            if self.shells.contains(&element.property)
                && let [a, b, c, ..] = element.nodes[..]
            {
                self.sections.triangle(&element.name, element.property, [a, b, c]);
                continue;
            }
            let nodes = nodes_of(element)?;
            surfaces.entry(element.property).or_default().push([nodes[0], nodes[1], nodes[2]]);
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

    /// Takes an RBE2 or RBE3.
    fn tie(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        let (label, mut nodes) = (card.label(texts, 1)?, Vec::new());
        let is_label = |field: usize| {
            let text = card.field(field);
            !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
        };
        let refuse_word = |field: usize| {
            let found =
                format!("in field {} of {} {label}, found a word, expected the number of a node", field + 1, card.name);
            texts.refuse(card.place, found, "write the numbers of all its nodes")
        };
        let is_word = |field: usize| card.field(field).starts_with(|letter: char| letter.is_ascii_alphabetic());
        // What is tied in some directions only does something else.
        let has_all = |field: usize| ['1', '2', '3'].iter().all(|direction| card.field(field).contains(*direction));
        let (kind, point, mut is_whole);
        let mut weights = Vec::new();
        if card.name == "RBE2" {
            if let Some(field) = (4..=card.len()).find(|field| is_word(*field)) {
                return Err(refuse_word(field));
            }
            // A number with a point at the end is one of thermal expansion.
            nodes.extend((4..=card.len()).filter(|field| is_label(*field)).map(|field| card.label(texts, field)));
            (kind, point, is_whole) = ("RBE2", card.label(texts, 2)?, has_all(3));
            // The node itself may be one of the body.
            nodes.push(Ok(point));
        } else {
            (kind, point, is_whole) = ("RBE3", card.label(texts, 3)?, has_all(4));
            // Weight, directions and nodes, again and again; words begin what is of another kind.
            let mut field = 5;
            while field <= card.len() && !matches!(&*card.field(field).to_uppercase(), "UM" | "ALPHA" | "TREF") {
                if is_word(field) {
                    return Err(refuse_word(field));
                }
                if card.field(field).contains('.') {
                    weights.push(card.number_or_nought(texts, field)?);
                    is_whole &= has_all(field + 1);
                    field += 2;
                } else {
                    if is_label(field) {
                        nodes.push(card.label(texts, field));
                    }
                    field += 1;
                }
            }
        }
        if !is_whole {
            self.left.count(&format!("{kind} in some directions only"));
        }
        let nodes = nodes.into_iter().collect::<Result<_, _>>()?;
        let is_even = weights.windows(2).all(|pair| pair[0] == pair[1]);
        self.ties.push(Tie { place: card.place, kind, label, point, nodes, is_whole, is_even });
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
        for Tie { place, kind, label, point, nodes, is_whole, is_even: _ } in &self.ties {
            let row = |node: &u64| {
                rows.get(node).copied().ok_or_else(|| {
                    let found = format!("{kind} {label} has node {node}, which is not there");
                    texts.refuse(*place, found, "check the nodes of the deck, and that all its files are there")
                })
            };
            let nodes = nodes.iter().map(row).collect::<Result<Vec<_>, _>>()?;
            let at = Some(found.positions[row(point)? as usize]);
            let group = format!("{kind}_{label}");
            found.node_groups.push((group.clone(), nodes));
            if *is_whole {
                ties.push(DeckTie { kind: (*kind).to_owned(), group, is_rigid: *kind == "RBE2", at });
            }
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
        let mut without: Vec<_> =
            with_tetrahedra.iter().filter(|property| !self.properties.contains_key(property)).collect();
        without.sort();
        // A mesh alone has neither properties nor materials.
        let has_none = self.properties.is_empty() && self.isotropic.is_empty() && self.others.is_empty();
        if let [first, rest @ ..] = &without[..]
            && !has_none
        {
            let more = if rest.is_empty() { String::new() } else { format!(" and of {} more", rest.len()) };
            notes.push(format!(
                "the material of {}{more} is not known: there is no PSOLID of that number",
                group_of(**first)
            ));
        }
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
    Element::new(texts, card, label, nodes)
}

/// The corners of a triangle. Nodes on its edges may be missing, and what is after them is its thickness and angle.
fn triangle(texts: &Texts<'_>, card: &Card<'_>) -> Result<Element, ImportError> {
    let label = card.label(texts, 1)?;
    let nodes = (3..=5).map(|field| card.label(texts, field)).collect::<Result<_, _>>()?;
    Element::new(texts, card, label, nodes)
}
