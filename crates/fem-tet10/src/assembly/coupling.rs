//! Which elements a node belongs to, and which nodes it is coupled to.

use std::collections::HashMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::mesh::checked::Mesh;
use crate::mesh::locate::Location;

/// Nodes of a part, which one task handles.
const PART: usize = 1024;

/// The nodes `0..count` in parts, the same for any number of threads.
pub(crate) fn parts(count: usize) -> Vec<Range<usize>> {
    (0..count).step_by(PART).map(|first| first..count.min(first + PART)).collect()
}

/// For each node, the elements it belongs to and its number in them.
#[derive(Debug)]
pub(crate) struct Incidence {
    start: Vec<usize>,
    entries: Vec<(u32, u8)>,
}

impl Incidence {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut start = vec![0; mesh.positions().len() + 1];
        for node in mesh.elements().iter().flatten() {
            start[*node as usize + 1] += 1;
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut next = start.clone();
        let mut entries = vec![(0, 0); 10 * mesh.elements().len()];
        for (e, nodes) in (0..).zip(mesh.elements()) {
            for (a, node) in (0..).zip(nodes) {
                entries[next[*node as usize]] = (e, a);
                next[*node as usize] += 1;
            }
        }
        Self { start, entries }
    }

    pub(crate) fn of(&self, node: usize) -> &[(u32, u8)] {
        &self.entries[self.start[node]..self.start[node + 1]]
    }
}

/// The pairs of coupled nodes in compressed columns, a node with itself too.
#[derive(Debug, Clone)]
pub(crate) struct Coupling {
    pub start: Vec<usize>,
    /// The nodes that each node is coupled to, in rising order.
    pub nodes: Vec<u32>,
}

impl Coupling {
    /// Nodes are coupled by the elements, and by the masses that they carry together.
    pub fn new(mesh: &Mesh, incidence: &Incidence, carried: &[(f64, Location)]) -> Self {
        let mut carriers: HashMap<u32, Vec<&Location>> = HashMap::new();
        for (_, location) in carried {
            for node in &location.nodes {
                carriers.entry(*node).or_default().push(location);
            }
        }
        let count = mesh.positions().len();
        let of_part = |seen: &mut Vec<u32>, part: Range<usize>| {
            seen.resize(count, u32::MAX);
            let (mut nodes, mut lengths) = (Vec::new(), Vec::with_capacity(part.len()));
            for node in part {
                let (first, mark) = (nodes.len(), node as u32);
                let mut add = |other: u32| {
                    if seen[other as usize] != mark {
                        seen[other as usize] = mark;
                        nodes.push(other);
                    }
                };
                let of_elements = incidence.of(node).iter().flat_map(|(e, _)| &mesh.elements()[*e as usize]);
                of_elements.for_each(|other| add(*other));
                for location in carriers.get(&mark).into_iter().flatten() {
                    location.nodes.iter().for_each(|other| add(*other));
                }
                nodes[first..].sort_unstable();
                lengths.push(nodes.len() - first);
            }
            (nodes, lengths)
        };
        let found: Vec<(Vec<u32>, Vec<usize>)> = parts(count).into_par_iter().map_init(Vec::new, of_part).collect();
        let mut start = Vec::with_capacity(count + 1);
        let mut nodes = Vec::with_capacity(found.iter().map(|(nodes, _)| nodes.len()).sum());
        start.push(0);
        for (of_part, lengths) in found {
            let mut end = nodes.len();
            start.extend(lengths.into_iter().map(|length| {
                end += length;
                end
            }));
            nodes.extend(of_part);
        }
        Self { start, nodes }
    }

    /// The nodes that a node is coupled to.
    pub fn of(&self, node: usize) -> &[u32] {
        &self.nodes[self.start[node]..self.start[node + 1]]
    }
}
