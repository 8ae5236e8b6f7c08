//! Small motions of free bodies, and of bodies in joints, about rest or a steady spin.

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Coordinate, Island, Linearization, MotionState, Row, SteadyError, SteadyState, SystemMotion};
use faer::Mat;
use linear::{Channel, Output, Rate, SecondOrder};
use model::Model;
use nalgebra::Vector3;
use scene::Scene;

use super::channels::{
    BodyRows, Channels, input_channels, over_columns, point_outputs, unit_of_coordinate, wrench_channels,
};
use super::settings::LinearSettings;
use super::state::{State, damping_in_words};
use super::system_spin::SystemSpin;
use crate::commands::linear::names::is_asked;
use crate::motion::{self, StartSettings};
use crate::rows::units::UnitLabels;

/// An acceleration beside ω² times the size of the bodies that is more than rounding.
const UNSTEADY: f64 = 1e-6;
/// The same at rest, to the square of a frequency.
const ROUNDING: f64 = 1e-12;

/// The equations, with the state that they are about.
pub(super) fn of_system(
    scene: &Scene,
    models: &[Model],
    spin: Option<Vector3<f64>>,
    states: Option<&[MotionState]>,
    settings: &LinearSettings,
) -> Result<(Channels, State), Failure> {
    let references: Vec<&Model> = models.iter().collect();
    let no_body = || Kind::Refused.of(&scene.path).help("name a body in the scene").says("no body");
    let beginning = StartSettings { together: true, ..StartSettings::of(scene, &references) };
    let mut run = motion::begin(scene, &references, &beginning)?;
    let Some(Island { motion, joints, bodies, .. }) = run.islands_mut().first_mut() else { return Err(no_body()) };
    if let Some(states) = states {
        let states: Vec<MotionState> = bodies.iter().map(|body| states[*body].clone()).collect();
        motion.set_states(&states).map_err(|source| source.in_file(&scene.path))?;
    }
    let motion = motion.system_motion().ok_or_else(no_body)?;
    let failed = |source: SteadyError| source.in_file(&scene.path);
    let SystemSpin { omega_global, steady, rotors, warnings: turning } =
        SystemSpin::new(motion, spin).map_err(failed)?;
    let (linear, _) = steady.linear.with_loose_apart().map_err(failed)?;
    let joint_drives: Vec<usize> = (0..joints.len())
        .filter(|joint| {
            let name = drive_input(&scene.joints[joints[*joint]].name);
            motion.system().joints()[*joint].drive.is_some()
                && settings.inputs.iter().any(|asked| is_asked(&name, asked))
        })
        .collect();
    // Changes of place by a unit of each drive, whose values are coordinates after the independent ones.
    let driven: Vec<Vec<f64>> = joint_drives.iter().filter_map(|joint| motion.driven_motion(&steady, *joint)).collect();
    let all = linear.basis.nrows();
    let (free, n) = (linear.size(), linear.size() + driven.len());
    let basis = Mat::from_fn(all, n, |i, j| if j < free { linear.basis[(i, j)] } else { driven[j - free][i] });
    let over = |row: &[f64]| over_columns(row, &basis, 0);

    let mut inputs = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut outputs = Vec::new();
    let mut stresses = Vec::new();
    for (number, (model, state)) in models.iter().zip(steady.states()).enumerate() {
        let (given, own) = (&scene.bodies[number], linear.coordinates_of(number));
        for unit in motion.system().bodies()[number].unit_forces(&state) {
            let mut column = vec![0.0; all];
            column[own.clone()].copy_from_slice(&unit);
            columns.push(column);
        }
        let rows = BodyRows::new(given, model, &state.modal_displacement, models.len() == 1);
        inputs.extend(input_channels(given, model, &rows.prefix));
        let over = |row: &[f64]| over_columns(row, &basis, own.start);
        for (name, point) in rows.points() {
            outputs.extend(point_outputs(given, &name, &point.each_ref().map(|row| over(row))));
        }
        stresses.extend(rows.stresses().into_iter().map(|(of, row)| Output::new(of, Rate::Place, over(&row))));
    }
    let units: UnitLabels = (&scene.units).into();
    for (number, joint) in joints.iter().enumerate() {
        let of = &scene.joints[*joint];
        for coordinate in of.kind.coordinates() {
            let quantity = coordinate.name();
            let [force, unit] = match coordinate {
                Coordinate::Turn => [units.moment(), "rad".to_owned()],
                Coordinate::Slide => [units.force(), units.length.to_owned()],
            };
            let row = motion.coordinate_row(&steady, number, *coordinate);
            let of_coordinates = over(&row);
            inputs.push(Channel::new(format!("{}.{quantity}", of.name), force));
            columns.push(row);
            for (rate, suffix, unit) in
                [(Rate::Place, "", unit.clone()), (Rate::Velocity, ".rate", format!("{unit}/{}", scene.units.time))]
            {
                let channel = Channel::new(format!("{}.{quantity}{suffix}", of.name), unit);
                outputs.push(Output::new(channel, rate, of_coordinates.clone()));
            }
        }
    }
    outputs.extend(stresses);
    let usual = [inputs.len(), outputs.len()];
    // Reactions: forces on the bodies count in them as such, drives by the motion that they give.
    for (number, joint) in joints.iter().enumerate() {
        let of = motion.reaction_rows(&steady, number);
        let times = |matrix: &Mat<f64>, i: usize| over(&(0..all).map(|k| matrix[(i, k)]).collect::<Vec<f64>>());
        for (i, channel) in wrench_channels(scene, &scene.joints[*joint].name).into_iter().enumerate() {
            let of_input = columns.iter().map(|force| (0..all).map(|k| of.by_force[(i, k)] * force[k]).sum());
            // The part of accelerations of independent coordinates is rounding.
            let of_drives = times(&of.by_acceleration, i).split_off(free);
            let direct = of_input.chain(of_drives).collect();
            let rows = [times(&of.by_place, i), times(&of.by_rate, i), Vec::new()];
            outputs.push(Output { channel, rows, direct });
        }
    }
    let coupling = |matrix: &Mat<f64>, i: usize, column: &[f64]| -> f64 {
        (0..all).map(|k| linear.basis[(k, i)] * (0..all).map(|l| matrix[(k, l)] * column[l]).sum::<f64>()).sum()
    };
    let [whole_stiffness, whole_damping] = motion.whole_matrices(&steady);
    let with_drives = |of_free: &Mat<f64>, whole: &Mat<f64>| {
        Mat::from_fn(n, n, |i, j| match (i < free, j < free) {
            (true, true) => of_free[(i, j)],
            (true, false) => coupling(whole, i, &driven[j - free]),
            _ => 0.0,
        })
    };
    let (stiffness, damping) =
        (with_drives(&linear.stiffness, &whole_stiffness), with_drives(&linear.damping, &whole_damping));
    let on_free = |i: usize, column: &[f64]| (0..all).map(|k| linear.basis[(k, i)] * column[k]).sum::<f64>();
    let forces = Mat::from_fn(n, columns.len() + driven.len(), |i, j| match j.checked_sub(columns.len()) {
        None if i < free => on_free(i, &columns[j]),
        Some(drive) if i == free + drive => 1.0,
        _ => 0.0,
    });
    let unit = unit_of_coordinate(scene);
    let mut coordinates: Vec<Channel> = (1..=free).map(|k| Channel::new(format!("x{k}"), unit.clone())).collect();
    let mut more_inputs = Vec::new();
    for (number, joint) in joints.iter().enumerate() {
        let (name, of) = (&scene.joints[*joint].name, &motion.system().joints()[number]);
        let Some(quantity) = of.rows.iter().find_map(driven_unit) else { continue };
        let unit = if quantity == "turn" { "rad" } else { units.length };
        match joint_drives.iter().position(|driven| *driven == number) {
            Some(drive) => {
                inputs.push(Channel::new(drive_input(name), format!("{unit}/{}²", scene.units.time)));
                coordinates.push(Channel::new(format!("{name}.drive"), unit));
                let mut row = vec![0.0; n];
                row[free + drive] = 1.0;
                outputs.push(Output::new(Channel::new(format!("{name}.drive.value"), unit), Rate::Place, row));
            }
            None => more_inputs.push(drive_input(name)),
        }
    }
    let equations = SecondOrder { stiffness, damping, forces, inputs, outputs, coordinates };
    let mut warnings = unsteady(motion, &steady, &omega_global);
    warnings.extend(turning);
    let state = State {
        time: motion.time(),
        omega_global: omega_global.into(),
        rotors: rotors.iter().map(|rotor| rotor.words(&scene.units.time)).collect(),
        rigid: linear.rigid,
        damping: damping_in_words(models),
        warnings,
    };
    Ok((Channels { equations, usual, more_inputs }, state))
}

