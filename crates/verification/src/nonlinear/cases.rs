//! Comparisons: runs of flexframe and of the nonlinear body on the same mesh.

use std::path::Path;

use dynamics::Observation;
use fem_tet10::Material;
use model::Model;
use nalgebra::Vector3;
use scene::Body;

use crate::nonlinear::error::SolidError;
use crate::nonlinear::mean_axes::mean_axes;
use crate::nonlinear::motion::{NodalState, SolidMotion, dot};
use crate::nonlinear::signal;
use crate::nonlinear::solid::Solid;

/// A scene of a mesh of this crate in SI, read and built.
///
/// # Errors
/// Errors of the scene.
pub fn built(mesh: &str, material: Material, rest: &str) -> Result<(Body, Model), SolidError> {
    let Material { young_modulus, poisson_ratio, density } = material;
    let text = format!(
        "title = \"Case\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\n\
         mesh = \"meshes/{mesh}.msh\"\n\
         material = {{ young_modulus = {young_modulus:e}, poisson_ratio = {poisson_ratio:e}, density = {density:e} }}\n\
         {rest}"
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scene.toml");
    let body = Body::parse(&text, path).map_err(|error| SolidError::Scene(error.to_string()))?;
    let model = Model::build(&body, |_| ()).map_err(|error| SolidError::Scene(error.to_string()))?;
    Ok((body, model))
}

/// All rows of a run.
///
/// # Errors
/// Errors that stop it.
pub fn rows(body: &Body, model: &Model) -> Result<Vec<Observation>, SolidError> {
    let failed = |error: &dyn std::error::Error| SolidError::Scene(error.to_string());
    let run = model.start(body).map_err(|error| failed(&error))?;
    run.map(|row| row.map_err(|error| failed(&error))).collect()
}

/// The shape of a flexible mode (3n), numbered from 0.
pub fn shape(model: &Model, mode: usize) -> Vec<f64> {
    model.meshed.iter().flat_map(|meshed| meshed.modes.shapes.col(mode).iter().copied().collect::<Vec<_>>()).collect()
}

/// The largest displacement of a node in a shape, and its part along an axis.
pub fn peaks(shape: &[f64], axis: usize) -> [f64; 2] {
    let nodes = || shape.chunks_exact(3);
    [
        nodes().map(|u| (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt()).fold(0.0, f64::max),
        nodes().map(|u| u[axis].abs()).fold(0.0, f64::max),
    ]
}

/// A quantity over time.
#[derive(Debug, Clone, Default)]
pub struct TimeCurve {
    /// Times.
    pub times: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
}

impl TimeCurve {
    /// Largest size.
    pub fn peak(&self) -> f64 {
        self.values.iter().fold(0.0, |peak, value| value.abs().max(peak))
    }

    /// Largest distance from another course, which is read by straight lines between its samples.
    pub fn distance(&self, other: &Self) -> f64 {
        let at = |t: f64| {
            let i = other.times.partition_point(|s| *s < t).clamp(1, other.times.len() - 1);
            let [a, b] = [other.times[i - 1], other.times[i]];
            other.values[i - 1] + (t - a) / (b - a) * (other.values[i] - other.values[i - 1])
        };
        self.times.iter().zip(&self.values).map(|(t, value)| (value - at(*t)).abs()).fold(0.0, f64::max)
    }
}

/// Which of the first eight modes of the L are in its plane.
pub fn in_plane(model: &Model) -> Vec<usize> {
    (0..model.body.flexible())
        .filter(|k| {
            let [peak, across] = peaks(&shape(model, *k), 2);
            across < 0.2 * peak
        })
        .collect()
}

const L_MODES: &str = "[modes]\nflexible = 8\n";

/// The free L in eight undamped modes.
///
/// # Errors
/// Errors of the scene.
pub fn the_l(rest: &str) -> Result<(Body, Model), SolidError> {
    built("l", crate::nonlinear::bodies::SOFT, &format!("{L_MODES}{rest}"))
}

/// Deflection of the spinning L in its first mode in the plane, over `periods` of it from the undeformed state, with a spin
/// of a part of its frequency: of the nonlinear body, and of flexframe with `rest` in its scene.
///
/// # Errors
/// Errors that stop a run.
pub fn spinning_l(part: f64, periods: f64, rests: &[&str]) -> Result<(f64, Vec<TimeCurve>), SolidError> {
    let (_, model) = the_l("static_correction = false\n[time]\nend = 1e-3\nstep = 1e-3")?;
    let first = in_plane(&model)[0];
    let omega = model.body.circular_frequencies[first];
    let spin = part * omega;
    let end = periods * std::f64::consts::TAU / omega;
    let solid = Solid::new(crate::nonlinear::bodies::mesh("l")?, crate::nonlinear::bodies::SOFT, |_| false)?;
    let phi = shape(&model, first);
    let momentum = solid.momentum(&phi);
    let center = model.body.center_of_mass;
    let v: Vec<f64> = solid
        .mesh()
        .positions()
        .iter()
        .flat_map(|x| <[f64; 3]>::from(Vector3::new(0.0, 0.0, spin).cross(&(Vector3::from(*x) - center))))
        .collect();
    let start = NodalState { time: 0.0, u: vec![0.0; v.len()], v };
    let steps = (100.0 * periods).ceil();
    let mut motion = SolidMotion::new(&solid, start, end / steps, |_, u| vec![0.0; u.len()]);
    let mut course = TimeCurve { times: vec![0.0], values: vec![0.0] };
    for _ in 0..steps as usize {
        motion.advance()?;
        course.times.push(motion.state.time);
        course.values.push(dot(&momentum, &mean_axes(&solid, &motion.state.u).displacement));
    }
    let mut courses = vec![course];
    let names: Vec<String> = in_plane(&model).iter().take(2).map(|k| (k + 1).to_string()).collect();
    for rest in rests {
        let rest = rest.replace("IN_PLANE", &names.join(", "));
        let (scene, model) = the_l(&format!(
            "{rest}\n[initial]\nangular_velocity = [0.0, 0.0, {spin:e}]\n[time]\nend = {end:e}\nstep = {:e}",
            end / (10.0 * steps)
        ))?;
        let rows = rows(&scene, &model)?;
        // Modes may come with either sign.
        let sign = dot(&shape(&model, first), &momentum).signum();
        courses.push(TimeCurve {
            times: rows.iter().map(|row| row.time).collect(),
            values: rows.iter().map(|row| sign * row.modal_displacement[first]).collect(),
        });
    }
    Ok((omega, courses))
}

/// Frequency of a course in cycles per time; of a `step` of the midpoint rule, which is slow by a known amount, or of none.
pub fn cycles(course: &TimeCurve, omega: f64, step: Option<f64>) -> f64 {
    let found = signal::frequency(&course.times, &course.values, omega, 3);
    let exact = step.map_or(found, |h| 2.0 / h * (0.5 * found * h).tan());
    exact / std::f64::consts::TAU
}

/// Strain energy of a mode that is held at amplitudes q, over ½ω²q², less 1, and its part that the mesh has: the nonlinear
/// body.
///
/// # Errors
/// A solution that is not found.
pub fn static_energy(solid: &Solid, model: &Model, mode: usize, q: f64) -> Result<f64, SolidError> {
    let mut shapes = vec![shape(model, mode)];
    if let Some(meshed) = &model.meshed {
        shapes.extend(meshed.modes.rigid.shapes.col_iter().map(|column| column.iter().copied().collect()));
    }
    let mut amounts = vec![0.0; shapes.len()];
    amounts[0] = q;
    let omega = model.body.circular_frequencies[mode];
    let u = solid.held_in_modes(&shapes, &amounts, 0.3 * omega * omega, 12)?;
    Ok(solid.strain_energy(&u) / (0.5 * (omega * q).powi(2)) - 1.0)
}

/// A soft rod of 1 m that is hinged at its end and falls from the horizontal under gravity: the deflection of its tip in
/// its own frame, of the nonlinear body and of flexframe with each of `rests` in its scene.
///
/// # Errors
/// Errors that stop a run.
pub fn pendulum(young_modulus: f64, end: f64, steps: usize, rests: &[&str]) -> Result<Vec<TimeCurve>, SolidError> {
    let material = crate::nonlinear::bodies::soft(young_modulus);
    let solid = Solid::new(crate::nonlinear::bodies::mesh("rod")?, material, |x| x.x.abs() < 1e-9 && x.z.abs() < 1e-9)?;
    let down: Vec<f64> = (0..solid.dofs()).map(|k| if k % 3 == 2 { -9.81 } else { 0.0 }).collect();
    let weight = solid.momentum(&down);
    let tip = solid.mesh().positions().iter().position(|x| (Vector3::from(*x) - Vector3::x()).norm() < 1e-9);
    let tip = tip.ok_or(SolidError::Mesh("the rod has no node at its tip".to_owned()))?;
    let rest = vec![0.0; solid.dofs()];
    let start = NodalState { time: 0.0, u: rest.clone(), v: rest };
    let mut motion = SolidMotion::new(&solid, start, end / steps as f64, |_, _| weight.clone());
    let mut course = TimeCurve { times: vec![0.0], values: vec![0.0] };
    for _ in 0..steps {
        motion.advance()?;
        course.times.push(motion.state.time);
        course.values.push(turned_back(&solid, &motion.state.u, tip).z);
    }
    let mut courses = vec![course];
    for rest in rests {
        let text = format!(
            "{rest}\n[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n\
             [[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9.81\n\
             [output.points]\ntip = [1.0, 0.0, 0.0]\n[time]\nend = {end:e}\nstep = {:e}\n",
            end / (4 * steps) as f64
        );
        let (scene, model) = built("rod", material, &text)?;
        let rows = rows(&scene, &model)?;
        courses.push(TimeCurve {
            times: rows.iter().map(|row| row.time).collect(),
            values: rows
                .iter()
                .map(|row| row.attitude.to_body(&(Vector3::x() + row.points[0].displacement)).z)
                .collect(),
        });
    }
    Ok(courses)
}

/// Displacement of a node of a body that is hinged about the y-axis, in the frame in which Σ m X × u has no part along it.
fn turned_back(solid: &Solid, u: &[f64], node: usize) -> Vector3<f64> {
    let positions = solid.mesh().positions();
    let all: Vec<f64> = positions.iter().flatten().zip(u).map(|(x, u)| x + u).collect();
    let (mut along, mut across) = (0.0, 0.0);
    for (at, momentum) in positions.iter().zip(solid.momentum(&all).chunks_exact(3)) {
        along += at[0] * momentum[0] + at[2] * momentum[2];
        across += at[2] * momentum[0] - at[0] * momentum[2];
    }
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), across.atan2(along));
    let at = Vector3::from(positions[node]);
    turn.inverse() * Vector3::from_column_slice(&all[3 * node..3 * node + 3]) - at
}

