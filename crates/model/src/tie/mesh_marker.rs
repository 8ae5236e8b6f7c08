//! Places with axes on a mesh: the nodes that carry them, the forces of their unit wrenches, and how modes move them.

use std::collections::BTreeMap;

use faer::prelude::ReborrowMut;
use faer::{Mat, MatRef, Scale};
use fem_tet10::{Location, Mesh, Patch, Strip};
use nalgebra::{Matrix3, Vector3};
use scene::{Body, Constraint, HeldDirections, Marker, MarkerPlace, Region, Tie, key_path};

use crate::error::{BuildError, refuse, refuse_mesh};
use crate::load::rotation::Rotation;
use crate::support::{held_nodes, region_nodes};
use crate::tie::body_marker::{BodyMarker, MarkerPart, UnknownTurns, axes};
use crate::tie::patterns::patterns;
use crate::tie::place::{Place, ShapedBody};
use crate::tie::warp::Warp;

/// A face on the boundary of a region is in it whatever rounding did to it: relative to the size of the mesh.
const ON: f64 = 1e-6;
/// A patch has no faces below this part of the area of all.
const LEAST_PART: f64 = 1e-9;

/// Most nodes that are tied one by one.
const MAX_NODES: usize = 100;

/// A place with axes on a mesh.
pub(crate) struct MeshMarker {
    name: String,
    key_of_tie: String,
    axes: Matrix3<f64>,
    whole: Place,
    /// Where the ends of its joints are several places: these, each with its part in the whole.
    parts: Vec<(f64, Place)>,
    /// Forces on the parts that are put on together (parts × patterns); none where each part has its own.
    patterns: Option<Mat<f64>>,
    /// True if its parts move as one rigid body: joints then hold the whole.
    is_rigid: bool,
    /// From the middle of a rigid part to the place that moves with it, mesh axes.
    arm: Vector3<f64>,
    /// Its faces, where it is their mean.
    faces: Option<Vec<[u32; 6]>>,
    /// Degrees of freedom of a node.
    dofs: usize,
}

/// The markers of a scene on its mesh.
pub(crate) fn on_mesh(body: &Body, mesh: &Mesh, dofs: usize) -> Result<Vec<MeshMarker>, BuildError> {
    body.markers.iter().map(|marker| MeshMarker::new(body, mesh, dofs, marker)).collect()
}

/// Forces (N×k) of unit forces and moments on each of the markers, side by side.
pub(crate) fn unit_forces(markers: &[MeshMarker], unknowns: usize) -> Mat<f64> {
    let loads: Vec<_> =
        markers.iter().flat_map(|marker| marker.loads().into_iter().map(move |load| (marker, load))).collect();
    let mut forces = Mat::zeros(unknowns, loads.len());
    for ((marker, load), mut column) in loads.iter().zip(forces.as_mut().col_iter_mut()) {
        for Share { place, wrench, factor } in load {
            let place = marker.places()[*place];
            place.add_forces(marker.dofs, &place.wrenches()[*wrench], *factor, column.rb_mut());
        }
    }
    forces
}

/// How the faces of each of the markers warp in the responses to [`unit_forces`]; none where it is no mean of faces.
pub(crate) fn warps(markers: &[MeshMarker], mesh: &Mesh, responses: MatRef<'_, f64>) -> Vec<Option<Warp>> {
    let mut first = 0;
    let of_marker = |marker: &MeshMarker| {
        let count = marker.loads().len();
        let own = responses.subcols(first, count);
        first += count;
        Warp::new(mesh, marker.faces.as_ref()?, marker.dofs, own)
    };
    markers.iter().map(of_marker).collect()
}

