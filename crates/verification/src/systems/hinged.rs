//! Bars hinged along shared lines of nodes. In the joined mesh the hinge needs no joint: elements that share a line of nodes turn
//! about it.

use std::collections::HashMap;
use std::path::Path;

use dynamics::{Observation, StepControl};
use fem_tet10::{Material, Mesh};
use nalgebra::{Matrix3, Vector3};

use crate::nonlinear::{NodalState, Solid, SolidError, SolidMotion, mean_axes};
use crate::systems::meshes::{BarFrame, FrameBar, write};
use crate::systems::run::{built, rows};

/// A hinge on a line of nodes in a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hinge {
    /// A ball at each node.
    Balls,
    /// A hinge on the mean of the nodes.
    Mean,
}

/// How bars move.
#[derive(Debug, Clone)]
pub struct Motions {
    /// Their material.
    pub material: Material,
    /// Velocity of each bar's centre, and its angular velocity, global.
    pub velocities: Vec<[Vector3<f64>; 2]>,
    /// Acceleration of gravity along −z.
    pub gravity: f64,
    /// True if the highest line of nodes at the low end of the first bar is on the ground.
    pub hung: bool,
    /// End of the motion.
    pub end: f64,
    /// Steps of the joined mesh; half as long ones are taken as well.
    pub steps: usize,
    /// Number of times that are compared.
    pub rows: usize,
}

/// Largest distances of a system from the joined mesh.
#[derive(Debug, Clone, Copy, Default)]
pub struct Off {
    /// Difference of attitudes, rad.
    pub attitude: f64,
    /// Difference of centres of mass.
    pub center: f64,
    /// Difference of elastic displacements, over their peak.
    pub elastic: f64,
    /// The peak.
    pub peak: f64,
}

/// A body at a time: what takes its components to global ones, its centre of mass, elastic displacements of its points in its own axes.
struct Seen {
    rotation: Matrix3<f64>,
    center: Vector3<f64>,
    elastic: Vec<Vector3<f64>>,
}

/// The bars of a frame in the joined mesh at equal times, from rows + 1.
pub struct JoinedReference(Vec<Vec<Seen>>);

/// A bar of the joined mesh.
struct Part {
    /// As a solid of its own.
    alone: Solid,
    /// Numbers of its nodes in the joined mesh.
    nodes: Vec<usize>,
    /// Its own numbers of the nodes that are compared.
    seen: Vec<usize>,
}

impl Part {
    /// With what finds the number of a node of the joined mesh by its place.
    fn new(
        frame: &BarFrame,
        bar: &FrameBar,
        material: Material,
        find: impl Fn([f64; 3]) -> Option<usize>,
    ) -> Result<Self, SolidError> {
        let mesh = Mesh::new(frame.bar(bar.upright))?;
        let moved = |x: &[f64; 3]| [0, 1, 2].map(|k| x[k] + bar.at[k]);
        let nodes: Option<Vec<usize>> = mesh.positions().iter().map(|x| find(moved(x))).collect();
        let nodes = nodes.ok_or_else(|| SolidError::Mesh("meshes that differ".to_owned()))?;
        let place = |x: &Vector3<f64>| mesh.positions().iter().position(|y| (Vector3::from(*y) - x).norm() < 1e-9);
        let seen: Option<Vec<usize>> = places(frame, bar.upright).iter().map(place).collect();
        let seen = seen.ok_or_else(|| SolidError::Mesh("no node at a place that is compared".to_owned()))?;
        Ok(Self { alone: Solid::new(mesh, material, |_| false)?, nodes, seen })
    }
}

/// Places on a bar that are compared: both ends and its middle.
fn places(frame: &BarFrame, upright: bool) -> [Vector3<f64>; 3] {
    let [l, b, h] = frame.size;
    [0.0, 0.5, 1.0].map(|part| match upright {
        false => Vector3::new(part * l, 0.5 * b, 0.5 * h),
        true => Vector3::new(0.5 * h, 0.5 * b, part * l),
    })
}

