//! Figs. 3 to 13 of the paper.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use dynamics::SharedLoad;
use figures::{ChartGrid, FigureError, LineChart, Reference, Scale, Series, Stroke};
use model::Model;
use results::Results;
use scene::Body;

use super::rigid_plate::{RigidHistories, WATCHED_POINT, dead_force};
use crate::commands::pictures::mode_shapes;
use crate::rows::units::UnitLabels;

/// The names of the figures, in the order of the paper.
pub(super) const NAMES: [&str; 11] = [
    "fig03_mode_shapes",
    "fig04_force",
    "fig05_angular_acceleration_13",
    "fig06_angular_velocity_13",
    "fig07_displacement_2",
    "fig08_angular_acceleration_2",
    "fig09_angular_velocity_2",
    "fig10_rigid_acceleration_1",
    "fig11_rigid_acceleration_3",
    "fig12_acceleration_1",
    "fig13_acceleration_3",
];

/// Draws all figures into `folder` and returns their files.
pub(super) fn draw(
    given: &Body,
    model: &Model,
    results: &Results,
    rigid: &RigidHistories,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let units = &given.units;
    let (length, time) = (&units.length, &units.time);
    let x_label = format!("time, {time}");
    let acceleration = format!("{length}/{time}²");
    let times = results.numbers("time").unwrap_or_default();
    let history = |rows: &[[f64; 3]], axis: usize| -> Vec<(f64, f64)> {
        times.iter().copied().zip(rows.iter().map(|row| row[axis])).collect()
    };
    let solid = |label: &str, points| Series { label: label.to_owned(), points, stroke: Stroke::Solid };
    let dashed = |label: &str, points| Series { label: label.to_owned(), points, stroke: Stroke::Dashed };
    let vectors = |path: &str| results.vectors(path).unwrap_or_default();
    let watched = |quantity: &str| vectors(&format!("points/{WATCHED_POINT}/{quantity}"));
    let (alpha, omega) = (vectors("angular_acceleration"), vectors("angular_velocity"));
    let force = |axis: usize| -> Vec<(f64, f64)> {
        let of = |load: &SharedLoad, t: f64| dead_force(load).map_or(0.0, |f| f.force[axis] * f.history.at(t, t));
        let total = |t: f64| model.loads().iter().map(|load| of(load, t)).sum();
        times.iter().map(|t| (*t, total(*t))).collect()
    };
    let beside_rigid = |rows: &[[f64; 3]], theirs: &[[f64; 3]], axis: usize, label: &str| {
        vec![solid(label, history(rows, axis)), dashed("rigid plate", history(theirs, axis))]
    };

    let mut files = mode_shapes::draw(given, model, &folder.join("fig03_mode_shapes"))?.to_vec();
    let reference = |name: &str, rows: &[[f64; 3]], axis: usize| {
        Some(Reference { name: name.to_owned(), value: rows.iter().map(|row| row[axis].abs()).fold(0.0, f64::max) })
    };
    let mut chart =
        |name: &str, title: &str, y_label: String, series: Vec<Series>, reference| -> Result<(), FigureError> {
            let chart = LineChart {
                title: title.to_owned(),
                x_label: x_label.clone(),
                y_label,
                x_scale: Scale::Linear,
                y_scale: Scale::Linear,
                series,
                reference,
            };
            files.extend(chart.save(folder.join(name))?);
            Ok(())
        };
    chart(
        "fig04_force",
        "Force at the end of the plate (this project's choice)",
        format!("force, {}", UnitLabels::from(units).force()),
        vec![solid("u₁", force(0)), dashed("u₃", force(2))],
        None,
    )?;
    chart(
        "fig05_angular_acceleration_13",
        "Flexible plate: angular acceleration about X₁′ and X₃′",
        format!("angular acceleration, rad/{time}²"),
        vec![solid("α₁", history(alpha, 0)), dashed("α₃", history(alpha, 2))],
        reference("the peak of α₂", alpha, 1),
    )?;
    chart(
        "fig06_angular_velocity_13",
        "Flexible plate: angular velocity about X₁′ and X₃′",
        format!("angular velocity, rad/{time}"),
        vec![solid("ω₁", history(omega, 0)), dashed("ω₃", history(omega, 2))],
        reference("the peak of ω₂", omega, 1),
    )?;
    chart(
        "fig08_angular_acceleration_2",
        "Angular acceleration about X₂′",
        format!("angular acceleration, rad/{time}²"),
        beside_rigid(alpha, &rigid.alpha_body, 1, "flexible plate"),
        None,
    )?;
    chart(
        "fig09_angular_velocity_2",
        "Angular velocity about X₂′",
        format!("angular velocity, rad/{time}"),
        beside_rigid(omega, &rigid.omega_body, 1, "flexible plate"),
        None,
    )?;
    let accelerations = [
        ("fig10_rigid_acceleration_1", "embedded rigid motion", watched("rigid_acceleration"), 0, "X₁"),
        ("fig11_rigid_acceleration_3", "embedded rigid motion", watched("rigid_acceleration"), 2, "X₃"),
        ("fig12_acceleration_1", "flexible plate", watched("acceleration"), 0, "X₁"),
        ("fig13_acceleration_3", "flexible plate", watched("acceleration"), 2, "X₃"),
    ];
    for (name, label, rows, axis, direction) in accelerations {
        chart(
            name,
            &format!("Acceleration of {WATCHED_POINT} in {direction}"),
            format!("acceleration, {acceleration}"),
            beside_rigid(rows, &rigid.acceleration_global, axis, label),
            None,
        )?;
    }

    // Eight lines that hide one another in one chart, by name.
    let names: BTreeSet<_> = results.metadata.bodies.iter().flat_map(|body| &body.point_names).collect();
    let displacements = |name: &String| vectors(&format!("points/{name}/displacement"));
    let sizes = names.iter().flat_map(|name| displacements(name)).map(|d| d.iter().map(|x| x * x).sum::<f64>().sqrt());
    let grid = ChartGrid {
        title: "Displacement in X₂".to_owned(),
        x_label: x_label.clone(),
        y_label: format!("displacement, {length}"),
        series: names.iter().map(|name| solid(name, history(displacements(name), 1))).collect(),
        columns: 2,
        reference: Some(Reference { name: "the largest displacement".to_owned(), value: sizes.fold(0.0, f64::max) }),
    };
    files.extend(grid.save(folder.join("fig07_displacement_2"))?);
    Ok(files)
}