/// Markers on a body. `stiffness` is that (nf×nf each) by the stress of the forces of [`unit_forces`]; none where it is left
/// out.
pub(crate) fn reduced(
    markers: &[MeshMarker],
    body: &Body,
    mesh: &Mesh,
    shaped: &ShapedBody<'_>,
    stiffness: &[Mat<f64>],
    warps: &[Option<Warp>],
) -> Result<Vec<BodyMarker>, BuildError> {
    let mut rest = stiffness;
    let on_body = |(number, marker): (usize, &MeshMarker)| {
        let (own, others) = rest.split_at(rest.len().min(marker.loads().len()));
        rest = others;
        let warp = warps.get(number).cloned().flatten();
        Ok(BodyMarker { warp, ..marker.reduced(body, mesh, shaped, own)? })
    };
    markers.iter().enumerate().map(on_body).collect()
}

/// A wrench of a place as a part of a load.
struct Share {
    place: usize,
    wrench: usize,
    factor: f64,
}

impl MeshMarker {
    fn new(body: &Body, mesh: &Mesh, dofs: usize, marker: &Marker) -> Result<Self, BuildError> {
        let key = marker.key();
        let (name, key_of_tie, axes) = (marker.name.clone(), marker.key_of_tie(), axes(marker.axes.as_ref()));
        let alone = |whole: Place| Self {
            name,
            key_of_tie,
            axes,
            whole,
            parts: Vec::new(),
            patterns: None,
            is_rigid: false,
            arm: Vector3::zeros(),
            faces: None,
            dofs,
        };
        let region = match &marker.place {
            MarkerPlace::Point(at) => {
                let key = key_path(&key, "at");
                let Location { nodes, weights } = mesh.locate(*at).map_err(|error| refuse(body, &key, error))?;
                let rotation = match mesh.has_elements() || dofs == 6 {
                    true => Some(Rotation::at(body, mesh, dofs, &key, *at)?),
                    false => None,
                };
                return Ok(alone(Place::of_point(nodes, weights, rotation, mesh)));
            }
            MarkerPlace::Held { constraint, number } => {
                let nodes = held_by(body, mesh, (constraint, *number), dofs)?;
                if let [node] = nodes[..] {
                    // A node with rotations holds the body by itself.
                    let rotation = (dofs == 6).then_some(Rotation::OfNode(node));
                    return Ok(alone(Place::of_point(vec![node], vec![1.0], rotation, mesh)));
                }
                let made = Self::of_nodes(body, mesh, dofs, marker, nodes, alone)?;
                let place = match constraint {
                    Constraint::Pin { at, .. } => Vector3::from(*at),
                    Constraint::Hinge { line, .. } => {
                        let (at, along) = (Vector3::from(line.at()), Vector3::from(line.direction()));
                        at + along * along.dot(&(made.whole.position - at))
                    }
                    Constraint::Clamp { .. } | Constraint::Slider { .. } | Constraint::Support { .. } => {
                        made.whole.position
                    }
                };
                let arm = if made.is_rigid { place - made.whole.position } else { Vector3::zeros() };
                return Ok(Self { arm, ..made });
            }
            MarkerPlace::Region(region) => region,
        };
        match marker.tie {
            Tie::Mean => {
                let whole = Place::of_patch(patch(body, mesh, region, &key)?, mesh);
                Ok(Self { faces: faces(mesh, region), ..alone(whole) })
            }
            Tie::Patches { count, along } => {
                let whole = Place::of_patch(patch(body, mesh, region, &key)?, mesh);
                let strips = strips(body, mesh, region, &key, count, along)?;
                let parts = strips.into_iter().map(|strip| (strip.part, Place::of_patch(strip.patch, mesh))).collect();
                Ok(Self { parts, ..alone(whole) })
            }
            Tie::Nodes | Tie::Rigid => {
                let nodes = region_nodes(body, mesh, region, &key, 1)?;
                Self::of_nodes(body, mesh, dofs, marker, nodes, alone)
            }
        }
    }

