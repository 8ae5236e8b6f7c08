//! A mesh of ten-node tetrahedra that is fit to compute with: checked when it is made.

use std::collections::HashMap;

use crate::error::MeshError;
use crate::integration;
use crate::surface::{self, Surface};

/// What is grouped, by its dimension.
pub(crate) const KINDS: [&str; 4] = ["point", "curve", "surface", "volume"];

/// The raw parts of a mesh, from a file or from a program; [`Mesh::new`] checks them.
#[derive(Debug, Clone, Default)]
pub struct MeshParts {
    /// What to call the mesh in messages: the file's path.
    pub source: String,
    /// Tags of the nodes, in the file's numbering.
    pub node_tags: Vec<u64>,
    /// Positions of the nodes (n×3).
    pub positions: Vec<[f64; 3]>,
    /// Tags of the elements, in the file's numbering.
    pub element_tags: Vec<u64>,
    /// Node *tags* of each element, in gmsh's order: corners, then mid-edges 01 12 02 03 23 13.
    pub elements: Vec<[u64; 10]>,
    /// Names of the volume physical groups.
    pub groups: Vec<String>,
    /// The regions of the body (gmsh's volume entities): for each, the indices of the groups it is in.
    pub regions: Vec<Vec<usize>>,
    /// For each element, the index of its region.
    pub element_regions: Vec<usize>,
    /// The surface physical groups.
    pub surfaces: Vec<SurfaceGroup>,
    /// The physical groups of curves and points.
    pub node_groups: Vec<NodeGroup>,
}

/// A physical group of surfaces, among the parts of a mesh.
#[derive(Debug, Clone, Default)]
pub struct SurfaceGroup {
    /// Its name.
    pub name: String,
    /// Tags of its triangles, in the file's numbering.
    pub triangle_tags: Vec<u64>,
    /// Node *tags* of each triangle, in gmsh's order: corners, either way round, then mid-edges 01 12 20.
    pub triangles: Vec<[u64; 6]>,
}

/// A physical group of curves or points, among the parts of a mesh.
#[derive(Debug, Clone)]
pub struct NodeGroup {
    /// Its name.
    pub name: String,
    /// 0 for points, 1 for curves.
    pub dimension: usize,
    /// Tags of the nodes of its elements, in any order, each as often as it comes.
    pub nodes: Vec<u64>,
}

/// A mesh of ten-node tetrahedra in one piece, every node in use and every element the right way round.
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
                return Err(MeshError::Lengths { source_name: source, what, expected, found });
            }
        }
        if elements.is_empty() {
            return Err(MeshError::NoElements { source_name: source });
        }
        if let Some((&node, &position)) =
            node_tags.iter().zip(&positions).find(|(_, x)| x.iter().any(|c| !c.is_finite()))
        {
            return Err(MeshError::NotFinite { source_name: source, node, position });
        }
        if let Some((&region, &element)) =
            element_regions.iter().zip(&element_tags).find(|(region, _)| **region >= regions.len())
        {
            return Err(MeshError::UnknownRegion { source_name: source, element, region, count: regions.len() });
        }
        if let Some((region, group)) = (0..)
            .zip(&regions)
            .find_map(|(region, in_groups)| Some((region, *in_groups.iter().find(|group| **group >= groups.len())?)))
        {
            return Err(MeshError::UnknownGroup { source_name: source, region, group, count: groups.len() });
        }
        let index_of = index_nodes(&source, &node_tags)?;
        let elements = resolve_tags(&source, &index_of, &element_tags, &elements)?;
        let surfaces = surface::resolve(&source, &index_of, &elements, surfaces)?;
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
        integration::check_jacobians(&mesh)?;
        mesh.refuse_pieces()?;
        Ok(mesh)
    }

    /// What the mesh is called in messages: its file.
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

    /// Length of the diagonal of the box around the mesh.
    pub fn diagonal(&self) -> f64 {
        (0..3)
            .map(|axis| {
                let (low, high) = self
                    .positions
                    .iter()
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[axis]), h.max(x[axis])));
                (high - low).powi(2)
            })
            .sum::<f64>()
            .sqrt()
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
            Err(MeshError::SameElement { source_name: self.source.clone(), first, second })
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
            count => Err(MeshError::OrphanNodes {
                source_name: self.source.clone(),
                count,
                tags: orphans().take(5).collect(),
            }),
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
        Err(MeshError::Pieces {
            source_name: self.source.clone(),
            sizes: pieces.iter().map(|(size, _)| *size).collect(),
            examples: pieces.iter().map(|(_, first)| self.element_tags[*first]).collect(),
        })
    }
}

fn duplicate(source: &str, kind: &'static str, tag: u64) -> MeshError {
    MeshError::DuplicateTag { source_name: source.to_owned(), kind, tag }
}

/// Index of a node by its tag.
fn index_nodes(source: &str, node_tags: &[u64]) -> Result<HashMap<u64, u32>, MeshError> {
    let mut index_of: HashMap<u64, u32> = HashMap::with_capacity(node_tags.len());
    for (index, tag) in node_tags.iter().enumerate() {
        if index_of.insert(*tag, index as u32).is_some() {
            return Err(duplicate(source, "node", *tag));
        }
    }
    Ok(index_of)
}

/// The nodes of an element, by index.
pub(crate) fn indices<const N: usize>(
    source: &str,
    index_of: &HashMap<u64, u32>,
    element: u64,
    nodes: &[u64; N],
) -> Result<[u32; N], MeshError> {
    let mut indices = [0; N];
    for (index, node) in indices.iter_mut().zip(nodes) {
        *index = *index_of.get(node).ok_or_else(|| MeshError::UnknownNode {
            source_name: source.to_owned(),
            element,
            node: *node,
        })?;
    }
    Ok(indices)
}

/// Turns node tags into indices.
fn resolve_tags(
    source: &str,
    index_of: &HashMap<u64, u32>,
    element_tags: &[u64],
    elements: &[[u64; 10]],
) -> Result<Vec<[u32; 10]>, MeshError> {
    let mut sorted = element_tags.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(duplicate(source, "element", pair[0]));
    }
    elements.iter().zip(element_tags).map(|(nodes, tag)| indices(source, index_of, *tag, nodes)).collect()
}

fn resolve_node_groups(
    source: &str,
    index_of: &HashMap<u64, u32>,
    groups: Vec<NodeGroup>,
) -> Result<Vec<NodeSet>, MeshError> {
    let resolve = |group: NodeGroup| {
        let kind = KINDS[group.dimension.min(1)];
        let index = |node: &u64| {
            index_of.get(node).copied().ok_or_else(|| MeshError::UnknownGroupNode {
                source_name: source.to_owned(),
                kind,
                group: group.name.clone(),
                node: *node,
            })
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
