//! Physical surfaces as faces of the body.

use std::collections::{HashMap, HashSet};

use crate::error::{MeshError, MeshFault};
use crate::mesh::parts::SurfaceGroup;
use crate::mesh::tags::indices;

/// Nodes of the faces of a tetrahedron: corners, counter-clockwise seen from outside, then mid-edges 01 12 20.
const FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [0, 3, 2, 7, 8, 6]];

/// A physical surface.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub name: String,
    pub faces: Vec<Face>,
}

/// A face of a tetrahedron.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Tag of the element that the file has there.
    pub tag: u64,
    /// As in [`FACES`], seen from outside of the first tetrahedron that has the face.
    pub nodes: [u32; 6],
    /// True if a second tetrahedron has it.
    pub inner: bool,
}

impl Surface {
    /// The nodes of its faces, ascending.
    pub(crate) fn nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.faces.iter().flat_map(|face| face.nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// The faces that only one tetrahedron has, seen from outside, in the order of the elements.
pub(crate) fn outer(elements: &[[u32; 10]]) -> Vec<[u32; 6]> {
    let mut faces: Vec<([u32; 3], usize, [u32; 6])> = Vec::with_capacity(4 * elements.len());
    for element in elements {
        for face in FACES {
            let nodes = face.map(|a| element[a]);
            let mut corners = [nodes[0], nodes[1], nodes[2]];
            corners.sort_unstable();
            faces.push((corners, faces.len(), nodes));
        }
    }
    faces.sort_unstable();
    let mut outer: Vec<_> = faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).flatten().collect();
    outer.sort_unstable_by_key(|(_, place, _)| *place);
    outer.into_iter().map(|(_, _, nodes)| *nodes).collect()
}

/// Finds the faces of the body that the triangles of each group are; a face that a group has twice counts once.
pub(crate) fn resolve(
    source: &str,
    index_of: &HashMap<u64, u32>,
    elements: &[[u32; 10]],
    groups: Vec<SurfaceGroup>,
) -> Result<Vec<Surface>, MeshError> {
    if groups.is_empty() {
        return Ok(Vec::new());
    }
    let key = |nodes: &[u32; 6]| {
        let mut corners = [nodes[0], nodes[1], nodes[2]];
        corners.sort_unstable();
        corners
    };
    // Corners -> nodes and whether two tetrahedra have the face, for the faces that the groups ask for.
    let mut found: HashMap<[u32; 3], Option<([u32; 6], bool)>> = HashMap::new();
    let mut asked = Vec::with_capacity(groups.len());
    for group in groups {
        let mut triangles = Vec::with_capacity(group.triangles.len());
        for (nodes, tag) in group.triangles.iter().zip(&group.triangle_tags) {
            let nodes = indices(source, index_of, *tag, nodes)?;
            found.insert(key(&nodes), None);
            triangles.push((*tag, nodes));
        }
        asked.push((group.name, triangles));
    }
    for element in elements {
        for face in FACES {
            let nodes = face.map(|a| element[a]);
            match found.get_mut(&key(&nodes)) {
                Some(Some((_, inner))) => *inner = true,
                Some(first) => *first = Some((nodes, false)),
                None => {}
            }
        }
    }
    let sorted = |mut nodes: [u32; 6]| {
        nodes.sort_unstable();
        nodes
    };
    let resolve = |(name, triangles): (String, Vec<(u64, [u32; 6])>)| {
        let mut faces = Vec::with_capacity(triangles.len());
        let mut taken = HashSet::with_capacity(triangles.len());
        for (tag, triangle) in triangles {
            match found.get(&key(&triangle)).copied().flatten() {
                Some((nodes, inner)) if sorted(nodes) == sorted(triangle) => {
                    if taken.insert(key(&nodes)) {
                        faces.push(Face { tag, nodes, inner });
                    }
                }
                _ => {
                    return Err(MeshFault::NotAFace { group: name, element: tag }.of(source));
                }
            }
        }
        Ok(Surface { name, faces })
    };
    asked.into_iter().map(resolve).collect()
}
