//! Places with axes on a mesh: the nodes that carry them, the forces of their unit wrenches, and how modes move them.

use dynamics::{PointShapes, RotationShapes, SecondOrder};
use faer::Mat;
use fem_tet10::{Location, MeanRotation, Mesh, Patch};
use modal::{BodyPoint, Modes, ReducedBody};
use nalgebra::{Matrix3, Vector3};
use scene::{Marker, MarkerPlace, Region, Scene, key_path};

use crate::error::{BuildError, modal, refuse, refuse_mesh};
use crate::load::rotation::Rotation;
use crate::support::region_nodes;
use crate::tie::body_marker::{BodyMarker, UnknownTurns, axes};

/// A face on the boundary of a region is in it whatever rounding did to it: relative to the size of the mesh.
const ON: f64 = 1e-6;

/// A place with axes on a mesh.
pub(crate) struct MeshMarker {
    name: String,
    pub(crate) nodes: Vec<u32>,
    /// The part of each node in the mean; the sum is 1.
    pub(crate) weights: Vec<f64>,
    /// How the material there is turned, where the mesh tells.
    pub(crate) rotation: Option<Rotation>,
    axes: Matrix3<f64>,
    unknown_turns: UnknownTurns,
    /// Degrees of freedom of a node.
    dofs: usize,
}

/// The markers of a scene on its mesh.
pub(crate) fn on_mesh(scene: &Scene, mesh: &Mesh, dofs: usize) -> Result<Vec<MeshMarker>, BuildError> {
    scene.markers.iter().map(|marker| MeshMarker::new(scene, mesh, dofs, marker)).collect()
}

/// Forces (N×k) of unit forces and moments on each of the markers, side by side.
pub(crate) fn unit_forces(markers: &[MeshMarker], unknowns: usize) -> Mat<f64> {
    let wrenches: Vec<_> =
        markers.iter().flat_map(|marker| marker.wrenches().map(move |wrench| (marker, wrench))).collect();
    let mut forces = Mat::zeros(unknowns, wrenches.len());
    for ((marker, [force, moment]), mut column) in wrenches.iter().zip(forces.as_mut().col_iter_mut()) {
        for (node, weight) in marker.nodes.iter().zip(&marker.weights) {
            for axis in 0..3 {
                column[marker.dofs * *node as usize + axis] += force[axis] * weight;
            }
        }
        if let Some(rotation) = &marker.rotation {
            rotation.add_unit_nodal_forces(marker.dofs, moment, column);
        }
    }
    forces
}

/// Markers on a body in some modes. `stiffness` is that (nf×nf each) by the stress of the forces of
/// [`unit_forces`]; none where it is left out.
pub(crate) fn reduced(
    markers: &[MeshMarker],
    scene: &Scene,
    mesh: &Mesh,
    body: &ReducedBody,
    modes: &Modes,
    stiffness: &[Mat<f64>],
) -> Result<Vec<BodyMarker>, BuildError> {
    let mut rest = stiffness;
    let on_body = |marker: &MeshMarker| {
        let (own, others) = rest.split_at(rest.len().min(marker.wrenches().count()));
        rest = others;
        marker.reduced(scene, mesh, body, modes, own)
    };
    markers.iter().map(on_body).collect()
}

impl MeshMarker {
    fn new(scene: &Scene, mesh: &Mesh, dofs: usize, marker: &Marker) -> Result<Self, BuildError> {
        let key = key_path("body.markers", &marker.name);
        let (name, axes) = (marker.name.clone(), axes(marker.axes.as_ref()));
        let region = match &marker.place {
            MarkerPlace::Point(at) => {
                let key = key_path(&key, "at");
                let Location { nodes, weights } = mesh.locate(*at).map_err(|error| refuse(scene, &key, error))?;
                let rotation = match mesh.has_elements() || dofs == 6 {
                    true => Some(Rotation::at(scene, mesh, dofs, &key, *at)?),
                    false => None,
                };
                let unknown_turns = if rotation.is_some() { UnknownTurns::None } else { UnknownTurns::All };
                return Ok(Self { name, nodes, weights, rotation, axes, unknown_turns, dofs });
            }
            MarkerPlace::Region(region) => region,
        };
        let patch = patch(scene, mesh, region, &key)?;
        let unknown_turns = match line(&patch, mesh) {
            _ if !patch.is_line => UnknownTurns::None,
            Some(line) => UnknownTurns::About(line),
            None => UnknownTurns::All,
        };
        let Patch { nodes, weights, rotation_per_displacement, .. } = patch;
        let mean = MeanRotation { nodes: nodes.clone(), rotation_per_displacement };
        let rotation = (unknown_turns != UnknownTurns::All).then_some(Rotation::Mean(mean));
        Ok(Self { name, nodes, weights, rotation, axes, unknown_turns, dofs })
    }

