//! The body of a file of elements: ten-node tetrahedra with their groups, whatever order the file has for nodes on edges.

use std::collections::{BTreeMap, HashMap, HashSet};

use fem_tet10::{Mesh, MeshParts, NodeGroup, SurfaceGroup};

use crate::error::ImportError;

/// Corners of the edges, in gmsh's order of the nodes on them.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
/// Nodes of the faces: corners, then those between 01 12 20. The order is that of Abaqus' faces S1 to S4.
const FACES: [[usize; 6]; 4] = [[0, 1, 2, 4, 5, 6], [0, 3, 1, 7, 9, 4], [1, 3, 2, 9, 8, 5], [2, 3, 0, 8, 7, 6]];

/// A node that is farther from the middle of its edge, in lengths of the longest edge, may be on another edge.
const FAR: f64 = 0.25;

/// Stands for a node on an edge that a tetrahedron of ten nodes lacks.
pub(crate) const MISSING: u32 = u32::MAX;

/// The elements of a file and their names, by indices.
#[derive(Debug, Default)]
pub(crate) struct Tetrahedra {
    pub(crate) source: String,
    pub(crate) node_tags: Vec<u64>,
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) element_tags: Vec<u64>,
    /// Nodes of each tetrahedron, 4 or 10, of which some on edges may be [`MISSING`].
    pub(crate) elements: Vec<Vec<u32>>,
    /// Names of groups and their tetrahedra.
    pub(crate) groups: Vec<(String, Vec<u32>)>,
    /// Names of surfaces and the corners of their triangles.
    pub(crate) surfaces: Vec<(String, Vec<[u32; 3]>)>,
    pub(crate) node_groups: Vec<(String, Vec<u32>)>,
}

impl Tetrahedra {
    /// The corners of a face of a tetrahedron, by its number in Abaqus, from 0.
    pub(crate) fn corners(&self, element: usize, face: usize) -> [u32; 3] {
        let [a, b, c, ..] = FACES[face];
        [a, b, c].map(|corner| self.elements[element][corner])
    }

    /// The faces that only one tetrahedron has, with the tetrahedron.
    pub(crate) fn free_faces(&self) -> Vec<(usize, [u32; 3])> {
        let mut count: HashMap<[u32; 3], usize> = HashMap::new();
        let faces = || (0..self.elements.len()).flat_map(|e| (0..4).map(move |face| (e, self.corners(e, face))));
        for (_, corners) in faces() {
            *count.entry(sorted(corners)).or_insert(0) += 1;
        }
        faces().filter(|(_, corners)| count[&sorted(*corners)] == 1).collect()
    }