    /// One whose nodes are tied one by one, or move as one rigid body.
    fn of_nodes(
        body: &Body,
        mesh: &Mesh,
        dofs: usize,
        marker: &Marker,
        nodes: Vec<u32>,
        alone: impl FnOnce(Place) -> Self,
    ) -> Result<Self, BuildError> {
        let is_rigid = marker.tie == Tie::Rigid;
        let is_held = matches!(marker.place, MarkerPlace::Held { .. });
        // Nodes with rotations would keep those free.
        if dofs == 6 && (is_rigid || is_held) {
            let found = "a rigid part of a body whose nodes have rotations";
            let help = "give the nodes rigid elements where the matrices are made, and hold one of them";
            let expected = if is_held { "one node beside joints" } else { "`\"mean\"` or `\"nodes\"`" };
            return Err(body.refuse(&marker.key_of_tie(), found, expected, help).into());
        }
        if nodes.len() > MAX_NODES {
            let what = if is_rigid { "to move as one rigid body" } else { "to be tied one by one" };
            let (found, expected) = (format!("{} nodes {what}", nodes.len()), format!("{MAX_NODES} nodes or fewer"));
            let help = match is_held {
                true => {
                    "beside joints each held node takes three static shapes: hold fewer nodes, or say it as a joint to \"ground\" of a \
                     marker that is the mean of the region"
                }
                false => "each takes three static shapes: take fewer nodes, or faces as `patches`, or `tie = \"mean\"`",
            };
            return Err(body.refuse(&marker.key_of_tie(), found, expected, help).into());
        }
        let part = 1.0 / nodes.len() as f64;
        let of_node = |node: &u32| (part, Place::of_point(vec![*node], vec![1.0], None, mesh));
        let parts: Vec<_> = nodes.iter().map(of_node).collect();
        let positions: Vec<_> = parts.iter().map(|(_, place)| place.position).collect();
        let weights = vec![part; nodes.len()];
        let whole = Place::of_patch(Patch::new(nodes, weights, mesh.positions()), mesh);
        Ok(Self { parts, patterns: Some(patterns(&positions)), is_rigid, ..alone(whole) })
    }

    /// One of its places, or without a number the mean of all.
    pub(crate) fn place(&self, part: Option<usize>) -> Option<&Place> {
        match part {
            None => Some(&self.whole),
            Some(part) => self.parts.get(part).map(|(_, place)| place),
        }
    }

    /// The nodes that move as one rigid body, if they do.
    pub(crate) fn rigid_nodes(&self) -> Option<&[u32]> {
        self.is_rigid.then_some(&self.whole.nodes)
    }

    /// From the middle of its nodes to the place that it is, mesh axes; not zero only where they move as one rigid body.
    pub(crate) fn arm(&self) -> Vector3<f64> {
        self.arm
    }

    /// The key path of how its region carries it, in the scene of its body.
    pub(crate) fn key_of_tie(&self) -> &str {
        &self.key_of_tie
    }

    /// The places that forces act on.
    fn places(&self) -> Vec<&Place> {
        match self.parts.is_empty() {
            true => vec![&self.whole],
            false => self.parts.iter().map(|(_, place)| place).collect(),
        }
    }

    /// Unit forces and moments on its places.
    fn loads(&self) -> Vec<Vec<Share>> {
        if let Some(patterns) = &self.patterns {
            let of = |pattern: usize, wrench: usize| {
                (0..patterns.nrows()).map(|place| Share { place, wrench, factor: patterns[(place, pattern)] }).collect()
            };
            return (0..patterns.ncols()).flat_map(|pattern| (0..3).map(move |axis| of(pattern, axis))).collect();
        }
        let of_place = |(place, at): (usize, &Place)| {
            let count = at.wrenches().len();
            (0..count).map(move |wrench| vec![Share { place, wrench, factor: 1.0 }])
        };
        self.places().into_iter().enumerate().flat_map(of_place).collect()
    }