/// Name of the input of a joint's drive.
fn drive_input(joint: &str) -> String {
    format!("{joint}.drive.acceleration")
}

/// The coordinate that a row drives, if it does.
fn driven_unit(row: &Row) -> Option<&'static str> {
    match row {
        Row::DrivenRotation => Some("turn"),
        Row::DrivenPoint => Some("slide"),
        _ => None,
    }
}

/// An angular acceleration at rest that is no more than rounding: to the square of the slowest frequency of what deforms bodies, of rigid ones to
/// that of the stiffest spring.
fn rounding_at_rest(linear: &Linearization) -> f64 {
    let of = |i: usize| linear.stiffness[(i, i)].abs();
    let slowest = (linear.rigid..linear.stiffness.nrows()).map(of).reduce(f64::min);
    let scale = slowest.unwrap_or_else(|| (0..linear.rigid).map(of).fold(0.0, f64::max));
    if scale > 0.0 { ROUNDING * scale } else { f64::EPSILON }
}

/// Reservations about a state that does more than stand or spin.
fn unsteady(motion: &SystemMotion, steady: &SteadyState, omega: &Vector3<f64>) -> Vec<String> {
    let turning = steady.unbalance.angular_accelerations.iter().map(Vector3::norm).fold(0.0, f64::max);
    let moving = steady.unbalance.accelerations.iter().map(Vector3::norm).fold(0.0, f64::max);
    let mut warnings = Vec::new();
    let rounding = if omega.norm() > 0.0 { UNSTEADY * omega.norm_squared() } else { rounding_at_rest(&steady.linear) };
    if turning > rounding {
        warnings.push(format!(
            "the state is not steady: a body is accelerated by {turning:.3e} rad per time squared; the equations hold for the instant"
        ));
    }
    if moving > f64::EPSILON * motion.center_of_mass().norm().max(1.0) && omega.norm() == 0.0 && turning <= rounding {
        warnings.push(format!(
            "the bodies are accelerated as a whole by {moving:.3e} at the start; the equations are about that motion"
        ));
    }
    warnings
}