    /// The mesh, and a sentence on each name that nothing is left of.
    pub(crate) fn mesh(mut self, raise_order: bool) -> Result<(Mesh, Vec<String>), ImportError> {
        let mut notes = Vec::new();
        let linear = self.elements.iter().filter(|nodes| !is_whole(nodes)).count();
        if linear > 0 && !raise_order {
            return Err(self.refuse(
                format!("it has {linear} tetrahedra of first order, or without nodes on some of their edges"),
                "mesh with second-order elements, or set raise_order = true in [body] for straight edges with nodes in their middle",
            ));
        }
        if self.elements.is_empty() {
            return Err(self.refuse("it has no tetrahedra".to_owned(), "mesh the volume with ten-node tetrahedra"));
        }
        let mut elements = self.ordered()?;
        if elements.iter().all(|nodes| self.is_turned(nodes)) {
            // Corners 1 and 2 change places, and with them the nodes on the edges 01 and 02, 23 and 13.
            elements.iter_mut().for_each(|nodes| *nodes = [0, 2, 1, 3, 6, 5, 4, 7, 9, 8].map(|k| nodes[k]));
            notes.push(format!(
                "all {} tetrahedra are mirrored or have their nodes the other way round, and are turned",
                elements.len()
            ));
        }
        // Nodes that no tetrahedron has are left out.
        let used: HashSet<u32> = elements.iter().flatten().copied().collect();
        let mut seen = HashSet::with_capacity(used.len());
        let is_unique = used.iter().all(|node| seen.insert(self.node_tags[*node as usize]));
        let tag = |node: u32| if is_unique { self.node_tags[node as usize] } else { u64::from(node) + 1 };
        let kept = || (0..self.positions.len() as u32).filter(|node| used.contains(node));

        let asked: HashSet<[u32; 3]> =
            self.surfaces.iter().flat_map(|(_, triangles)| triangles).map(|corners| sorted(*corners)).collect();
        let mut faces: HashMap<[u32; 3], [u32; 6]> = HashMap::new();
        for nodes in &elements {
            for face in FACES {
                let face = face.map(|a| nodes[a]);
                let key = sorted([face[0], face[1], face[2]]);
                if asked.contains(&key) {
                    faces.entry(key).or_insert(face);
                }
            }
        }
        let mut surfaces = Vec::new();
        let mut next_tag = 1;
        for (name, triangles) in &self.surfaces {
            let found: Vec<[u64; 6]> =
                triangles.iter().filter_map(|corners| faces.get(&sorted(*corners))).map(|face| face.map(tag)).collect();
            if found.len() < triangles.len() || found.is_empty() {
                notes.push(format!(
                    "of the surface {name}, {} of {} faces are faces of tetrahedra",
                    found.len(),
                    triangles.len()
                ));
            }
            if !found.is_empty() {
                let triangle_tags = (next_tag..).take(found.len()).collect();
                next_tag += found.len() as u64;
                surfaces.push(SurfaceGroup { name: name.clone(), triangle_tags, triangles: found });
            }
        }
        let mut of_element: Vec<Vec<usize>> = vec![Vec::new(); elements.len()];
        let groups: Vec<_> = self.groups.iter().filter(|(_, members)| !members.is_empty()).collect();
        for (group, (_, members)) in groups.iter().enumerate() {
            members.iter().for_each(|element| of_element[*element as usize].push(group));
        }
        let mut known: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        let mut regions = Vec::new();
        let mut element_regions = Vec::with_capacity(elements.len());
        for of in of_element {
            let region = *known.entry(of).or_insert_with_key(|of| {
                regions.push(of.clone());
                regions.len() - 1
            });
            element_regions.push(region);
        }
        let node_groups = self.node_groups.iter().filter_map(|(name, nodes)| {
            let nodes: Vec<u64> = nodes.iter().filter(|node| used.contains(node)).map(|node| tag(*node)).collect();
            if nodes.is_empty() {
                notes.push(format!("the node set {name} has no nodes of the body"));
            }
            (!nodes.is_empty()).then(|| NodeGroup { name: name.clone(), dimension: 0, nodes })
        });
        let node_groups = node_groups.collect();
        let mut seen = HashSet::new();
        let is_unique_element = self.element_tags.iter().all(|tag| seen.insert(*tag));
        let parts = MeshParts {
            source: self.source.clone(),
            node_tags: kept().map(tag).collect(),
            positions: kept().map(|node| self.positions[node as usize]).collect(),
            element_tags: if is_unique_element {
                self.element_tags.clone()
            } else {
                (1..=elements.len() as u64).collect()
            },
            elements: elements.iter().map(|nodes| nodes.map(tag)).collect(),
            groups: groups.iter().map(|(name, _)| name.clone()).collect(),
            regions,
            element_regions,
            surfaces,
            node_groups,
        };
        Ok((Mesh::new(parts)?, notes))
    }

