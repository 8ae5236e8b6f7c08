//! A mesh of ten-node tetrahedra that is fit to compute with: checked when it is made.

use std::collections::HashMap;

use crate::element::integration::{self, BadJacobian};
use crate::element::shape::EDGES;
use crate::error::{MeshError, MeshFault};
use crate::mesh::faces::{self, Surface};
use crate::mesh::parts::{MeshParts, NodeGroup, SurfaceGroup};
use crate::mesh::tags::{index_nodes, resolve_tags};

/// Names of the entities in groups, by dimension.
pub(crate) const KINDS: [&str; 4] = ["point", "curve", "surface", "volume"];

/// A mesh of ten-node tetrahedra in one piece, every node in use and every element the right way round; or only the nodes of a
/// body whose matrices come from elsewhere ([`Mesh::of_nodes`]).
#[derive(Debug, Clone)]
pub struct Mesh {
    source: String,
    node_tags: Vec<u64>,
    positions: Vec<[f64; 3]>,
    element_tags: Vec<u64>,
    elements: Vec<[u32; 10]>,
    groups: Vec<String>,
    regions: Vec<Vec<usize>>,
    element_regions: Vec<usize>,
    surfaces: Vec<Surface>,
    node_sets: Vec<NodeSet>,
}

/// A physical group of curves or points.
#[derive(Debug, Clone)]
pub(crate) struct NodeSet {
    /// "curve" or "point".
    pub kind: &'static str,
    pub name: String,
    /// Node indices, ascending.
    pub nodes: Vec<u32>,
}

impl Mesh {
    /// Checks the parts and makes a mesh of them.
    ///
    /// # Errors
    /// Lengths that do not agree, tags given twice or unknown, elements with the same corners, coordinates that are not finite, regions and groups
    /// that are not in their lists, surfaces that are no faces of the body, inverted or degenerate elements, nodes of no
    /// element, several pieces.
    pub fn new(parts: MeshParts) -> Result<Self, MeshError> {
        let MeshParts {
            source,
            node_tags,
            positions,
            element_tags,
            elements,
            groups,
            regions,
            element_regions,
            surfaces,
            node_groups,
        } = parts;
        let lengths = [
            ("node tags", positions.len(), node_tags.len()),
            ("element tags", elements.len(), element_tags.len()),
            ("element regions", elements.len(), element_regions.len()),
        ];
        let of_surfaces = surfaces.iter().map(|s| ("triangle tags", s.triangles.len(), s.triangle_tags.len()));
        for (what, expected, found) in lengths.into_iter().chain(of_surfaces) {
            if expected != found {
                return Err(MeshFault::Lengths { what, expected, found }.of(source));
            }
        }
        if elements.is_empty() {
            return Err(MeshFault::NoElements.of(source));
        }
        refuse_not_finite(&source, &node_tags, &positions)?;
        if let Some((&region, &element)) =
            element_regions.iter().zip(&element_tags).find(|(region, _)| **region >= regions.len())
        {
            return Err(MeshFault::UnknownRegion { element, region, count: regions.len() }.of(source));
        }
        if let Some((region, group)) = (0..)
            .zip(&regions)
            .find_map(|(region, in_groups)| Some((region, *in_groups.iter().find(|group| **group >= groups.len())?)))
        {
            return Err(MeshFault::UnknownGroup { region, group, count: groups.len() }.of(source));
        }
        let index_of = index_nodes(&source, &node_tags)?;
        let elements = resolve_tags(&source, &index_of, &element_tags, &elements)?;
        let surfaces = faces::resolve(&source, &index_of, &elements, surfaces)?;
        let node_sets = resolve_node_groups(&source, &index_of, node_groups)?;
        let mesh = Self {
            source,
            node_tags,
            positions,
            element_tags,
            elements,
            groups,
            regions,
            element_regions,
            surfaces,
            node_sets,
        };
        mesh.refuse_same_elements()?;
        mesh.refuse_orphans()?;
        mesh.refuse_bad_jacobians()?;
        mesh.refuse_pieces()?;
        Ok(mesh)
    }

    /// Nodes without elements. What needs elements finds none: faces, surfaces, points between nodes.
    ///
    /// # Errors
    /// Tags given twice, tags of groups that no node has, coordinates that are not finite.
    pub fn of_nodes(
        source: String,
        node_tags: Vec<u64>,
        positions: Vec<[f64; 3]>,
        groups: Vec<NodeGroup>,
    ) -> Result<Self, MeshError> {
        if positions.len() != node_tags.len() {
            let (expected, found) = (positions.len(), node_tags.len());
            return Err(MeshFault::Lengths { what: "node tags", expected, found }.of(source));
        }
        refuse_not_finite(&source, &node_tags, &positions)?;
        let index_of = index_nodes(&source, &node_tags)?;
        let node_sets = resolve_node_groups(&source, &index_of, groups)?;
        Ok(Self {
            source,
            node_tags,
            positions,
            element_tags: Vec::new(),
            elements: Vec::new(),
            groups: Vec::new(),
            regions: Vec::new(),
            element_regions: Vec::new(),
            surfaces: Vec::new(),
            node_sets,
        })
    }

