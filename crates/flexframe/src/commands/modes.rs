//! `flexframe modes`: natural frequencies and mode shapes of a scene's body.

mod carried;
mod mac;
mod scenes;
mod strain_energy;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use model::{BuildError, BuildProgress, Builder, Model, Needs};
use report::{Form, Report, Table, Value};
use scene::{Body, Units};

use crate::plausible;
pub(crate) use carried::Carried;
pub use mac::mac;
pub use scenes::require_surface;
pub(crate) use scenes::{lone_body, require_flexible};
use strain_energy::StrainEnergy;

use crate::report::{BodyReport, MeshReport, Times, size_and_mass};

/// The report of a model: its mesh, its mass and its modes, with the errors of their frequencies that the mesh makes, and the time that
/// these took.
pub(crate) fn report(given: &Body, model: &Model, errors: Option<(&[f64], Duration)>) -> Report {
    let (unit, mesh, body) = (frequency_unit(&given.units.time), MeshReport::new(model), BodyReport::new(model));
    let Units { length, mass, time } = &given.units;
    let mut report = Report::new(&given.title);
    report.put("units", [length, mass, time]);
    report.put("frequency_unit", &unit);
    report.put("mesh", mesh.as_ref().map(Value::of));
    report.put("body", Value::of(&body));
    ["carried", "strain_energy", "mac"].into_iter().for_each(|none| report.put(none, Value::NONE));
    if let Some(mesh) = &mesh {
        report.line("mesh", mesh.to_string());
        mesh.matrices.iter().for_each(|matrices| report.line("K, M", matrices.to_string()));
        mesh.engine.iter().for_each(|engine| report.line("modes", engine.to_string()));
    }
    report.line("body", size_and_mass(mesh.as_ref(), &body, length, mass));
    let mut times = Times::of_model(model);
    errors.into_iter().for_each(|(_, time)| times.add("mesh error", time));
    report.put("times", Value::of(&times));
    report.line("time", times.to_string());
    report.warnings = plausible::doubts(given, model);
    let frequencies = &body.natural_frequencies;
    if frequencies.is_empty() {
        report.line(
            "modes",
            match mesh {
                Some(_) => {
                    "none, as the scene has it: `flexible = 0` in [modes], or `flexibility = false` in [effects]"
                }
                None => "none: a rigid body without a mesh has no natural frequencies",
            },
        );
        return report;
    }
    let residual = (0..frequencies.len()).map(|k| match body.residuals.get(k) {
        Some(residual) => format!("{residual:.0e}"),
        None => body.kinds[k].to_owned(),
    });
    let damped = frequencies.iter().copied().zip(body.damping_ratios.iter().copied());
    let mut table = table_of_modes(None, &unit, damped).all().text_only("residual", Form::Plain, residual);
    if let Some((errors, _)) = errors {
        let error = |k| errors.get(k).map(|error| format!("{:.1e} %", 100.0 * error));
        table = table.text_only("mesh error", Form::Plain, (0..frequencies.len()).map(error));
    }
    report.table(table);
    report
}

/// The table of modes, by their frequencies and damping ratios, at a path.
pub(crate) fn table_of_modes(
    path: Option<&'static str>,
    unit: &str,
    modes: impl ExactSizeIterator<Item = (f64, f64)> + Clone,
) -> Table {
    Table::new("modes", path)
        .text_only("mode", Form::Plain, 1..=modes.len())
        .shown("frequency", format!("frequency, {unit}"), Form::Fixed(6), modes.clone().map(|(frequency, _)| frequency))
        .shown("damping_ratio", "damping", Form::Fixed(4), modes.map(|(_, ratio)| ratio))
}

/// Reduces a scene's body as a run of it asks for, and writes it to a body file; with `matrices`, mass and stiffness are in it,
/// with `stress`, the stress of all nodes, as where the scene asks for stress.
///
/// # Errors
/// [`BuildError`].
pub fn reduce(
    body: &Body,
    builder: &Builder,
    output: &Path,
    matrices: bool,
    stress: bool,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, BuildError> {
    let builder = builder.needing(Needs { stress_field: stress, ..Needs::default() });
    let model = builder.write_body(body, output, matrices, progress)?;
    Ok(report(body, &model, None))
}

/// Finds the modes of a scene's body, and what each carries: rotations of the base are `about` a point in the frame of the mesh, or
/// about the support of a held body and the center of mass of a free one.
///
/// # Errors
/// [`BuildError`].
pub fn modes(
    body: &Body,
    builder: &Builder,
    about: Option<[f64; 3]>,
    progress: impl FnMut(BuildProgress),
) -> Result<(Model, Report), BuildError> {
    let model = builder.needing(Needs::modes()).build(body, progress)?;
    let Some(meshed) = model.meshed.as_ref().filter(|_| model.body.flexible() > 0) else {
        let report = report(body, &model, None);
        return Ok((model, report));
    };
    let start = Instant::now();
    let energy = StrainEnergy::new(meshed)?;
    let errors = energy.as_ref().map(|energy| (&energy.mesh_errors[..], start.elapsed()));
    let mut report = report(body, &model, errors);
    Carried::of_body(&model, about).add_to(&mut report);
    energy.iter().for_each(|energy| energy.add_to(&mut report));
    Ok((model, report))
}

/// Writes the modes that a scene asks for as a problem for SLEPc on a number of ranks. Returns the files.
///
/// # Errors
/// [`BuildError`].
pub fn write_problem(
    body: &Body,
    builder: &Builder,
    folder: &Path,
    ranks: usize,
    progress: impl FnMut(BuildProgress),
) -> Result<Vec<PathBuf>, BuildError> {
    builder.assemble(body, progress)?.variants()?.write_problem(body, folder, ranks)
}

/// "Hz" where time is in seconds.
pub fn frequency_unit(time: &str) -> String {
    if time == "s" { "Hz".to_owned() } else { format!("1/{time}") }
}