/// Frequency in cycles per time of small vibrations in the first mode of a free body under a pressure on some faces: of the
/// nonlinear body, and of flexframe, without the pressure and with it. A pressure without a resultant has the body vibrate
/// about its rest, with `shift` over the square of the circular frequency as in [`Solid::at_rest`]; without a shift the
/// pressure acts at once and takes the body along.
///
/// # Errors
/// Errors that stop a run.
pub fn pressed(
    mesh: &str,
    young_modulus: f64,
    pressures: &[(&str, f64)],
    is_on: impl Fn(Vector3<f64>) -> bool,
    shift: Option<f64>,
) -> Result<[f64; 3], SolidError> {
    let material = crate::nonlinear::bodies::soft(young_modulus);
    let loads: String = pressures
        .iter()
        .map(|(group, size)| format!("[[loads]]\nkind = \"pressure\"\ngroup = \"{group}\"\namplitude = {size:e}\n"))
        .collect();
    let scene = |rest: &str| {
        built(
            mesh,
            material,
            &format!(
                "[modes]\nflexible = 20\nstatic_correction = false\n{rest}[effects]\ntolerance = 1e-9\nrefuse = false\n\
                 [time]\nend = 1e-4\nstep = 1e-4\n"
            ),
        )
    };
    let (_, free) = scene("")?;
    let (with, model) = scene(&loads)?;
    let loaded = model.loaded_modes(&with).map_err(|error| SolidError::Scene(error.to_string()))?;
    let solid = Solid::new(crate::nonlinear::bodies::mesh(mesh)?, material, |_| false)?;
    let faces = solid.faces(is_on);
    let size = pressures[0].1;
    let force = |u: &[f64]| solid.pressure(&faces, u).iter().map(|f| f * size).collect::<Vec<f64>>();
    let omega = free.body.circular_frequencies[0];
    let at_rest = match shift {
        Some(shift) => solid.at_rest(1, shift * omega * omega, force)?,
        None => vec![0.0; solid.dofs()],
    };
    let phi = shape(&free, 0);
    let momentum = solid.momentum(&phi);
    let amplitude = 1e-5 / peaks(&phi, 0)[0];
    let u = at_rest.iter().zip(&phi).map(|(u, phi)| u + amplitude * phi).collect();
    // Short enough for the tangent, which is without that of the pressure, where the rod turns about itself.
    let h = std::f64::consts::TAU / omega / 200.0;
    let mut motion = SolidMotion::new(&solid, NodalState { time: 0.0, u, v: vec![0.0; phi.len()] }, h, |_, u| force(u));
    let mut course = TimeCurve::default();
    for _ in 0..800 {
        motion.advance()?;
        course.times.push(motion.state.time);
        course.values.push(dot(&momentum, &mean_axes(&solid, &motion.state.u).displacement) / amplitude);
    }
    let found = signal::frequency(&course.times, &course.values, omega, 1);
    let found = 2.0 / h * (0.5 * found * h).tan() / std::f64::consts::TAU;
    Ok([found, omega / std::f64::consts::TAU, loaded[0].circular_frequency / std::f64::consts::TAU])
}
