//! Physical surfaces: faces of the body, and the nodal forces of what is spread over them.
//!
//! ```text
//! w_i = ∫ N_i dA        f_i = −∫ N_i n dA        n dA = ∂x/∂s × ∂x/∂t ds dt
//! ```

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::AddAssign;

use nalgebra::Vector3;

use crate::error::MeshError;
use crate::mesh::{Mesh, SurfaceGroup, indices};
use crate::quadrature;

/// Nodes of the faces of a tetrahedron: corners, counter-clockwise seen from outside, then mid-edges 01 12 20.
const FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 9, 7], [1, 2, 3, 5, 8, 9], [0, 3, 2, 7, 8, 6]];
/// Corner pairs of the mid-edge nodes of a face.
const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// A physical surface.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub name: String,
    faces: Vec<Face>,
}

/// A face of a tetrahedron.
#[derive(Debug, Clone, Copy)]
struct Face {
    /// Tag of the element that the file has there.
    tag: u64,
    /// As in [`FACES`], seen from outside of the first tetrahedron that has the face.
    nodes: [u32; 6],
    /// Whether a second tetrahedron has it.
    inner: bool,
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
                    return Err(MeshError::NotAFace { source_name: source.to_owned(), group: name, element: tag });
                }
            }
        }
        Ok(Surface { name, faces })
    };
    asked.into_iter().map(resolve).collect()
}

impl Mesh {
    /// Names of the surface physical groups.
    pub fn surface_groups(&self) -> impl Iterator<Item = &str> {
        self.surfaces().iter().map(|surface| surface.name.as_str())
    }

    /// `∫ N_i dA` over a physical surface, an area for each of its nodes: nodes, ascending, and weights.
    ///
    /// A traction (force per area) puts the force weight × traction on a node. The weights sum to the area; those of
    /// the corners of flat faces are zero but for rounding. A face between two tetrahedra counts once.
    ///
    /// # Errors
    /// [`MeshError::NoGroup`] with the names of the surfaces there are.
    pub fn surface_weights(&self, group: &str) -> Result<(Vec<u32>, Vec<f64>), MeshError> {
        Ok(self.integrate(self.surface(group)?, |area| area.norm()))
    }

    /// `−∫ N_i n dA` over a physical surface, the forces of a unit pressure: nodes, ascending, and forces (area, global
    /// axes, on the undeformed body). n points out of the body, whichever way round the file has the triangles.
    ///
    /// Exact on curved faces too, so that resultant and moment of a pressure all round a body vanish.
    ///
    /// # Errors
    /// [`MeshError::NoGroup`] with the names of the surfaces there are; [`MeshError::InnerFace`] for a face that has
    /// the body on both sides.
    pub fn surface_pressure(&self, group: &str) -> Result<(Vec<u32>, Vec<Vector3<f64>>), MeshError> {
        let surface = self.surface(group)?;
        match surface.faces.iter().find(|face| face.inner) {
            None => Ok(self.integrate(surface, |area| -area)),
            Some(face) => Err(MeshError::InnerFace {
                source_name: self.source().to_owned(),
                group: group.to_owned(),
                element: face.tag,
            }),
        }
    }

    fn surface(&self, name: &str) -> Result<&Surface, MeshError> {
        self.surfaces().iter().find(|surface| surface.name == name).ok_or_else(|| MeshError::NoGroup {
            source_name: self.source().to_owned(),
            kind: "surface",
            group: name.to_owned(),
            present: self.surface_groups().map(str::to_owned).collect(),
        })
    }

    /// `∫ N_i value` for each node, where `value` is made of the vector n dA.
    fn integrate<T>(&self, surface: &Surface, value: impl Fn(Vector3<f64>) -> T) -> (Vec<u32>, Vec<T>)
    where
        T: Default + AddAssign + std::ops::Mul<f64, Output = T> + Copy,
    {
        // n dA is of degree 2 and N of degree 2; what is above that is for |n dA| on curved faces.
        let rule: Vec<_> = quadrature::triangle_degree_6().into_iter().map(|(l, w)| (shapes(l), w)).collect();
        let mut sums: BTreeMap<u32, T> = BTreeMap::new();
        for face in &surface.faces {
            // Against the first node, so that rounding is that of the face and not of its distance from the origin.
            let position = face.nodes.map(|node| Vector3::from(self.positions()[node as usize]));
            let relative = position.map(|x| x - position[0]);
            for ((n, slopes), weight) in &rule {
                let tangent = |k: usize| -> Vector3<f64> { relative.iter().zip(slopes).map(|(x, d)| x * d[k]).sum() };
                let value = value(tangent(0).cross(&tangent(1)) * *weight);
                for (node, n) in face.nodes.iter().zip(n) {
                    *sums.entry(*node).or_default() += value * *n;
                }
            }
        }
        sums.into_iter().unzip()
    }
}

/// Shape functions of the six-node triangle at barycentric coordinates, and their slopes along L₁ and L₂.
fn shapes(l: [f64; 3]) -> ([f64; 6], [[f64; 2]; 6]) {
    const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let (mut n, mut dn) = ([0.0; 6], [[0.0; 2]; 6]);
    for a in 0..3 {
        n[a] = l[a] * (2.0 * l[a] - 1.0);
        dn[a] = SLOPES[a].map(|d| (4.0 * l[a] - 1.0) * d);
    }
    for (edge, [a, b]) in EDGES.into_iter().enumerate() {
        n[3 + edge] = 4.0 * l[a] * l[b];
        dn[3 + edge] = [0, 1].map(|k| 4.0 * (l[a] * SLOPES[b][k] + l[b] * SLOPES[a][k]));
    }
    (n, dn)
}
