//! What holds the body of a scene: nodes of its mesh, the rigid motions left, and what drives it.

use fem_tet10::Mesh;
use frames_rk4::{Drive, DrivenMotion};
use modal::{RigidMotion, Support};
use nalgebra::Vector3;

use super::error::{BuildError, refuse_mesh};
use super::history::history;
use crate::constraint::{self, Constraint, HingeLine, Region};
use crate::scene::Scene;

/// A node this close to a point or a line, relative to the size of the mesh, is on it.
const ON: f64 = 1e-6;

/// The support of a scene's body and its drive. `mesh` is `None` for a rigid body without one.
pub(super) fn support(scene: &Scene, mesh: Option<&Mesh>) -> Result<(Support, Option<Drive>), BuildError> {
    let Some(constraint) = &scene.constraint else { return Ok((Support::free(), None)) };
    let nodes = match mesh {
        Some(mesh) => held_nodes(scene, mesh, constraint)?,
        None => Vec::new(),
    };
    let driven = |drive: &constraint::Drive, motion: DrivenMotion| -> Result<Drive, BuildError> {
        let history = history(scene, "constraints[0].motion.history", &drive.history)?;
        Ok(Drive { motion, amplitude: drive.amplitude, history, span: scene.time.end })
    };
    let mean = || {
        let of = |node: &u32| mesh.map_or(Vector3::zeros(), |mesh| mesh.positions()[*node as usize].into());
        nodes.iter().map(of).sum::<Vector3<f64>>() / nodes.len().max(1) as f64
    };
    let (motion, drive) = match constraint {
        Constraint::Pin { at, .. } => (RigidMotion::pin((*at).into()), None),
        Constraint::Hinge { line, motion, .. } => {
            let (point, axis) = (line.at().into(), line.direction().into());
            match motion {
                Some(drive) => (RigidMotion::clamp(point), Some(driven(drive, DrivenMotion::Turn { axis })?)),
                None => (RigidMotion::hinge(point, axis), None),
            }
        }
        Constraint::Slider { direction, motion, .. } => {
            let direction = (*direction).into();
            match motion {
                Some(drive) => (RigidMotion::clamp(mean()), Some(driven(drive, DrivenMotion::Slide { direction })?)),
                None => (RigidMotion::slider(direction), None),
            }
        }
        Constraint::Clamp { .. } => (RigidMotion::clamp(mean()), None),
    };
    Ok((Support::new(motion, nodes), drive))
}

fn held_nodes(scene: &Scene, mesh: &Mesh, constraint: &Constraint) -> Result<Vec<u32>, BuildError> {
    let tolerance = ON * mesh.diagonal();
    let nearest = |key: &str, at: [f64; 3]| -> Result<u32, BuildError> {
        let (node, distance) = mesh.nearest_node(at);
        if distance <= tolerance {
            return Ok(node);
        }
        let position = mesh.positions()[node as usize];
        Err(scene
            .refuse(
                key,
                format!("a point without a node: the nearest one is {distance:.6} away"),
                "a node of the mesh",
                format!("use the node at {position:?}, or hold the nodes within a radius"),
            )
            .into())
    };
    match constraint {
        Constraint::Pin { at, radius: None } => Ok(vec![nearest("constraints[0].at", *at)?]),
        Constraint::Pin { at, radius: Some(radius) } => {
            region_nodes(scene, mesh, &Region::Ball { at: *at, radius: *radius }, "constraints[0].radius")
        }
        Constraint::Hinge { line: HingeLine::Points(points), shaft, .. } if shaft.is_empty() => {
            points.iter().map(|at| nearest("constraints[0].points", *at)).collect()
        }
        Constraint::Hinge { line, shaft, .. } if shaft.is_empty() => {
            let nodes = mesh.nodes_on_line(line.at(), line.direction(), tolerance);
            if nodes.len() >= 2 {
                return Ok(nodes);
            }
            Err(scene
                .refuse(
                    "constraints[0].axis",
                    format!("a line with {} node(s) of the mesh on it", nodes.len()),
                    "two or more nodes on the axis, or a part of the body that the shaft holds",
                    "give a radius, a box or a group for the shaft, or two points that are nodes",
                )
                .into())
        }
        Constraint::Hinge { shaft, .. } => {
            let mut nodes = Vec::new();
            for region in shaft {
                nodes.extend(region_nodes(scene, mesh, region, "constraints[0]")?);
            }
            nodes.sort_unstable();
            nodes.dedup();
            Ok(nodes)
        }
        Constraint::Clamp { region } | Constraint::Slider { region: Some(region), .. } => {
            region_nodes(scene, mesh, region, "constraints[0]")
        }
        Constraint::Slider { region: None, .. } => Ok(Vec::new()),
    }
}

fn region_nodes(scene: &Scene, mesh: &Mesh, region: &Region, key: &str) -> Result<Vec<u32>, BuildError> {
    let nodes = match region {
        Region::Ball { at, radius } => mesh.nodes_within(*at, *radius),
        Region::Box { low, high } => {
            // Faces of the body on faces of the box are in it whatever rounding did to them.
            let slack = ON * mesh.diagonal();
            mesh.nodes_in_box(low.map(|x| x - slack), high.map(|x| x + slack))
        }
        Region::Group(name) => {
            mesh.group_nodes(name).map_err(|error| refuse_mesh(scene, "constraints[0].group", &error))?
        }
    };
    if nodes.len() >= 3 {
        return Ok(nodes);
    }
    Err(scene
        .refuse(
            key,
            format!("a part of the body with {} node(s) in it", nodes.len()),
            "three nodes or more",
            "make it larger, or look where the body is: `flexframe modes` draws it",
        )
        .into())
}