    /// True if the volume between the corners is negative.
    fn is_turned(&self, nodes: &[u32; 10]) -> bool {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.positions[nodes[k] as usize]);
        let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let across = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
        u[0] * across[0] + u[1] * across[1] + u[2] * across[2] < 0.0
    }

    fn refuse(&self, found: String, help: &str) -> ImportError {
        ImportError::Refused { source_name: self.source.clone(), found, help: help.to_owned() }
    }

    /// The elements with the nodes on their edges in gmsh's order, found from where these are; those of first order get new ones.
    fn ordered(&mut self) -> Result<Vec<[u32; 10]>, ImportError> {
        let at = |positions: &[[f64; 3]], node: u32| positions[node as usize];
        let mut orders: HashMap<[usize; 6], usize> = HashMap::new();
        let order_of = |nodes: &[u32], positions: &[[f64; 3]]| -> [usize; 6] {
            EDGES.map(|[a, b]| {
                let (a, b) = (at(positions, nodes[a]), at(positions, nodes[b]));
                let far = |k: usize| -> f64 {
                    let there = at(positions, nodes[4 + k]);
                    (0..3).map(|i| (there[i] - 0.5 * (a[i] + b[i])).powi(2)).sum()
                };
                (0..6).min_by(|i, j| far(*i).total_cmp(&far(*j))).unwrap_or(0)
            })
        };
        for nodes in self.elements.iter().filter(|nodes| is_whole(nodes)) {
            *orders.entry(order_of(nodes, &self.positions)).or_insert(0) += 1;
        }
        let order =
            orders.iter().max_by_key(|(order, count)| (**count, **order)).map_or(OF_NASTRAN, |(order, _)| *order);
        let mut each = order;
        each.sort_unstable();
        if each != [0, 1, 2, 3, 4, 5] {
            return Err(self.refuse(
                "the nodes on the edges of its tetra10 elements are not between their corners".to_owned(),
                "check the order of nodes",
            ));
        }
        // In a sliver the middles of two edges are so near to each other that they are mistaken, which is no other order.
        let mut shared: HashMap<[u32; 2], u32> = HashMap::new();
        let is_usual = |nodes: &&Vec<u32>| is_whole(nodes) && order_of(nodes, &self.positions) == order;
        for nodes in self.elements.iter().filter(is_usual) {
            for (edge, [a, b]) in EDGES.iter().enumerate() {
                shared.insert(edge_key(nodes[*a], nodes[*b]), nodes[4 + order[edge]]);
            }
        }
        let is_other = |nodes: &[u32]| {
            let x = |k: usize| at(&self.positions, nodes[k]);
            let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
            let longest = EDGES.iter().map(|[a, b]| apart(x(*a), x(*b))).fold(0.0, f64::max);
            EDGES.iter().enumerate().any(|(edge, [a, b])| {
                let node = 4 + order[edge];
                let middle = std::array::from_fn(|i| 0.5 * (x(*a)[i] + x(*b)[i]));
                apart(x(node), middle) > FAR * longest
                    || shared.get(&edge_key(nodes[*a], nodes[*b])).is_some_and(|other| *other != nodes[node])
            })
        };
        let count = self.elements.iter().filter(|nodes| is_whole(nodes)).count();
        let numbered = self.elements.iter().zip(&self.element_tags);
        let others: Vec<u64> = numbered
            .filter(|(nodes, _)| is_whole(nodes) && order_of(nodes, &self.positions) != order && is_other(nodes))
            .map(|(_, tag)| *tag)
            .collect();
        if let Some(first) = others.first() {
            return Err(self.refuse(
                format!(
                    "{} of its {count} tetra10 elements have nodes on edges in another order than the others, the first is {first}",
                    others.len()
                ),
                "check the order of nodes, or mesh again with less curved elements",
            ));
        }
        let mut between: HashMap<[u32; 2], u32> = HashMap::new();
        let mut ordered = vec![[MISSING; 10]; self.elements.len()];
        for (found, nodes) in ordered.iter_mut().zip(&self.elements) {
            found[..4].copy_from_slice(&nodes[..4]);
            if nodes.len() == 10 {
                for (edge, [a, b]) in EDGES.iter().enumerate() {
                    found[4 + edge] = nodes[4 + order[edge]];
                    if found[4 + edge] != MISSING {
                        between.insert(edge_key(nodes[*a], nodes[*b]), found[4 + edge]);
                    }
                }
            }
        }
        let mut next = self.node_tags.iter().max().copied().unwrap_or(0);
        for (found, nodes) in ordered.iter_mut().zip(&self.elements).filter(|(_, nodes)| !is_whole(nodes)) {
            for (edge, [a, b]) in EDGES.iter().enumerate() {
                if found[4 + edge] != MISSING {
                    continue;
                }
                let ends = [nodes[*a], nodes[*b]];
                let (positions, tags) = (&mut self.positions, &mut self.node_tags);
                found[4 + edge] = *between.entry(edge_key(ends[0], ends[1])).or_insert_with(|| {
                    let [a, b] = ends.map(|node| positions[node as usize]);
                    positions.push(std::array::from_fn(|i| 0.5 * (a[i] + b[i])));
                    next = next.wrapping_add(1);
                    tags.push(next);
                    positions.len() as u32 - 1
                });
            }
        }
        Ok(ordered)
    }
}

/// The order of nodes on edges where no element shows it: that of Nastran, the only one that leaves some out.
const OF_NASTRAN: [usize; 6] = [0, 1, 2, 3, 5, 4];

/// True of a tetrahedron with all its ten nodes.
fn is_whole(nodes: &[u32]) -> bool {
    nodes.len() == 10 && !nodes.contains(&MISSING)
}

fn edge_key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: corners of a square, one of them a little higher. The middles of its diagonals are 0.01 apart, and the nodes on
    /// them each nearer to the other; another element has the edge, so that its node is known.
    #[test]
    fn nodes_of_a_sliver_are_not_taken_for_another_order() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.02], [0.0, 1.0, 0.0], [0.4, 0.3, 1.0]];
        let mut found =
            Tetrahedra { node_tags: (1..6).collect(), positions: corners.to_vec(), ..Tetrahedra::default() };
        let mut between: HashMap<[u32; 2], u32> = HashMap::new();
        for corners in [[0, 1, 2, 3], [0, 1, 2, 4], [0, 2, 3, 4]] {
            let mut nodes = corners.to_vec();
            for [a, b] in EDGES.map(|[a, b]| [corners[a], corners[b]]) {
                let (positions, tags) = (&mut found.positions, &mut found.node_tags);
                nodes.push(*between.entry(edge_key(a, b)).or_insert_with(|| {
                    let [a, b] = [a, b].map(|node| positions[node as usize]);
                    positions.push(std::array::from_fn(|i| 0.5 * (a[i] + b[i])));
                    tags.push(positions.len() as u64);
                    positions.len() as u32 - 1
                }));
            }
            found.element_tags.push(found.elements.len() as u64 + 1);
            found.elements.push(nodes);
        }
        found.positions[between[&[0, 2]] as usize][2] = 0.002;
        found.positions[between[&[1, 3]] as usize][2] = 0.008;
        let ordered = found.ordered().unwrap();
        assert!(ordered.iter().zip(&found.elements).all(|(ordered, nodes)| ordered[..] == nodes[..]));
        // Nodes that are on other edges are found as before.
        found.elements[1].swap(4, 5);
        let said = found.ordered().unwrap_err().to_string();
        assert!(said.contains("in another order"), "{said}");
    }
}
