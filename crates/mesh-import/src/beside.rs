//! Masses, ties and elasticities of a deck, which a scene can have, too.

use std::collections::BTreeMap;

use fem_tet10::Mesh;
use serde::{Deserialize, Serialize};

use crate::own::notes;

/// Masses, ties and elasticities of a deck, in its own units.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Beside {
    /// Masses at points.
    pub masses: Vec<DeckMass>,
    /// Nodes that move with a point.
    pub ties: Vec<DeckTie>,
    /// Materials without a density.
    pub without_density: Vec<Elastic>,
}

/// A mass at a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeckMass {
    /// Kind of element that it is, such as CONM2.
    pub kind: String,
    /// Position of its node.
    pub node: [f64; 3],
    /// Its own position.
    pub at: [f64; 3],
    /// Mass.
    pub mass: f64,
}

/// Nodes that move with a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeckTie {
    /// Card or keyword, such as RBE2.
    pub kind: String,
    /// Group of the mesh with the nodes.
    pub group: String,
    /// True if the nodes are rigid; else their mean follows the point.
    pub is_rigid: bool,
    /// Position of the point, where the deck has it.
    pub at: Option<[f64; 3]>,
}

/// Elasticity of a group of the mesh whose density is not given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Elastic {
    /// Group of the mesh.
    pub group: String,
    /// Name of the material.
    pub name: String,
    /// Young's modulus.
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

impl DeckTie {
    /// Its name in `tie` of a marker.
    pub fn tie(&self) -> &'static str {
        if self.is_rigid { "rigid" } else { "mean" }
    }

    /// True if the mesh has its group.
    pub(crate) fn is_of(&self, mesh: &Mesh) -> bool {
        mesh.surface_groups().any(|surface| surface == self.group)
            || mesh.parts().node_groups.iter().any(|group| group.name == self.group)
            || mesh.groups().contains(&self.group)
    }
}

impl Beside {
    /// A sentence on the ties that are not used.
    pub fn unused_ties(&self, is_used: impl Fn(&DeckTie) -> bool) -> Option<String> {
        let mut kinds: BTreeMap<(&str, &str), Vec<&str>> = BTreeMap::new();
        for tie in self.ties.iter().filter(|tie| !is_used(tie)) {
            kinds.entry((&tie.kind, tie.tie())).or_default().push(&tie.group);
        }
        let each = kinds.into_iter().map(|((kind, tie), groups)| {
            let more = if groups.len() > 1 { ", …" } else { "" };
            format!(
                "{} {kind} (in a scene: a marker with group = {:?}{more} and tie = \"{tie}\")",
                groups.len(),
                groups[0]
            )
        });
        let each: Vec<String> = each.collect();
        (!each.is_empty()).then(|| format!("not used: {}", each.join(", ")))
    }

    /// A sentence on the masses that are not used, with their sum.
    pub fn unused_masses(&self, is_used: impl Fn(&DeckMass) -> bool) -> Option<String> {
        let mut kinds: Vec<&str> = self.masses.iter().map(|mass| &mass.kind[..]).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let left: Vec<String> = kinds
            .into_iter()
            .filter_map(|kind| {
                let of_kind = self.masses.iter().filter(|mass| mass.kind == kind && !is_used(mass));
                notes::masses(kind, &of_kind.map(|mass| (mass.at, mass.mass)).collect::<Vec<_>>())
            })
            .collect();
        (!left.is_empty()).then(|| format!("not used: {}", left.join(", ")))
    }
}
