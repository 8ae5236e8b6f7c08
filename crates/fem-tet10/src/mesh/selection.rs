//! Nodes by where they are, or by the physical group they are in.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use crate::error::{MeshError, MeshFault};
use crate::mesh::checked::{KINDS, Mesh};

impl Mesh {
    /// The nodes of a physical group of volumes, surfaces, curves or points, ascending.
    ///
    /// # Errors
    /// [`MeshFault::NoGroup`] with the names of all groups there are; [`MeshFault::SeveralGroups`] for a name that
    /// groups of several dimensions have.
    pub fn group_nodes(&self, name: &str) -> Result<Vec<u32>, MeshError> {
        let [.., of_surface, of_volume] = KINDS;
        let mut found: Vec<(&'static str, Vec<u32>)> = Vec::new();
        if let Some(group) = self.groups().iter().position(|group| group == name) {
            found.push((of_volume, self.volume_nodes(group)));
        }
        let surfaces = self.surfaces().iter().filter(|surface| surface.name == name);
        found.extend(surfaces.map(|surface| (of_surface, surface.nodes())));
        let sets = self.node_sets().iter().filter(|set| set.name == name);
        found.extend(sets.map(|set| (set.kind, set.nodes.clone())));
        match found.pop() {
            Some((_, nodes)) if found.is_empty() => Ok(nodes),
            Some((kind, _)) => Err(MeshFault::SeveralGroups {
                group: name.to_owned(),
                kinds: found.into_iter().map(|(kind, _)| kind).chain([kind]).collect(),
            }
            .of(self.source())),
            None => {
                let lower = self.node_sets().iter().map(|set| set.name.as_str());
                let all = self.groups().iter().map(String::as_str).chain(self.surface_groups()).chain(lower);
                Err(MeshFault::NoGroup {
                    kind: "group",
                    group: name.to_owned(),
                    present: all.map(str::to_owned).collect(),
                }
                .of(self.source()))
            }
        }
    }

    /// The names of the physical groups that a node is in: of volumes, then of surfaces, curves and points.
    pub fn groups_of_node(&self, node: u32) -> Vec<&str> {
        let around = self.elements().iter().enumerate().filter(|(_, nodes)| nodes.contains(&node));
        let of_volumes: BTreeSet<usize> = around.flat_map(|(e, _)| self.element_groups(e)).copied().collect();
        let of_surfaces = self.surfaces().iter().filter(|surface| surface.nodes().contains(&node));
        let of_sets = self.node_sets().iter().filter(|set| set.nodes.binary_search(&node).is_ok());
        let volumes = of_volumes.into_iter().map(|group| self.groups()[group].as_str());
        volumes.chain(of_surfaces.map(|s| s.name.as_str())).chain(of_sets.map(|set| set.name.as_str())).collect()
    }

    /// The nodes in a box, its faces included, ascending.
    pub fn nodes_in_box(&self, low: [f64; 3], high: [f64; 3]) -> Vec<u32> {
        self.nodes_where(|x| (0..3).all(|axis| low[axis] <= x[axis] && x[axis] <= high[axis]))
    }

    /// The nodes no farther than `radius` from a point, ascending.
    pub fn nodes_within(&self, at: [f64; 3], radius: f64) -> Vec<u32> {
        self.nodes_where(|x| (x - Vector3::from(at)).norm() <= radius)
    }

    /// The nodes no farther than `tolerance` from the line through `point` along `axis`, which may have any length but
    /// zero, ascending.
    pub fn nodes_on_line(&self, point: [f64; 3], axis: [f64; 3], tolerance: f64) -> Vec<u32> {
        let direction = Vector3::from(axis).normalize();
        self.nodes_where(|x| (x - Vector3::from(point)).cross(&direction).norm() <= tolerance)
    }

    /// Index and distance of the node nearest to a point.
    pub fn nearest_node(&self, at: [f64; 3]) -> (u32, f64) {
        let squared = |x: &[f64; 3]| (0..3).map(|axis| (x[axis] - at[axis]).powi(2)).sum::<f64>();
        let (node, d2) = (0..)
            .zip(self.positions().iter().map(squared))
            .fold((0, f64::INFINITY), |best, found| if found.1 < best.1 { found } else { best });
        (node, d2.sqrt())
    }

    fn nodes_where(&self, chosen: impl Fn(Vector3<f64>) -> bool) -> Vec<u32> {
        (0..).zip(self.positions()).filter(|(_, x)| chosen(Vector3::from(**x))).map(|(node, _)| node).collect()
    }

    /// The nodes of a physical volume, ascending.
    fn volume_nodes(&self, group: usize) -> Vec<u32> {
        let elements = self.elements().iter().enumerate().filter(|(e, _)| self.element_groups(*e).contains(&group));
        let mut nodes: Vec<u32> = elements.flat_map(|(_, nodes)| *nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}