    /// The marker on a body, which its loads stiffen so (nf×nf each).
    fn reduced(
        &self,
        body: &Body,
        mesh: &Mesh,
        shaped: &ShapedBody<'_>,
        stiffness: &[Mat<f64>],
    ) -> Result<BodyMarker, BuildError> {
        // Patterns are orthonormal: the parts are combined of them as they are of the parts.
        let of_places: Vec<Vec<Mat<f64>>> = if stiffness.is_empty() {
            vec![Vec::new(); self.places().len()]
        } else {
            let flexible = stiffness[0].nrows();
            let none = |place: &Place| vec![Mat::zeros(flexible, flexible); place.wrenches().len()];
            let mut sums: Vec<Vec<Mat<f64>>> = self.places().into_iter().map(none).collect();
            for (load, stiffness) in self.loads().iter().zip(stiffness) {
                for Share { place, wrench, factor } in load {
                    sums[*place][*wrench] += stiffness * Scale(*factor);
                }
            }
            sums
        };
        let of_whole = match self.parts.is_empty() {
            true => of_places[0].clone(),
            false => self.of_whole(&of_places),
        };
        let (point, turning) = self.whole.shapes(body, mesh, self.dofs, shaped, of_whole, &self.arm)?;
        let of_part = |((_, place), stiffness): (&(f64, Place), Vec<Mat<f64>>)| {
            let (point, turning) = place.shapes(body, mesh, self.dofs, shaped, stiffness, &Vector3::zeros())?;
            Ok(MarkerPart { point, turning })
        };
        let parts = match self.is_rigid {
            true => Vec::new(),
            false => self.parts.iter().zip(of_places).map(of_part).collect::<Result<_, BuildError>>()?,
        };
        // What does not deform is turned as the body is.
        let unknown_turns = if shaped.body.flexible() == 0 { UnknownTurns::None } else { self.whole.unknown_turns };
        let by_nodes = self.patterns.is_some() && !self.is_rigid;
        Ok(BodyMarker {
            name: self.name.clone(),
            point,
            turning,
            parts,
            by_nodes,
            warp: None,
            axes: self.axes,
            unknown_turns,
        })
    }

    /// The stiffness by wrenches on the whole, from that by those on the parts: a force is spread by their parts in the whole, a
    /// moment as forces and moments. Eqs. (J16) of `docs/method/systems.md`.
    fn of_whole(&self, of_parts: &[Vec<Mat<f64>>]) -> Vec<Mat<f64>> {
        let inverse = self.whole.inverse_inertia();
        let of_wrench = |[force, moment]: [Vector3<f64>; 2]| {
            let turn = inverse * (moment + self.arm.cross(&force));
            let mut sum: Option<Mat<f64>> = None;
            for ((part, place), of_part) in self.parts.iter().zip(of_parts) {
                let arm = place.position - self.whole.position;
                let (force, moment) = ((force + turn.cross(&arm)) * *part, place.inertia * turn * *part);
                for ([along, about], stiffness) in place.wrenches().iter().zip(of_part) {
                    let term = stiffness * Scale(along.dot(&force) + about.dot(&moment));
                    sum = Some(sum.map_or_else(|| term.clone(), |sum| sum + &term));
                }
            }
            sum
        };
        self.whole.wrenches().into_iter().filter_map(of_wrench).collect()
    }
}

/// The faces in a part of the mesh as a patch; of a curve, or of matrices, which have no faces, the nodes, all alike.
fn patch(body: &Body, mesh: &Mesh, region: &Region, key: &str) -> Result<Patch, BuildError> {
    let of_nodes = |nodes: Vec<u32>| {
        let weights = vec![1.0 / nodes.len() as f64; nodes.len()];
        Patch::new(nodes, weights, mesh.positions())
    };
    let slack = ON * mesh.diagonal();
    let found = match region {
        _ if !mesh.has_elements() => return Ok(of_nodes(region_nodes(body, mesh, region, key, 1)?)),
        Region::Group(name) if mesh.surface_groups().any(|surface| surface == name) => {
            return mesh.surface_patch(name).map_err(|error| refuse_mesh(body, &key_path(key, "group"), &error));
        }
        Region::Group(name) if mesh.groups().contains(name) => return Ok(volume_patch(mesh, name)),
        Region::Group(_) => return Ok(of_nodes(region_nodes(body, mesh, region, key, 1)?)),
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
        body.refuse(key, "a part of the body without a whole face in it", "faces of the body", help).into()
    })
}

