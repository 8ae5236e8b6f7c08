//! Small motions of free bodies, and of bodies in joints, about rest or a steady spin.

use dynamics::{CommonSpin, Coordinate, SteadyState, SystemMotion};
use faer::Mat;
use linear::{Channel, Output, Rate, SecondOrder};
use model::Model;
use nalgebra::Vector3;
use scene::System;

use super::channels::{input_channels, point_outputs, unit_of_coordinate};
use super::error::LinearizeError;
use super::state::State;
use crate::motion::{self, Beginning, Motion};
use crate::rows::units::UnitLabels;

/// An acceleration beside ω² times the size of the bodies that is more than rounding.
const UNSTEADY: f64 = 1e-6;

/// The equations, with the state that they are about.
pub(super) fn of_system(
    system: &System,
    models: &[Model],
    spin: Option<Vector3<f64>>,
) -> Result<(SecondOrder, State), LinearizeError> {
    let scene = &system.bodies[0];
    let references: Vec<&Model> = models.iter().collect();
    let refuse =
        |found: &str, help| LinearizeError::Refused { scene: scene.path.clone(), found: found.to_owned(), help };
    let no_body = || refuse("no body", "name a body in the scene");
    let beginning = Beginning::of(system, &references).ok_or_else(no_body)?;
    let beginning = Beginning { together: true, ..beginning };
    let moving = motion::begin(system, &references, &beginning).map_err(Box::new)?;
    let Some(Motion::Tied(simulation)) = moving.first().map(|moving| &moving.motion) else { return Err(no_body()) };
    let motion = simulation.motion();
    let omega_global = spin.unwrap_or_else(Vector3::zeros);
    let common = CommonSpin { omega_global, point_global: motion.center_of_mass() };
    let failed = |source| LinearizeError::Steady { scene: scene.path.clone(), source: Box::new(source) };
    let steady = motion.steady_state(&common).map_err(failed)?;
    let linear = &steady.linear;
    let n = linear.size();

    let mut inputs = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut outputs = Vec::new();
    let all = linear.basis.nrows();
    for (number, (model, state)) in models.iter().zip(steady.states()).enumerate() {
        let scene = &system.bodies[number];
        let own = linear.coordinates_of(number);
        let name = scene.name.as_ref().filter(|_| models.len() > 1);
        let prefix = name.map_or_else(String::new, |name| format!("{name}."));
        for unit in motion.system().bodies()[number].unit_forces(&state) {
            let mut column = vec![0.0; all];
            column[own.clone()].copy_from_slice(&unit);
            columns.push(column);
        }
        inputs.extend(input_channels(scene, model, &prefix));
        for (name, point) in &model.points {
            let arm = model.arm(point, &state.modal_displacement);
            // ρ + φ×x + Ψ δq, then over the independent coordinates.
            let of_body: Vec<Vector3<f64>> = (0..own.len())
                .map(|k| match k {
                    0..3 => Vector3::ith(k, 1.0),
                    3..6 => Vector3::ith(k - 3, 1.0).cross(&arm),
                    _ => point.columns()[k],
                })
                .collect();
            let of_coordinate = |j: usize| -> Vector3<f64> {
                of_body.iter().enumerate().map(|(k, column)| column * linear.basis[(own.start + k, j)]).sum()
            };
            let columns: Vec<Vector3<f64>> = (0..n).map(of_coordinate).collect();
            outputs.extend(point_outputs(scene, &format!("{prefix}{name}"), &columns));
        }
    }
    let units: UnitLabels = (&scene.units).into();
    let joints = &moving[0].joints;
    for (number, joint) in joints.iter().enumerate() {
        let of = &system.joints[*joint];
        for coordinate in of.kind.coordinates() {
            let (coordinate, quantity, [force, unit]) = match coordinate {
                scene::Coordinate::Turn => (Coordinate::Turn, "turn", [units.moment(), "rad".to_owned()]),
                scene::Coordinate::Slide => (Coordinate::Slide, "slide", [units.force(), units.length.to_owned()]),
            };
            let row = motion.coordinate_row(&steady, number, coordinate);
            let over: Vec<f64> = (0..n).map(|j| (0..all).map(|k| row[k] * linear.basis[(k, j)]).sum()).collect();
            inputs.push(Channel::new(format!("{}.{quantity}", of.name), force));
            columns.push(row);
            for (rate, suffix, unit) in
                [(Rate::Place, "", unit.clone()), (Rate::Velocity, ".rate", format!("{unit}/{}", scene.units.time))]
            {
                let channel = Channel::new(format!("{}.{quantity}{suffix}", of.name), unit);
                outputs.push(Output { channel, rate, row: over.clone() });
            }
        }
    }
    let forces = Mat::from_fn(n, columns.len(), |i, j| (0..all).map(|k| linear.basis[(k, i)] * columns[j][k]).sum());
    let unit = unit_of_coordinate(scene);
    let equations = SecondOrder {
        stiffness: linear.stiffness.clone(),
        damping: linear.damping.clone(),
        forces,
        inputs,
        outputs,
        coordinates: (1..=n).map(|k| Channel::new(format!("x{k}"), unit.clone())).collect(),
    };
    let warnings = unsteady(motion, &steady, &omega_global);
    Ok((equations, State { omega_global: omega_global.into(), rigid: linear.rigid, warnings }))
}

/// Reservations about a state that does more than stand or spin.
fn unsteady(motion: &SystemMotion, steady: &SteadyState, omega: &Vector3<f64>) -> Vec<String> {
    let turning = steady.unbalance.angular_accelerations.iter().map(Vector3::norm).fold(0.0, f64::max);
    let moving = steady.unbalance.accelerations.iter().map(Vector3::norm).fold(0.0, f64::max);
    let mut warnings = Vec::new();
    let rounding = if omega.norm() > 0.0 { UNSTEADY * omega.norm_squared() } else { f64::EPSILON };
    if turning > rounding {
        warnings.push(format!(
            "the state is not steady: a body is accelerated by {turning:.3e} rad per time squared; the equations hold for the instant"
        ));
    }
    if moving > f64::EPSILON * motion.center_of_mass().norm().max(1.0) && omega.norm() == 0.0 && turning == 0.0 {
        warnings.push(format!(
            "the bodies are accelerated as a whole by {moving:.3e} at the start; the equations are about that motion"
        ));
    }
    warnings
}