    /// True if it has elements.
    pub fn has_elements(&self) -> bool {
        !self.elements.is_empty()
    }

    /// The parts that [`Mesh::new`] makes the same mesh of.
    pub fn parts(&self) -> MeshParts {
        let tag = |node: u32| self.node_tags[node as usize];
        let surface = |surface: &Surface| SurfaceGroup {
            name: surface.name.clone(),
            triangle_tags: surface.faces.iter().map(|face| face.tag).collect(),
            triangles: surface.faces.iter().map(|face| face.nodes.map(tag)).collect(),
        };
        let node_group = |set: &NodeSet| NodeGroup {
            name: set.name.clone(),
            dimension: KINDS.iter().position(|kind| *kind == set.kind).unwrap_or(0),
            nodes: set.nodes.iter().map(|node| tag(*node)).collect(),
        };
        MeshParts {
            source: self.source.clone(),
            node_tags: self.node_tags.clone(),
            positions: self.positions.clone(),
            element_tags: self.element_tags.clone(),
            elements: self.elements.iter().map(|nodes| nodes.map(tag)).collect(),
            groups: self.groups.clone(),
            regions: self.regions.clone(),
            element_regions: self.element_regions.clone(),
            surfaces: self.surfaces.iter().map(surface).collect(),
            node_groups: self.node_sets.iter().map(node_group).collect(),
        }
    }

    /// Name of the mesh in messages: its file.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Positions of the nodes (n×3).
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Tags of the nodes in the file's numbering.
    pub fn node_tags(&self) -> &[u64] {
        &self.node_tags
    }

    /// Node indices of each element, in gmsh's order: corners, then mid-edges 01 12 02 03 23 13.
    pub fn elements(&self) -> &[[u32; 10]] {
        &self.elements
    }

    /// For each node the two nodes at the ends of the edge that it is in the middle of, and twice itself for a corner. None
    /// where a node is a corner of one element and in the middle of an edge of another, or in the middle of two edges.
    pub fn edge_ends(&self) -> Option<Vec<[u32; 2]>> {
        let mut ends: Vec<[u32; 2]> = (0..self.positions.len() as u32).map(|node| [node; 2]).collect();
        for nodes in &self.elements {
            for ([a, b], middle) in EDGES.iter().zip(&nodes[4..]) {
                let (found, edge) = (&mut ends[*middle as usize], [nodes[*a].min(nodes[*b]), nodes[*a].max(nodes[*b])]);
                if *found != [*middle; 2] && *found != edge {
                    return None;
                }
                *found = edge;
            }
        }
        let is_corner = |node: &u32| ends[*node as usize] == [*node; 2];
        ends.iter().flatten().all(is_corner).then_some(ends)
    }

    /// Tags of the elements in the file's numbering.
    pub fn element_tags(&self) -> &[u64] {
        &self.element_tags
    }

    /// Names of the volume physical groups.
    pub fn groups(&self) -> &[String] {
        &self.groups
    }

    /// Indices of the groups that an element is in: none, one or several.
    pub fn element_groups(&self, element: usize) -> &[usize] {
        self.element_regions.get(element).map_or(&[], |region| &self.regions[*region])
    }

    /// Node indices of the faces on the surface of the body, seen from outside: corners, then mid-edges 01 12 20.
    pub fn outer_faces(&self) -> Vec<[u32; 6]> {
        faces::outer(&self.elements)
    }

    /// The surface physical groups.
    pub(crate) fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The physical groups of curves and points.
    pub(crate) fn node_sets(&self) -> &[NodeSet] {
        &self.node_sets
    }

    /// Positions of the ten nodes of an element.
    pub(crate) fn element_positions(&self, element: usize) -> [[f64; 3]; 10] {
        self.elements[element].map(|node| self.positions[node as usize])
    }

