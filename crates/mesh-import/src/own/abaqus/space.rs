//! The spaces of a deck: each instance and the assembly, with the numbers and names that are known in it.

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use crate::error::ImportError;
use crate::own::abaqus::deck::Deck;
use crate::own::abaqus::scope::{Element, Reference, Referred, Scope, Sets};
use crate::own::systems::Placement;
use crate::own::texts::{Place, Texts};

/// Sets of sets of sets.
const DEEPEST: usize = 50;

/// An instance of a part, or the assembly.
pub(super) struct Space<'d> {
    /// Name before those of its sets, where another space has the same; empty for the assembly.
    pub(super) prefix: String,
    /// In capital letters.
    instance: Option<String>,
    pub(super) scopes: Vec<&'d Scope>,
    nodes: BTreeMap<u64, u32>,
    elements: BTreeMap<u64, u32>,
}

/// All nodes and elements of a deck, at their places.
pub(super) struct World<'d> {
    pub(super) spaces: Vec<Space<'d>>,
    pub(super) node_labels: Vec<u64>,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) elements: Vec<(usize, &'d Element)>,
    sets: HashMap<(bool, usize, String), Rc<Vec<u32>>>,
}

impl<'d> World<'d> {
    pub(super) fn of(texts: &Texts<'_>, deck: &'d Deck) -> Result<Self, ImportError> {
        let space = |prefix: String, instance, scopes| Space {
            prefix,
            instance,
            scopes,
            nodes: BTreeMap::new(),
            elements: BTreeMap::new(),
        };
        let mut spaces = vec![(space(String::new(), None, vec![&deck.root]), Placement::NONE)];
        for instance in &deck.instances {
            let part = &deck.parts[instance.part];
            let is_only = deck.instances.iter().filter(|other| other.part == instance.part).count() == 1;
            let prefix = if is_only { part.name.clone() } else { instance.name.clone() };
            let key = instance.name.to_uppercase();
            if spaces.iter().any(|(space, _)| space.instance.as_ref() == Some(&key)) {
                let found = format!("the instance {} a second time", instance.name);
                return Err(texts.refuse(instance.place, found, "give each instance a name of its own"));
            }
            spaces.push((space(prefix, Some(key), vec![&part.scope, &instance.own]), instance.placement));
        }
        if deck.instances.is_empty() {
            // A file with parts and without an assembly.
            let parts = deck.parts.iter();
            let alone = parts.map(|part| {
                (space(part.name.clone(), Some(part.name.to_uppercase()), vec![&part.scope]), Placement::NONE)
            });
            spaces.extend(alone);
        }
        let mut world = World {
            spaces: Vec::new(),
            node_labels: Vec::new(),
            positions: Vec::new(),
            elements: Vec::new(),
            sets: HashMap::new(),
        };
        for (number, (mut space, placement)) in spaces.into_iter().enumerate() {
            for scope in space.scopes.clone() {
                for node in &scope.nodes {
                    let position = placement.of(node.position);
                    match space.nodes.get(&node.label) {
                        Some(known) if world.positions[*known as usize] == position => {}
                        Some(_) => {
                            let found = format!("node {} is there twice, at different places", node.label);
                            let help = "number its nodes anew, or write one part for each body";
                            return Err(texts.refuse(node.place, found, help));
                        }
                        None => {
                            space.nodes.insert(node.label, world.positions.len() as u32);
                            world.positions.push(position);
                            world.node_labels.push(node.label);
                        }
                    }
                }
                for element in &scope.elements {
                    if space.elements.insert(element.label, world.elements.len() as u32).is_some() {
                        let found = format!("element {} is there twice", element.label);
                        return Err(texts.refuse(element.place, found, "number its elements anew"));
                    }
                    world.elements.push((number, element));
                }
            }
            world.spaces.push(space);
        }
        Ok(world)
    }

    /// The number of the space with this name in capital letters; the one that asks where there is no name.
    fn space(&self, from: usize, instance: Option<&String>) -> Option<usize> {
        match instance {
            None => Some(from),
            Some(name) => self.spaces.iter().position(|space| space.instance.as_ref() == Some(name)),
        }
    }