/// The motion of the joined mesh, extrapolated from two lengths of steps.
///
/// # Errors
/// Steps that fail.
pub fn reference(frame: &BarFrame, motions: &Motions) -> Result<JoinedReference, SolidError> {
    let Motions { material, gravity, hung, end, steps, rows, .. } = *motions;
    let mesh = Mesh::new(frame.joined())?;
    let first = frame.bars[0].at;
    let height = frame.size[2];
    let is_held = |x: Vector3<f64>| hung && near(x.x, first[0]) && near(x.z, first[2] + height);
    let solid = Solid::new(mesh, material, is_held)?;
    let key = |x: [f64; 3]| x.map(|s| (s * 1e6).round() as i64);
    let numbers: HashMap<[i64; 3], usize> =
        solid.mesh().positions().iter().zip(0..).map(|(x, i)| (key(*x), i)).collect();
    let parts = frame.bars.iter().map(|bar| Part::new(frame, bar, material, |x| numbers.get(&key(x)).copied()));
    let parts = parts.collect::<Result<Vec<Part>, SolidError>>()?;
    let mut v = vec![0.0; solid.dofs()];
    for (Part { alone, nodes, .. }, [velocity, omega]) in parts.iter().zip(&motions.velocities) {
        let middle = center(alone, &vec![0.0; alone.dofs()]);
        for (x, number) in alone.mesh().positions().iter().zip(nodes) {
            let of_node = velocity + omega.cross(&(Vector3::from(*x) - middle));
            v[3 * number..3 * number + 3].copy_from_slice(of_node.as_slice());
        }
    }
    let down: Vec<f64> = (0..solid.dofs()).map(|k| if k % 3 == 2 { -gravity } else { 0.0 }).collect();
    let weight = solid.momentum(&down);
    let run = |steps: usize| -> Result<Vec<Vec<f64>>, SolidError> {
        let start = NodalState { time: 0.0, u: vec![0.0; v.len()], v: v.clone() };
        let mut motion = SolidMotion::new(&solid, start, end / steps as f64, |_, _| weight.clone());
        let mut found = vec![motion.state.u.clone()];
        for step in 1..=steps {
            motion.advance()?;
            if step % (steps / rows) == 0 {
                found.push(motion.state.u.clone());
            }
        }
        Ok(found)
    };
    let [coarse, fine] = [run(steps)?, run(2 * steps)?];
    let at_time = |(coarse, fine): (&Vec<f64>, &Vec<f64>)| {
        let of_bar = |(bar, Part { alone, nodes, seen }): (&FrameBar, &Part)| {
            let dof = |k: usize| (4.0 * fine[k] - coarse[k]) / 3.0;
            let u: Vec<f64> = nodes.iter().flat_map(|node| [0, 1, 2].map(|axis| dof(3 * node + axis))).collect();
            let axes = mean_axes(alone, &u);
            let elastic =
                seen.iter().map(|node| Vector3::from_column_slice(&axes.displacement[3 * node..3 * node + 3]));
            Seen {
                rotation: axes.rotation,
                center: Vector3::from(bar.at) + center(alone, &u),
                elastic: elastic.collect(),
            }
        };
        frame.bars.iter().zip(&parts).map(of_bar).collect()
    };
    Ok(JoinedReference(coarse.iter().zip(&fine).map(at_time).collect()))
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The centre of mass of a displaced solid.
fn center(solid: &Solid, u: &[f64]) -> Vector3<f64> {
    let all: Vec<f64> = solid.mesh().positions().iter().flatten().zip(u).map(|(x, u)| x + u).collect();
    let ones: Vec<f64> = (0..u.len()).map(|k| f64::from(u8::from(k % 3 == 0))).collect();
    let (momentum, mass) = (solid.momentum(&all), solid.momentum(&ones).iter().sum::<f64>());
    Vector3::from_fn(|axis, _| momentum.iter().skip(axis).step_by(3).sum::<f64>() / mass)
}

/// How far a system with these hinges is off, with keys that all its bodies have in addition.
///
/// # Errors
/// Errors of the scene and of the run.
pub fn off(
    directory: &Path,
    frame: &BarFrame,
    motions: &Motions,
    hinge: Hinge,
    keys: &str,
    reference: &JoinedReference,
) -> Result<Off, SolidError> {
    let text = scene(directory, frame, motions, hinge, keys)?;
    let built = built(directory, &text)?;
    let control = StepControl::Tolerance(1e-6);
    let mut simulation = built.start(control, motions.end, motions.end / motions.rows as f64, false)?;
    let found = rows(&mut simulation, frame.bars.len())?;
    let mut off = Off::default();
    let elastic = |of: &Seen| of.elastic.iter().map(|u| u.norm()).fold(0.0, f64::max);
    off.peak = reference.0.iter().flatten().map(elastic).fold(0.0, f64::max);
    for (row, expected) in found.iter().zip(&reference.0) {
        for (body, seen) in row.iter().zip(expected) {
            compare(body, seen, &mut off);
        }
    }
    off.elastic /= off.peak;
    Ok(off)
}

fn compare(body: &Observation, seen: &Seen, off: &mut Off) {
    let global_from_body = Matrix3::from_columns(&[0, 1, 2].map(|k| body.attitude.to_global(&Vector3::ith(k, 1.0))));
    let turned = global_from_body * seen.rotation.transpose();
    let turn = 0.5
        * Vector3::new(
            turned[(2, 1)] - turned[(1, 2)],
            turned[(0, 2)] - turned[(2, 0)],
            turned[(1, 0)] - turned[(0, 1)],
        );
    off.attitude = off.attitude.max(turn.norm());
    off.center = off.center.max((body.origin_global - seen.center).norm());
    for (point, expected) in body.points.iter().zip(&seen.elastic) {
        off.elastic = off.elastic.max((point.elastic_displacement_body - expected).norm());
    }
}

/// The scene of a frame.
fn scene(
    directory: &Path,
    frame: &BarFrame,
    motions: &Motions,
    hinge: Hinge,
    keys: &str,
) -> Result<String, SolidError> {
    let failed = |error: std::io::Error| SolidError::Mesh(error.to_string());
    for (name, upright) in [("lying", false), ("upright", true)] {
        let mesh = frame.bar(upright);
        write(directory, name, &mesh, &frame.lines(upright, &mesh)).map_err(failed)?;
    }
    let Material { young_modulus, poisson_ratio, density } = motions.material;
    let lines = lines(frame, motions.hung);
    let mut text = "title = 'frame'\nunits = { length = 'm', mass = 'kg', time = 's' }\n".to_owned();
    for (number, (bar, [velocity, omega])) in frame.bars.iter().zip(&motions.velocities).enumerate() {
        let points: Vec<String> =
            places(frame, bar.upright).iter().zip(0..).map(|(x, i)| format!("p{i} = {:?}", x.as_slice())).collect();
        let markers: String = lines
            .iter()
            .enumerate()
            .filter(|(_, (bars, _))| bars.contains(&Some(number)))
            .map(|(line, (_, at))| {
                let edges = frame.edges(bar.upright);
                let is_here = |[x, z]: &[f64; 2]| near(bar.at[0] + x, at[0]) && near(bar.at[2] + z, at[1]);
                let edge = edges.iter().position(is_here).unwrap_or_default();
                let tie = if hinge == Hinge::Balls { "nodes" } else { "mean" };
                format!("[bodies.b{number}.markers.l{line}]\ngroup = 'edge{edge}'\ntie = '{tie}'\n")
            })
            .collect();
        text += &format!(
            "[bodies.b{number}]\nmesh = '{}.msh'\n\
             material = {{ young_modulus = {young_modulus:e}, poisson_ratio = {poisson_ratio}, density = {density} }}\n\
             initial = {{ position = {:?}, velocity = {:?}, angular_velocity = {:?} }}\n\
             loads = [{{ kind = 'gravity', direction = [0, 0, -1], amplitude = {} }}]\npoints = {{ {} }}\n{keys}\n{markers}",
            if bar.upright { "upright" } else { "lying" },
            bar.at,
            velocity.as_slice(),
            omega.as_slice(),
            motions.gravity,
            points.join(", ")
        );
    }
    for (line, (bars, _)) in lines.iter().enumerate() {
        let ends = bars.map(|bar| bar.map_or("ground".to_owned(), |bar| format!("b{bar}.l{line}")));
        text += &format!("[[joints]]\nkind = 'revolute'\nbetween = {ends:?}\naxis = [0, 1, 0]\n");
    }
    Ok(text + &format!("[time]\nend = {}\ntolerance = 1e-6\n", motions.end))
}

/// Lines (x, z) that two bars share, or one and the ground.
fn lines(frame: &BarFrame, hung: bool) -> Vec<([Option<usize>; 2], [f64; 2])> {
    let h = frame.size[2];
    let corners = |bar: &FrameBar| frame.edges(bar.upright).map(|[x, z]| [bar.at[0] + x, bar.at[2] + z]);
    let mut lines = Vec::new();
    if hung {
        lines.push(([None, Some(0)], [frame.bars[0].at[0], frame.bars[0].at[2] + h]));
    }
    for (i, first) in frame.bars.iter().enumerate() {
        for (j, second) in frame.bars.iter().enumerate().skip(i + 1) {
            for corner in corners(first) {
                if corners(second).iter().any(|other| near(other[0], corner[0]) && near(other[1], corner[1])) {
                    lines.push(([Some(i), Some(j)], corner));
                }
            }
        }
    }
    lines
}