    /// Extent along the three axes: the edges of the box around the mesh.
    pub fn size(&self) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let extend = |(l, h): (f64, f64), x: &[f64; 3]| (l.min(x[axis]), h.max(x[axis]));
            let (low, high) = self.positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), extend);
            high - low
        })
    }

    /// Length of the diagonal of the box around the mesh.
    pub fn diagonal(&self) -> f64 {
        self.size().iter().map(|edge| edge * edge).sum::<f64>().sqrt()
    }

    /// How much the worst element is distorted by its curved edges: its smallest Jacobian determinant over that of the
    /// straight element with the same corners. It is 1 where all edges are straight; an element near 0 is nearly inverted.
    pub fn least_scaled_jacobian(&self) -> f64 {
        integration::least_scaled_jacobian(self.elements.len(), |e| self.element_positions(e))
    }

    /// The Jacobians are looked at later: two elements with the same corners fill the same space.
    fn refuse_same_elements(&self) -> Result<(), MeshError> {
        let corners = |nodes: &[u32; 10]| {
            let mut corners = [nodes[0], nodes[1], nodes[2], nodes[3]];
            corners.sort_unstable();
            corners
        };
        let mut sorted: Vec<_> = (0..).zip(&self.elements).map(|(e, nodes)| (corners(nodes), e)).collect();
        sorted.sort_unstable();
        let same = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0);
        let tag = |e: usize| self.element_tags[e];
        same.map_or(Ok(()), |pair| {
            let (first, second) = (tag(pair[0].1), tag(pair[1].1));
            Err(MeshFault::SameElement { first, second }.of(&self.source))
        })
    }

    fn refuse_orphans(&self) -> Result<(), MeshError> {
        let mut used = vec![false; self.positions.len()];
        for node in self.elements.iter().flatten() {
            used[*node as usize] = true;
        }
        let orphans = || used.iter().zip(&self.node_tags).filter(|(used, _)| !**used).map(|(_, tag)| *tag);
        match orphans().count() {
            0 => Ok(()),
            count => Err(MeshFault::OrphanNodes { count, tags: orphans().take(5).collect() }.of(&self.source)),
        }
    }

    /// Elements that are inverted or have no volume at a node or at an integration point.
    fn refuse_bad_jacobians(&self) -> Result<(), MeshError> {
        match integration::first_bad_jacobian(self.elements.len(), |e| self.element_positions(e)) {
            None => Ok(()),
            Some(BadJacobian { element, what, jacobian, expected }) => {
                Err(MeshFault::Jacobian { element: self.element_tags[element], what, jacobian, expected }
                    .of(&self.source))
            }
        }
    }

    fn refuse_pieces(&self) -> Result<(), MeshError> {
        let mut sets = DisjointSets::new(self.positions.len());
        for nodes in &self.elements {
            for node in &nodes[1..] {
                sets.join(nodes[0] as usize, *node as usize);
            }
        }
        // Root of a piece -> (number of elements, index of the first).
        let mut pieces: HashMap<usize, (usize, usize)> = HashMap::new();
        for (e, nodes) in self.elements.iter().enumerate() {
            pieces.entry(sets.root(nodes[0] as usize)).or_insert((0, e)).0 += 1;
        }
        if pieces.len() == 1 {
            return Ok(());
        }
        let mut pieces: Vec<_> = pieces.into_values().collect();
        pieces.sort_by_key(|(size, first)| (std::cmp::Reverse(*size), *first));
        Err(MeshFault::Pieces {
            sizes: pieces.iter().map(|(size, _)| *size).collect(),
            examples: pieces.iter().map(|(_, first)| self.element_tags[*first]).collect(),
        }
        .of(&self.source))
    }
}

fn refuse_not_finite(source: &str, node_tags: &[u64], positions: &[[f64; 3]]) -> Result<(), MeshError> {
    match node_tags.iter().zip(positions).find(|(_, x)| x.iter().any(|c| !c.is_finite())) {
        Some((&node, &position)) => Err(MeshFault::NotFinite { node, position }.of(source)),
        None => Ok(()),
    }
}

fn resolve_node_groups(
    source: &str,
    index_of: &HashMap<u64, u32>,
    groups: Vec<NodeGroup>,
) -> Result<Vec<NodeSet>, MeshError> {
    let resolve = |group: NodeGroup| {
        let kind = KINDS[group.dimension.min(1)];
        let index = |node: &u64| {
            index_of
                .get(node)
                .copied()
                .ok_or_else(|| MeshFault::UnknownGroupNode { kind, group: group.name.clone(), node: *node }.of(source))
        };
        let mut nodes = group.nodes.iter().map(index).collect::<Result<Vec<u32>, _>>()?;
        nodes.sort_unstable();
        nodes.dedup();
        Ok(NodeSet { kind, name: group.name, nodes })
    };
    groups.into_iter().map(resolve).collect()
}

/// Union–find with path halving.
struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    fn new(len: usize) -> Self {
        Self { parent: (0..len).collect() }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}