    /// The nodes of an element.
    pub(super) fn nodes_of(&self, texts: &Texts<'_>, element: usize) -> Result<Vec<u32>, ImportError> {
        let (from, element) = self.elements[element];
        let space = self.space(from, element.instance.as_ref()).map(|space| &self.spaces[space]);
        let node = |label: &u64| {
            space.and_then(|space| space.nodes.get(label)).copied().ok_or_else(|| {
                let found = format!("element {} has node {label}, which is not there", element.label);
                texts.refuse(element.place, found, "check the nodes of the deck, and that all its files are there")
            })
        };
        element.nodes.iter().map(node).collect()
    }

    /// The nodes or elements of a set, by its name in capital letters.
    pub(super) fn set(
        &mut self,
        texts: &Texts<'_>,
        is_of_nodes: bool,
        space: usize,
        name: &str,
    ) -> Result<Option<Rc<Vec<u32>>>, ImportError> {
        self.set_at(texts, is_of_nodes, space, name, 0)
    }

    fn set_at(
        &mut self,
        texts: &Texts<'_>,
        is_of_nodes: bool,
        space: usize,
        name: &str,
        depth: usize,
    ) -> Result<Option<Rc<Vec<u32>>>, ImportError> {
        let key = (is_of_nodes, space, name.to_owned());
        if let Some(known) = self.sets.get(&key) {
            return Ok(Some(known.clone()));
        }
        let mut found = Vec::new();
        let mut is_there = false;
        for scope in self.spaces[space].scopes.clone() {
            let sets: &Sets = if is_of_nodes { &scope.node_sets } else { &scope.element_sets };
            let Some(number) = sets.number(name) else { continue };
            is_there = true;
            for (reference, place) in &sets.list[number].members {
                // A set that is said to be in itself adds nothing.
                if !matches!(&reference.of, Referred::Set(other) if other == name && reference.instance.is_none()) {
                    self.referred(texts, is_of_nodes, space, reference, *place, depth, &mut found)?;
                }
            }
        }
        if !is_there {
            return Ok(None);
        }
        found.sort_unstable();
        found.dedup();
        let found = Rc::new(found);
        self.sets.insert(key, found.clone());
        Ok(Some(found))
    }

    /// Adds the nodes or elements that a reference stands for.
    #[expect(clippy::too_many_arguments, reason = "each is another thing")]
    pub(super) fn referred(
        &mut self,
        texts: &Texts<'_>,
        is_of_nodes: bool,
        from: usize,
        reference: &Reference,
        place: Place,
        depth: usize,
        found: &mut Vec<u32>,
    ) -> Result<(), ImportError> {
        if depth > DEEPEST {
            return Err(texts.refuse(
                place,
                "a set that is in itself, or sets in each other too deep",
                "check the sets",
            ));
        }
        let space = self.space(from, reference.instance.as_ref());
        let labels = |space: usize| if is_of_nodes { &self.spaces[space].nodes } else { &self.spaces[space].elements };
        match (&reference.of, space) {
            (Referred::Label(label), Some(space)) => found.extend(labels(space).get(label)),
            (Referred::Range(first, last, step), Some(space)) if first <= last => {
                let within = labels(space).range(first..=last);
                found.extend(within.filter(|(label, _)| (*label - first).is_multiple_of(*step)).map(|(_, at)| *at));
            }
            (Referred::Range(..), Some(_)) => {}
            (Referred::NodesOf(name), Some(space)) => {
                let elements = self.set_at(texts, false, space, name, depth + 1)?;
                let elements = elements.ok_or_else(|| unnamed(texts, place))?;
                for element in elements.iter() {
                    found.extend(self.nodes_of(texts, *element as usize)?);
                }
            }
            (Referred::Set(name), space) => {
                let mut set = None;
                if let Some(space) = space {
                    set = self.set_at(texts, is_of_nodes, space, name, depth + 1)?;
                }
                // In a deck without instances a name may have a point in it.
                if set.is_none()
                    && let Some(instance) = &reference.instance
                {
                    set = self.set_at(texts, is_of_nodes, from, &format!("{instance}.{name}"), depth + 1)?;
                }
                found.extend(set.ok_or_else(|| unnamed(texts, place))?.iter());
            }
            (_, None) => return Err(unnamed(texts, place)),
        }
        Ok(())
    }
}

fn unnamed(texts: &Texts<'_>, place: Place) -> ImportError {
    texts.refuse(place, "a set or an instance is named that is not there", "check the names of sets and instances")
}
