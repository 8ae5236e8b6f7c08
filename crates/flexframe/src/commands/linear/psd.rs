//! `flexframe psd`: the response of a scene to stationary random inputs, Eqs. (F6) to (F8) of `docs/method/linear.md`.

mod responses;

use std::path::Path;

use diagnostic::{Diagnostic, Failure};
use linear::{LinearError, Quadrature};
use model::{BuildProgress, Builder};
use report::{Chart, Curve, Curves, File, Form, Report, Table};
use scene::Scene;

use crate::commands::linear::frf::{damping_of, resonances, structural};
use crate::commands::linear::linearize::{LinearModel, LinearSettings, linear_model};
use crate::commands::linear::spectra::Spectra;
use crate::commands::modes::frequency_unit;
use responses::Responses;

/// The files of [`psd`]: `psd.csv`, the page `psd.html`, and `psd` as SVG, PDF and PNG.
pub const FILES: [File; 3] = [File::Table("psd"), File::Page("psd"), File::Chart("psd")];
/// Levels, in root mean squares, whose crossings are counted.
const LEVELS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

/// Settings of random responses.
#[derive(Debug, Clone, PartialEq)]
pub struct PsdSettings {
    /// The state that the equations are about, and the outputs. Inputs are those of the table.
    pub linear: LinearSettings,
    /// Lowest and highest frequency, cycles per time; those of the table where there are none.
    pub band: Option<[f64; 2]>,
    /// Loss factor of structural damping in the place of the scene's damping.
    pub loss_factor: Option<f64>,
}

/// Computes the response of a scene to the random inputs in a CSV file.
///
/// # Errors
/// [`Failure`].
pub fn psd(
    scene: &Scene,
    builder: &Builder,
    table: &Path,
    settings: &PsdSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let spectra = Spectra::read(table)?;
    let band = spectra.band(settings.band)?;
    let asked = LinearSettings { inputs: spectra.inputs(), ..settings.linear.clone() };
    let mut model = linear_model(scene, builder, &asked, progress)?;
    if let Some(loss_factor) = settings.loss_factor {
        model.state.damping = structural(loss_factor);
    }
    let failed = |source: LinearError| source.in_file(&scene.path);
    let damping = damping_of(settings.loss_factor);
    let poles = model.equations.poles(damping).map_err(failed)?;
    let rule = Quadrature::of_poles(band, &spectra.frequencies(), &poles).map_err(failed)?;
    let names: Vec<&str> = model.equations.inputs.iter().map(|input| &input.name[..]).collect();
    let input = spectra.at(&names, &rule.frequencies)?;
    let response = model.equations.frequency_response(&rule.frequencies, damping).map_err(failed)?;
    let responses = Responses::new(&model.equations, &response, &input, &rule.weights).map_err(failed)?;
    Ok(report_of(scene, &model, band, (&responses, &rule.weights), resonances(&poles)))
}

fn report_of(
    scene: &Scene,
    model: &LinearModel,
    [low, high]: [f64; 2],
    (responses, weights): (&Responses, &[f64]),
    resonances: Vec<f64>,
) -> Report {
    let unit = frequency_unit(&scene.units.time);
    let inputs: Vec<&str> = model.equations.inputs.iter().map(|input| &input.name[..]).collect();
    let count = responses.frequencies.len();
    let mut report = Report::new(&scene.title);
    report.put("frequency_unit", &unit);
    report.say("about", "about", model.state.to_string());
    report.line("inputs", inputs.join(", "));
    report.put("inputs", inputs);
    report.line("band", format!("{low} to {high} {unit}, {count} frequencies"));
    report.put("band", [low, high]);
    report.put("frequencies", count);
    let outputs = || responses.outputs.iter();
    let signals =
        || outputs().enumerate().map(|(k, (_, response))| (k < responses.first_von_mises).then_some(response));
    let crossings = || signals().map(|of| of.map(|of| LEVELS.map(|level| of.crossings(level * of.rms))));
    let told = |level: usize| {
        crossings().zip(outputs()).map(move |(all, (_, of))| all.map(|all| all[level]).filter(|_| of.rms > 0.0))
    };
    report.table(
        Table::new("outputs", "outputs")
            .titled("root mean squares")
            .all()
            .shown("output", "output", Form::Plain, outputs().map(|(channel, _)| &channel.name))
            .shown("rms", "rms", Form::Power(6), outputs().map(|(_, of)| of.rms))
            .shown("unit", "", Form::Plain, outputs().map(|(channel, _)| &channel.unit))
            .column("rate_rms", signals().map(|of| of.map(|of| of.rate_rms)))
            .column("crossings", crossings())
            .text_only(format!("apparent, {unit}"), Form::Fixed(6), told(0))
            .text_only(format!("above 3 rms, {unit}"), Form::Power(3), told(3)),
    );
    report.warnings.clone_from(&model.state.warnings);

    // unit² per cycle per time.
    let mut table = Table::new("psd", None).column("frequency", responses.frequencies.iter().copied());
    for (channel, of) in outputs() {
        table = table.column(&channel.name, of.density.iter().copied());
    }
    report.csv_tables.push(table);
    let curve = |(channel, of): &(linear::Channel, linear::RandomResponse)| {
        let mut square = 0.0;
        let cumulated = of.density.iter().zip(weights).map(|(density, weight)| {
            square += density * weight;
            f64::sqrt(square)
        });
        Curve {
            name: channel.name.clone(),
            units: vec![format!("({})²/{unit}", channel.unit), channel.unit.clone()],
            values: vec![of.density.clone(), cumulated.collect()],
            about: vec![format!("{:.4e} {}", of.rms, channel.unit)],
        }
    };
    report.curves = Some(Curves {
        subject: "random response",
        curves: outputs().map(curve).collect(),
        frequency_unit: unit.clone(),
        logarithmic: true,
        frequencies: responses.frequencies.clone(),
        charts: vec![Chart::new("Power spectral density", true), Chart::new("Cumulated rms", false)],
        headings: vec!["rms"],
        resonances,
    });
    report
}
