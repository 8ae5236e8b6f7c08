//! Where stress is known: at a node between two materials it has a value in each.

use std::ops::Range;

use crate::assembly::coupling::Incidence;
use crate::material::Material;
use crate::mesh::checked::Mesh;
use crate::mesh::locate::Location;

/// A weight of a node below which a point is not at it.
const WEIGHTLESS: f64 = 1e-6;

/// The places of nodal stress: every node, once for each material of the elements around it. In a body of one material
/// site i is node i. By node, ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct StressSites {
    nodes: Vec<u32>,
    /// First site of each node, and the end.
    starts: Vec<usize>,
    /// The sites of the ten nodes of each element.
    of_elements: Vec<[u32; 10]>,
}

impl StressSites {
    pub(super) fn new(mesh: &Mesh, materials: &[Material], incidence: &Incidence) -> Self {
        let (mut nodes, mut starts) = (Vec::new(), vec![0]);
        let mut of_elements = vec![[0; 10]; mesh.elements().len()];
        let mut here: Vec<Material> = Vec::new();
        for node in 0..mesh.positions().len() {
            here.clear();
            for &(element, a) in incidence.of(node) {
                let material = materials[element as usize];
                let place = here.iter().position(|m| *m == material).unwrap_or_else(|| {
                    here.push(material);
                    nodes.push(node as u32);
                    here.len() - 1
                });
                of_elements[element as usize][a as usize] = (starts[node] + place) as u32;
            }
            starts.push(nodes.len());
        }
        Self { nodes, starts, of_elements }
    }

    /// Their number m.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True if there are none; a mesh always has some.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The node of each site.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The sites of a node.
    ///
    /// # Panics
    /// Where there is no such node.
    pub fn of_node(&self, node: u32) -> Range<usize> {
        self.starts[node as usize]..self.starts[node as usize + 1]
    }

    pub(super) fn of_element(&self, element: usize) -> &[u32; 10] {
        &self.of_elements[element]
    }

    /// For each material at a point, sites and weights whose mean is the stress there.
    ///
    /// # Panics
    /// Where the location is not one of the mesh.
    pub fn at(&self, location: &Location) -> Vec<Vec<(usize, f64)>> {
        let weighty = || location.nodes.iter().zip(&location.weights).filter(|(_, w)| w.abs() > WEIGHTLESS);
        let total: f64 = weighty().map(|(_, w)| w).sum();
        let mut found: Vec<Vec<(usize, f64)>> = Vec::new();
        for element in &self.of_elements {
            let site = |node: u32| element.iter().copied().find(|site| self.nodes[*site as usize] == node);
            let Some(sites) =
                weighty().map(|(node, w)| Some((site(*node)? as usize, w / total))).collect::<Option<Vec<_>>>()
            else {
                continue;
            };
            if !found.contains(&sites) {
                found.push(sites);
            }
        }
        found
    }
}