/// The nodes of a physical volume, each with its part in the volumes of the elements around it, as if these were straight: ten equal parts
/// of an element have its centroid.
fn volume_patch(mesh: &Mesh, name: &str) -> Patch {
    let is_in = |element: &usize| mesh.element_groups(*element).iter().any(|group| mesh.groups()[*group] == name);
    let mut volumes = BTreeMap::new();
    for element in (0..mesh.elements().len()).filter(is_in) {
        let nodes = &mesh.elements()[element];
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| Vector3::from(mesh.positions()[nodes[corner] as usize]));
        let volume = (b - a).cross(&(c - a)).dot(&(d - a)).abs();
        nodes.iter().for_each(|node| *volumes.entry(*node).or_insert(0.0) += volume);
    }
    let whole: f64 = volumes.values().sum();
    let (nodes, weights) = volumes.into_iter().map(|(node, volume)| (node, volume / whole)).unzip();
    Patch::new(nodes, weights, mesh.positions())
}

/// The faces in a part of the mesh in strips.
fn strips(
    body: &Body,
    mesh: &Mesh,
    region: &Region,
    key: &str,
    count: usize,
    along: Option<[f64; 3]>,
) -> Result<Vec<Strip>, BuildError> {
    let key_of = key_path(key, "patches");
    let faces = faces(mesh, region).filter(|faces| !faces.is_empty());
    let help = "remove `patches`, or name a physical surface, a `box` or a `radius` with faces of the body in it";
    let faces =
        faces.ok_or_else(|| body.refuse(&key_of, "patches of a marker without faces", "faces of the body", help))?;
    let along = match along {
        Some(along) => Vector3::from(along),
        None => mesh.longest(&faces).ok_or_else(|| {
            let found = "patches of faces that extend as far in two directions";
            let help = "add `along = [x, y, z]`, the direction from patch to patch";
            body.refuse(&key_of, found, "a direction to cut them along", help)
        })?,
    };
    let strips = mesh.strips(&faces, &along, count);
    match strips.iter().all(|strip| strip.part > LEAST_PART) {
        true => Ok(strips),
        false => {
            let help = "give fewer patches, or another direction `along`";
            Err(body
                .refuse(&key_of, format!("{count} patches, one of them without faces"), "faces in each", help)
                .into())
        }
    }
}

/// The faces in a part of the mesh, where it has some.
pub(crate) fn faces(mesh: &Mesh, region: &Region) -> Option<Vec<[u32; 6]>> {
    let slack = ON * mesh.diagonal();
    let within = |holds: &dyn Fn(&Vector3<f64>) -> bool| {
        let is_in = |node: &u32| holds(&mesh.positions()[*node as usize].into());
        mesh.outer_faces().into_iter().filter(|nodes| nodes.iter().all(is_in)).collect()
    };
    match region {
        _ if !mesh.has_elements() => None,
        Region::Group(name) => mesh.surface_faces(name).ok(),
        Region::Ball { at, radius } => Some(within(&|x| (x - Vector3::from(*at)).norm() <= radius + slack)),
        Region::Box { low, high } => {
            Some(within(&|x| (0..3).all(|i| low[i] - slack <= x[i] && x[i] <= high[i] + slack)))
        }
    }
}

/// The nodes that a constraint holds, of supports the first part.
fn held_by(
    body: &Body,
    mesh: &Mesh,
    (constraint, number): (&Constraint, usize),
    dofs: usize,
) -> Result<Vec<u32>, BuildError> {
    match constraint {
        Constraint::Support { parts } => {
            let key = format!("constraints[{number}]");
            let nodes = |part: &HeldDirections| region_nodes(body, mesh, &part.region, &key, 1);
            Ok(parts.first().map(nodes).transpose()?.unwrap_or_default())
        }
        _ => held_nodes(body, mesh, constraint, dofs),
    }
}
