//! Definitions of a part, an instance or the assembly of a deck, under names of its own.

use std::collections::HashMap;

use crate::own::abaqus::kinds::Kind;
use crate::own::systems::Placement;
use crate::own::texts::Place;

/// A number or a name, of an instance where one stands before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reference {
    /// In capital letters.
    pub(crate) instance: Option<String>,
    pub(crate) of: Referred,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Referred {
    Label(u64),
    /// First, last and step.
    Range(u64, u64, u64),
    /// In capital letters.
    Set(String),
    /// The nodes of a set of elements, in capital letters.
    NodesOf(String),
}

#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) label: u64,
    pub(crate) position: [f64; 3],
    pub(crate) place: Place,
}

#[derive(Debug)]
pub(crate) struct Element {
    pub(crate) label: u64,
    /// Number of its type in [`Deck::types`](crate::own::abaqus::deck::Deck::types).
    pub(crate) of_type: usize,
    pub(crate) kind: Kind,
    /// The instance of its nodes, in capital letters, where it names one.
    pub(crate) instance: Option<String>,
    pub(crate) nodes: Vec<u64>,
    pub(crate) place: Place,
}

/// A set of nodes or elements.
#[derive(Debug)]
pub(crate) struct Set {
    /// As it is written.
    pub(crate) name: String,
    /// True if only the program that wrote it needs it.
    pub(crate) internal: bool,
    pub(crate) members: Vec<(Reference, Place)>,
}

/// Sets by their names in capital letters, in the order of the file.
#[derive(Debug, Default)]
pub(crate) struct Sets {
    pub(crate) list: Vec<Set>,
    by_name: HashMap<String, usize>,
}

impl Sets {
    /// The number of a set of this name, which is made where there is none.
    pub(crate) fn named(&mut self, name: &str, internal: bool) -> &mut Set {
        let number = *self.by_name.entry(name.to_uppercase()).or_insert_with(|| {
            self.list.push(Set { name: name.to_owned(), internal, members: Vec::new() });
            self.list.len() - 1
        });
        &mut self.list[number]
    }

    /// The number of the set with this name in capital letters.
    pub(crate) fn number(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }
}

/// A surface of nodes or of faces of elements.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) name: String,
    pub(crate) of_nodes: bool,
    /// Elements and the name of a face, empty for all free faces; or nodes.
    pub(crate) faces: Vec<(Reference, String, Place)>,
}

/// A section: a set of elements and their material.
#[derive(Debug)]
pub(crate) struct Section {
    /// True of a `*SOLID SECTION`.
    pub(crate) is_solid: bool,
    pub(crate) set: String,
    /// Material of a solid.
    pub(crate) material: String,
    /// Materials and thicknesses of the layers of a shell; none where they are not known.
    pub(crate) layers: Option<Vec<(String, f64)>>,
}

/// Masses on each element of a set.
#[derive(Debug)]
pub(crate) struct Mass {
    pub(crate) set: String,
    pub(crate) mass: f64,
}

/// The nodes of a region that move with a reference point.
#[derive(Debug)]
pub(crate) struct Tie {
    /// The keyword that makes it.
    pub(crate) keyword: &'static str,
    /// True if the region is rigid; else its mean follows the point.
    pub(crate) is_rigid: bool,
    /// A surface, or sets of nodes or elements, as the file has it.
    pub(crate) region: String,
    /// The reference node: its number or a set with it alone.
    pub(crate) point: String,
    pub(crate) place: Place,
}

/// Definitions of a part, an instance or the assembly.
#[derive(Debug, Default)]
pub(crate) struct Scope {
    pub(crate) nodes: Vec<Node>,
    pub(crate) elements: Vec<Element>,
    pub(crate) node_sets: Sets,
    pub(crate) element_sets: Sets,
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) sections: Vec<Section>,
    pub(crate) masses: Vec<Mass>,
    pub(crate) ties: Vec<Tie>,
}

/// A part.
#[derive(Debug)]
pub(crate) struct Part {
    /// As it is written.
    pub(crate) name: String,
    pub(crate) scope: Scope,
}

/// A part at its place in the assembly.
#[derive(Debug)]
pub(crate) struct Instance {
    /// As it is written.
    pub(crate) name: String,
    /// Number of its part.
    pub(crate) part: usize,
    pub(crate) placement: Placement,
    /// Definitions beside those of the part.
    pub(crate) own: Scope,
    pub(crate) place: Place,
}
