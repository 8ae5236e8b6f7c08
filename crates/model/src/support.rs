//! Support of the body of a scene: nodes of its mesh, the rigid motions left, and the drive.

pub(crate) mod reactions;

use std::collections::HashSet;

use dynamics::{Drive, DrivenMotion, DrivenSpeed};
use fem_tet10::Mesh;
use modal::Support;
use nalgebra::Vector3;
use reduced_body::RigidMotion;
use scene::{Body, Constraint, HeldDirections, HingeLine, Region, key_path};

use crate::error::{BuildError, modal, refuse_mesh};
use crate::load::history::history;
use crate::model::initial::first_attitude;

/// A node this close to a point or a line, relative to the size of the mesh, is on it.
const ON: f64 = 1e-6;
/// Sine of the angle between an initial velocity and the direction that is left, up to which it counts as rounding.
const ALONG: f64 = 1e-6;
/// Nodes of a region that hold it as a whole.
const FEWEST: usize = 3;

/// The support of a scene's body and its drive. `mesh`, with the degrees of freedom of a node, is `None` for a rigid body
/// without one.
pub(crate) fn support(body: &Body, mesh: Option<(&Mesh, usize)>) -> Result<(Support, Option<Drive>), BuildError> {
    let Some(constraint) = body.reduced_constraint() else { return Ok((Support::free(), None)) };
    if let (Constraint::Support { parts }, Some((mesh, _))) = (constraint, mesh) {
        return Ok((held_directions(body, mesh, parts)?, None));
    }
    let nodes = match mesh {
        Some((mesh, dofs)) => held_nodes(body, mesh, constraint, dofs)?,
        None => Vec::new(),
    };
    let mesh = mesh.map(|(mesh, _)| mesh);
    let driven = |speed: &scene::DrivenSpeed, motion: DrivenMotion| -> Result<Drive, BuildError> {
        let history = history(body, "constraints[0].motion.history", &speed.history)?;
        Ok(Drive { motion, speed: DrivenSpeed { amplitude: speed.amplitude, history }, added: None })
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
                Some(speed) => (RigidMotion::clamp(point), Some(driven(speed, DrivenMotion::Turn { axis })?)),
                None => (RigidMotion::hinge(point, axis), None),
            }
        }
        Constraint::Slider { direction, motion, .. } => {
            let direction = (*direction).into();
            match motion {
                Some(speed) => (RigidMotion::clamp(mean()), Some(driven(speed, DrivenMotion::Slide { direction })?)),
                None => (RigidMotion::slider(direction), None),
            }
        }
        Constraint::Clamp { .. } | Constraint::Support { .. } => (RigidMotion::clamp(mean()), None),
    };
    Ok((Support::new(motion, nodes), drive))
}

/// The support that holds parts of the mesh in some directions.
fn held_directions(body: &Body, mesh: &Mesh, parts: &[HeldDirections]) -> Result<Support, BuildError> {
    let dofs = held_parts(body, mesh, parts)?.concat();
    let support = Support::of_dofs(mesh.positions(), &dofs).map_err(modal(body))?;
    let motion = &support.motion;
    // Where another motion is left, there is no run.
    if motion.others().is_empty() {
        let (translations, rotations) = (motion.translations(), motion.rotations());
        let attitude = first_attitude(body);
        let global: Vec<_> = translations.iter().map(|direction| attitude.to_global(direction)).collect();
        require_left(body, "initial.velocity", body.initial.velocity, &global, motion)?;
        require_left(body, "initial.angular_velocity", body.initial.angular_velocity, rotations, motion)?;
    }
    Ok(support)
}

/// The degrees of freedom, by node, that each part holds; one that several hold is the first one's.
pub(crate) fn held_parts(
    body: &Body,
    mesh: &Mesh,
    parts: &[HeldDirections],
) -> Result<Vec<Vec<(u32, usize)>>, BuildError> {
    let mut held = HashSet::new();
    let mut of_parts = Vec::with_capacity(parts.len());
    for (i, HeldDirections { region, directions }) in parts.iter().enumerate() {
        let nodes = region_nodes(body, mesh, region, &format!("constraints[{i}]"), 1)?;
        let directions = || (0..3).filter(|axis| directions[*axis]);
        let dofs = nodes.iter().flat_map(|node| directions().map(move |axis| (*node, axis)));
        of_parts.push(dofs.filter(|dof| held.insert(*dof)).collect());
    }
    Ok(of_parts)
}