    /// Unit forces and moments that it can bear: those about turns that are not known are left out.
    fn wrenches(&self) -> impl Iterator<Item = [Vector3<f64>; 2]> {
        let forces = [0, 1, 2].map(|axis| [Vector3::ith(axis, 1.0), Vector3::zeros()]);
        let moments = match (&self.rotation, self.unknown_turns) {
            (None, _) | (_, UnknownTurns::All) => Vec::new(),
            (_, UnknownTurns::None) => [0, 1, 2].map(|axis| Vector3::ith(axis, 1.0)).to_vec(),
            (_, UnknownTurns::About(line)) => {
                let across = crate::tie::body_marker::perpendicular(&line);
                vec![across, line.cross(&across)]
            }
        };
        forces.into_iter().chain(moments.into_iter().map(|moment| [Vector3::zeros(), moment]))
    }

    /// The marker on a body in some modes, which its unit forces and moments stiffen so (nf×nf each).
    fn reduced(
        &self,
        scene: &Scene,
        mesh: &Mesh,
        body: &ReducedBody,
        modes: &Modes,
        stiffness: &[Mat<f64>],
    ) -> Result<BodyMarker, BuildError> {
        let point = BodyPoint::new(modes, mesh.positions(), &self.nodes, &self.weights).map_err(modal(scene))?;
        let mut point = PointShapes::new(body, &point);
        let mut turning = match &self.rotation {
            Some(rotation) => rotation.shapes(self.dofs, body, modes),
            None => RotationShapes::new(body, Mat::zeros(3, body.flexible()).as_ref()),
        };
        let (mut by_forces, mut by_moments) = (Vec::new(), Vec::new());
        for ([force, moment], stiffness) in self.wrenches().zip(stiffness) {
            match force.norm() > 0.0 {
                true => by_forces.push((force, stiffness.clone())),
                false => by_moments.push((moment, stiffness.clone())),
            }
        }
        if !by_forces.is_empty() {
            point = point.with_second_order(SecondOrder::new(by_forces)?);
        }
        if !by_moments.is_empty() {
            turning = turning.with_second_order(SecondOrder::new(by_moments)?);
        }
        // What does not deform is turned as the body is.
        let unknown_turns = if body.flexible() == 0 { UnknownTurns::None } else { self.unknown_turns };
        Ok(BodyMarker { name: self.name.clone(), point, turning, axes: self.axes, unknown_turns })
    }
}

/// The faces in a part of the mesh as a patch; of a curve, or of matrices, which have no faces, the nodes, all alike.
fn patch(scene: &Scene, mesh: &Mesh, region: &Region, key: &str) -> Result<Patch, BuildError> {
    let of_nodes = |nodes: Vec<u32>| {
        let weights = vec![1.0 / nodes.len() as f64; nodes.len()];
        Patch::new(nodes, weights, mesh.positions())
    };
    let slack = ON * mesh.diagonal();
    let found = match region {
        _ if !mesh.has_elements() => return Ok(of_nodes(region_nodes(scene, mesh, region, key, 1)?)),
        Region::Group(name) if mesh.surface_groups().any(|surface| surface == name) => {
            return mesh.surface_patch(name).map_err(|error| refuse_mesh(scene, &key_path(key, "group"), &error));
        }
        Region::Group(name) if mesh.groups().contains(name) => {
            let help = "name a physical surface, or give the faces within a `box` or a `radius`";
            let found = format!("the physical volume {name:?}");
            return Err(scene.refuse(&key_path(key, "group"), found, "a surface of the body", help).into());
        }
        Region::Group(_) => return Ok(of_nodes(region_nodes(scene, mesh, region, key, 1)?)),
        Region::Ball { at, radius } => {
            let at = Vector3::from(*at);
            mesh.outer_patch(|x| (x - at).norm() <= radius + slack)
        }
        Region::Box { low, high } => {
            mesh.outer_patch(|x| (0..3).all(|i| low[i] - slack <= x[i] && x[i] <= high[i] + slack))
        }
    };
    found.ok_or_else(|| {
        let help = "make it larger, or give `at` alone for a point of the body";
        scene.refuse(key, "a part of the body without a whole face in it", "faces of the body", help).into()
    })
}

/// The direction of the line that the nodes of a patch are on; `None` of one point.
fn line(patch: &Patch, mesh: &Mesh) -> Option<Vector3<f64>> {
    let arm = |node: &u32| Vector3::from(mesh.positions()[*node as usize]) - patch.position;
    let farthest = patch.nodes.iter().map(arm).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    farthest.try_normalize(ON * mesh.diagonal())
}
