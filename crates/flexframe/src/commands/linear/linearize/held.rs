//! Small motions of a body that is held, or held in a driven spin.

mod base;
mod driven;
mod rigid;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{AtRest, DrivenMotion, Initial, LoadedError};
use faer::Mat;
use linear::{Channel, Output, Rate, SecondOrder};
use model::Model;
use nalgebra::Vector3;
use scene::Body;

use super::channels::{
    BodyRows, Channels, base_accelerations, input_channels, over_columns, point_outputs, relative_outputs,
    unit_of_coordinate, wrench_channels,
};
use super::settings::LinearSettings;
use super::state::{State, damping_in_words};
use crate::commands::linear::names::is_asked;
use base::base_channels;
use driven::Driven;
use rigid::{acts_on, rigid_motions};

/// The equations about rest under the loads of a time, or about the spin of a drive then.
pub(super) fn of_held(
    body: &Body,
    model: &Model,
    (initial, time): (&Initial, f64),
    settings: &LinearSettings,
) -> Result<(Channels, State), Failure> {
    let refuse = |found: &str, help: &str| Err(Kind::Refused.of(&body.path).help(help).says(found));
    if model.physics.large_deflection.is_some() {
        return refuse("a body with large modes", "give `large_deflection = false` in [effects]");
    }
    let failed = |source: LoadedError| source.in_file(&body.path);
    let rest = model.at_rest(initial, time).map_err(failed)?;
    let AtRest { unit_forces, modal_displacement, .. } = &rest;
    // Rigid motions that are left: none of a drive, which is given.
    let rigid = if model.physics.drive.is_none() { rigid_motions(model) } else { Vec::new() };
    if unit_forces.iter().zip(model.loads()).any(|(unit, load)| acts_on(&rigid, unit, &**load, time)) {
        return refuse(
            "loads act on a body that can turn or slide, which gives it a stiffness or an acceleration",
            "say the support as a joint to the ground ([[joints]]), whose linear model has it",
        );
    }
    let nf = modal_displacement.len();
    let drive = Driven::new(model, time);
    let mut omega_global = Vector3::zeros();
    if let Some(Driven { motion: DrivenMotion::Turn { axis }, speed, .. }) = &drive {
        omega_global = initial.attitude.global_to_body().transpose() * axis * *speed;
    }
    let asked_drive = drive.filter(|_| settings.inputs.iter().any(|asked| is_asked(Driven::INPUT, asked)));
    let (r, d) = (rigid.len(), usize::from(asked_drive.is_some()));
    let n = r + nf + d;
    let of_modes = |matrix: &Mat<f64>| {
        let is_mode = |i: usize| (r..r + nf).contains(&i);
        Mat::from_fn(n, n, |i, j| if is_mode(i) && is_mode(j) { matrix[(6 + i - r, 6 + j - r)] } else { 0.0 })
    };
    // The displacement of a drive is none that the body sees.
    let basis = Mat::from_fn(6 + nf, n, |i, j| match (j.checked_sub(r), i) {
        (None, 0..6) => rigid[j].along(i),
        (Some(mode), 6..) => f64::from(u8::from(mode == i - 6)),
        _ => 0.0,
    });
    let over = |row: &[f64]| over_columns(row, &basis, 0);
    let mut columns: Vec<Vec<f64>> = unit_forces.iter().map(|unit| over(unit)).collect();
    let mut inputs = input_channels(body, model, "");
    let usual_inputs = inputs.len();
    // Accelerations that an input gives all of the support, along the axes of the body: the first of a load that stands for them.
    let base = base_channels(body);
    let in_spin = drive.is_some_and(|driven| driven.is_spin());
    // Motions of the frame: an acceleration of it by each input, along its axes. Outputs in a spin are as seen from the body.
    let part = f64::from(u8::from(!in_spin));
    let by_load = |global: &Vector3<f64>| {
        let along = initial.attitude.to_body(global) * part;
        [along.x, along.y, along.z, 0.0, 0.0, 0.0]
    };
    let mut moved: Vec<[f64; 6]> = base_accelerations(body, model).iter().map(by_load).collect();
    let shakes = |asked: &String| base.iter().any(|channel| is_asked(&channel.name, asked));
    let has_base = moved.iter().flatten().any(|part| *part != 0.0) || settings.inputs.iter().any(shakes);
    let names = (1..=r).map(|k| format!("rigid{k}")).chain((1..=nf).map(|k| format!("mode{k}")));
    let unit = unit_of_coordinate(body);
    let mut coordinates: Vec<Channel> = names.map(|name| Channel::new(name, unit.clone())).collect();
    let (stiffness, mut damping) = (of_modes(&rest.stiffness), of_modes(&rest.damping));
    let (mut outputs, mut relative) = (Vec::new(), Vec::new());
    let rows = BodyRows::new(body, model, modal_displacement, true);
    let points = rows.points();
    for (name, shapes) in &points {
        let shapes = shapes.each_ref().map(|row| over(row));
        outputs.extend(point_outputs(body, name, &shapes));
        if has_base && !in_spin {
            relative.extend(relative_outputs(body, name, &shapes));
        }
    }
    let motions = outputs.len();
    outputs.extend(rows.stresses().into_iter().map(|(of, row)| Output::new(of, Rate::Place, over(&row))));
    let usual_outputs = outputs.len();
    let first_relative = outputs.len();
    outputs.extend(relative);

    // Of a body that only its modes move: base and drive, and the reaction, which the rows of the frame are.
    let mut more_inputs = Vec::new();
    if rigid.is_empty() {
        let AtRest { mass, damping: rates, stiffness: places, driven: along, .. } = &rest;
        let mut direct: Vec<[f64; 6]> = unit_forces.iter().map(|unit| std::array::from_fn(|i| -unit[i])).collect();
        // A base that tilts a spin changes more than accelerations.
        let known = if in_spin { 3 } else { base.len() };
        for (motion, channel) in base.into_iter().enumerate().take(known) {
            columns.push((0..n).map(|k| if k < nf { -mass[(6 + k, motion)] } else { 0.0 }).collect());
            direct.push(std::array::from_fn(|i| mass[(i, motion)]));
            moved.push(std::array::from_fn(|i| if i == motion { part } else { 0.0 }));
            inputs.push(channel);
        }
        let of_drive = |matrix: &Mat<f64>, i: usize| -> f64 {
            along.iter().flatten().enumerate().map(|(k, part)| matrix[(i, k)] * part).sum()
        };
        if let Some(driven) = &asked_drive {
            (0..nf).for_each(|k| damping[(k, nf)] = of_drive(rates, 6 + k));
            columns.push((0..n).map(|k| if k < nf { -of_drive(mass, 6 + k) } else { 1.0 }).collect());
            direct.push(std::array::from_fn(|i| of_drive(mass, i)));
            moved.push(along.map_or([0.0; 6], |along| along.map(|of| of * part)));
            let [input, coordinate] = driven.channels(body);
            inputs.push(input);
            let mut row = vec![0.0; n];
            row[nf] = 1.0;
            outputs.push(Output::new(coordinate.clone(), Rate::Place, row));
            coordinates.push(coordinate);
        }
        for (i, channel) in wrench_channels(body, "reaction").into_iter().enumerate() {
            let row = |matrix: &Mat<f64>, of_drive: f64| -> Vec<f64> {
                (0..n).map(|k| if k < nf { matrix[(i, 6 + k)] } else { of_drive }).collect()
            };
            let rows = [row(places, 0.0), row(rates, of_drive(rates, i)), row(mass, 0.0)];
            outputs.push(Output { channel, rows, direct: direct.iter().map(|of_input| of_input[i]).collect() });
        }
    }
    // Accelerations are absolute: base and drive add theirs; those relative to the support have none of the base.
    let mut relative = vec![[0.0; 6]; moved.len()];
    if let (Some(_), Some(last), Some(of_drive)) = (asked_drive, relative.last_mut(), moved.last()) {
        *last = *of_drive;
    }
    for (point, (_, rows)) in points.iter().enumerate() {
        for (axis, row) in rows.iter().enumerate() {
            let absolute = motions / points.len() * point + 6 + axis;
            for (added, output) in [(&moved, absolute), (&relative, first_relative + 3 * point + axis)] {
                let along = |of: &[f64; 6]| of.iter().zip(row).map(|(of, row)| of * row).sum::<f64>();
                let direct: Vec<f64> = added.iter().map(along).collect();
                if direct.iter().any(|x| *x != 0.0) && (output == absolute || has_base && !in_spin) {
                    outputs[output].direct = direct;
                }
            }
        }
    }
    if drive.is_some() && asked_drive.is_none() {
        more_inputs.push(Driven::INPUT.to_owned());
    }
    let forces = Mat::from_fn(n, columns.len(), |i, j| columns[j].get(i).copied().unwrap_or(0.0));
    let equations = SecondOrder { stiffness, damping, forces, inputs, outputs, coordinates };
    let state = State {
        time,
        omega_global: omega_global.into(),
        rotors: Vec::new(),
        rigid: r,
        damping: damping_in_words([model]),
        warnings: Vec::new(),
    };
    Ok((Channels { equations, usual: [usual_inputs, usual_outputs], more_inputs }, state))
}