/// Refuses an initial velocity that the supports prevent; `left` are three directions, one or none.
fn require_left(
    body: &Body,
    key: &str,
    value: [f64; 3],
    left: &[Vector3<f64>],
    motion: &RigidMotion,
) -> Result<(), BuildError> {
    let vector = Vector3::from(value);
    let (prevented, expected) = match left {
        [] => (vector.norm() > 0.0, "0".to_owned()),
        [along] => (
            vector.cross(along).norm() > ALONG * vector.norm(),
            format!("a multiple of [{:.6}, {:.6}, {:.6}]", along.x, along.y, along.z),
        ),
        _ => (false, String::new()),
    };
    if !prevented {
        return Ok(());
    }
    let expected = format!("{expected}: the supports leave the body {motion}");
    Err(body.refuse(key, format!("{value:?}"), expected, "give what is left of it, or change [[constraints]]").into())
}

/// The nodes that a constraint holds, other than supports in some directions.
pub(crate) fn held_nodes(
    body: &Body,
    mesh: &Mesh,
    constraint: &Constraint,
    dofs: usize,
) -> Result<Vec<u32>, BuildError> {
    // A node with rotations holds the body by itself.
    let (fewest, fewest_on_axis) = if dofs == 6 { (1, 1) } else { (FEWEST, 2) };
    let tolerance = ON * mesh.diagonal();
    let nearest = |key: &str, at: [f64; 3]| -> Result<u32, BuildError> {
        let (node, distance) = mesh.nearest_node(at);
        if distance <= tolerance {
            return Ok(node);
        }
        let position = mesh.positions()[node as usize];
        Err(body
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
            region_nodes(body, mesh, &Region::Ball { at: *at, radius: *radius }, "constraints[0].radius", fewest)
        }
        Constraint::Hinge { line: HingeLine::Points(points), shaft, .. } if shaft.is_empty() => {
            points.iter().map(|at| nearest("constraints[0].points", *at)).collect()
        }
        Constraint::Hinge { line, shaft, .. } if shaft.is_empty() => {
            let nodes = mesh.nodes_on_line(line.at(), line.direction(), tolerance);
            if nodes.len() >= fewest_on_axis {
                return Ok(nodes);
            }
            Err(body
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
                nodes.extend(region_nodes(body, mesh, region, "constraints[0]", fewest)?);
            }
            nodes.sort_unstable();
            nodes.dedup();
            Ok(nodes)
        }
        Constraint::Clamp { region } | Constraint::Slider { region: Some(region), .. } => {
            region_nodes(body, mesh, region, "constraints[0]", fewest)
        }
        Constraint::Slider { region: None, .. } | Constraint::Support { .. } => Ok(Vec::new()),
    }
}

/// The nodes of a region, which has at least `fewest`.
pub(crate) fn region_nodes(
    body: &Body,
    mesh: &Mesh,
    region: &Region,
    key: &str,
    fewest: usize,
) -> Result<Vec<u32>, BuildError> {
    let nodes = match region {
        Region::Ball { at, radius } => mesh.nodes_within(*at, *radius),
        Region::Box { low, high } => {
            // Faces of the body on faces of the box are in it whatever rounding did to them.
            let slack = ON * mesh.diagonal();
            mesh.nodes_in_box(low.map(|x| x - slack), high.map(|x| x + slack))
        }
        Region::Group(name) => {
            mesh.group_nodes(name).map_err(|error| refuse_mesh(body, &key_path(key, "group"), &error))?
        }
    };
    if nodes.len() >= fewest {
        return Ok(nodes);
    }
    Err(body
        .refuse(
            key,
            format!("a part of the body with {} node(s) in it", nodes.len()),
            if fewest == 1 { "one node or more" } else { "three nodes or more" },
            "make it larger, or look where the body is: `flexframe modes` draws it",
        )
        .into())
}
