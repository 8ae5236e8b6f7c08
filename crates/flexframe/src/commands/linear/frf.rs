//! `flexframe frf`: frequency responses of a scene about rest or a steady spin, as a table and as charts.

use std::f64::consts::TAU;

use diagnostic::{Diagnostic, Failure};
use faer::c64;
use linear::{Damping, FrequencyResponse, SecondOrder};
use model::{BuildProgress, Builder};
use report::{Chart, Curve, Curves, File, Form, Report, Table, Value};
use scene::Scene;

use crate::commands::linear::frequencies::Frequencies;
use crate::commands::linear::linearize::{AtOnce, LinearSettings, linear_model};
use crate::commands::modes::frequency_unit;

/// The files of [`frf`]: `frf.csv`, the page `frf.html`, and `frf` as SVG, PDF and PNG.
pub const FILES: [File; 3] = [File::Table("frf"), File::Page("frf"), File::Chart("frf")];
/// The most frequencies.
const MAX_FREQUENCIES: usize = 1_000_000;

/// Settings of frequency responses.
#[derive(Debug, Clone, PartialEq)]
pub struct FrfSettings {
    /// The state that the equations are about.
    pub linear: LinearSettings,
    /// The frequencies.
    pub frequencies: Frequencies,
    /// True where frequencies are spaced by equal ratios.
    pub logarithmic: bool,
    /// Loss factor of structural damping in the place of the scene's damping.
    pub loss_factor: Option<f64>,
}

/// The response of an output to an input.
struct Response<'a> {
    output: &'a str,
    /// Unit of the output by the unit of the input.
    unit: String,
    input: &'a str,
    magnitude: Vec<f64>,
    /// Degrees.
    phase: Vec<f64>,
    /// The place of the highest magnitude.
    highest: usize,
}

/// Computes the responses of a scene.
///
/// # Errors
/// [`Failure`].
pub fn frf(
    scene: &Scene,
    builder: &Builder,
    settings: &FrfSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let frequencies = match settings.logarithmic {
        true => settings.frequencies.by_ratios(MAX_FREQUENCIES),
        false => settings.frequencies.evenly(MAX_FREQUENCIES),
    }?;
    let mut model = linear_model(scene, builder, &settings.linear, progress)?;
    if let Some(loss_factor) = settings.loss_factor {
        model.state.damping = structural(loss_factor);
    }
    let equations = &model.equations;
    let response = equations.frequency_response(&frequencies, damping_of(settings.loss_factor));
    let response = response.map_err(|source| source.in_file(&scene.path))?;
    let responses = responses(equations, &response);
    // The figure alone names them: where they are not found, the responses stand without.
    let resonances =
        equations.poles(damping_of(settings.loss_factor)).map(|poles| resonances(&poles)).unwrap_or_default();
    let unit = frequency_unit(&scene.units.time);

    let mut report = Report::new(&scene.title);
    report.put("frequency_unit", &unit);
    report.say("about", "about", model.state.to_string());
    let highest = responses.iter().map(|of| of.magnitude[of.highest]);
    // An output that does not answer has no frequency.
    let at = responses.iter().map(|of| Some(frequencies[of.highest]).filter(|_| of.magnitude[of.highest] > 0.0));
    report.table(
        Table::new("peaks", "peaks")
            .titled("highest responses")
            .all()
            .shown("output", "output", Form::Plain, responses.iter().map(|of| of.output))
            .shown("input", "by", Form::Plain, responses.iter().map(|of| of.input))
            .shown("magnitude", "magnitude", Form::Power(6), highest)
            .shown("unit", "", Form::Plain, responses.iter().map(|of| &of.unit))
            .shown("frequency", format!("at, {unit}"), Form::Fixed(6), at),
    );
    let at_once = AtOnce::of_equations(equations);
    report.put("at_once", at_once.as_ref().map(Value::of));
    at_once.iter().filter_map(AtOnce::in_words).for_each(|words| report.line("D", words));
    report.warnings = model.state.warnings;

    let mut table = Table::new("frf", None).column("frequency", frequencies.iter().copied());
    for Response { output, input, magnitude, phase, .. } in &responses {
        table = table.column(format!("|{output}/{input}|"), magnitude.iter().copied());
        table = table.column(format!("phase {output}/{input}"), phase.iter().copied());
    }
    report.csv_tables.push(table);
    let curve = |of: Response| Curve {
        name: format!("{} / {}", of.output, of.input),
        about: vec![format!("{:.4e} at {:.6} {unit}", of.magnitude[of.highest], frequencies[of.highest])],
        units: vec![of.unit, "°".to_owned()],
        values: vec![of.magnitude, of.phase],
    };
    report.curves = Some(Curves {
        subject: "frequency response",
        curves: responses.into_iter().map(curve).collect(),
        frequency_unit: unit.clone(),
        logarithmic: settings.logarithmic,
        charts: vec![Chart::new("Magnitude", true), Chart::new("Phase", false)],
        headings: vec!["Highest"],
        resonances,
        frequencies,
    });
    Ok(report)
}

/// Natural frequencies of poles that swing, rising, cycles per time.
pub(super) fn resonances(poles: &[c64]) -> Vec<f64> {
    let swinging = poles.iter().filter(|pole| pole.im > -pole.re);
    let mut frequencies: Vec<f64> = swinging.map(|pole| pole.norm() / TAU).collect();
    frequencies.sort_by(f64::total_cmp);
    frequencies
}

/// The response of each output to each input, input by input.
fn responses<'a>(equations: &'a SecondOrder, response: &FrequencyResponse) -> Vec<Response<'a>> {
    let places = (0..equations.inputs.len()).flat_map(|j| (0..equations.outputs.len()).map(move |i| (i, j)));
    let of = |(i, j): (usize, usize)| {
        let (output, input) = (&equations.outputs[i].channel, &equations.inputs[j]);
        let magnitude: Vec<f64> = response.values.iter().map(|h| h[(i, j)].norm()).collect();
        let highest = (0..magnitude.len()).fold(0, |best, k| if magnitude[k] > magnitude[best] { k } else { best });
        Response {
            output: &output.name,
            unit: format!("{} per {}", output.unit, input.unit),
            input: &input.name,
            phase: response.values.iter().map(|h| h[(i, j)].im.atan2(h[(i, j)].re).to_degrees()).collect(),
            magnitude,
            highest,
        }
    };
    places.map(of).collect()
}

/// Structural damping in words, in the place of the scene's.
pub(super) fn structural(loss_factor: f64) -> String {
    format!("structural damping, loss factor {loss_factor}")
}

/// The damping of the equations, or structural damping with a loss factor.
pub(super) fn damping_of(loss_factor: Option<f64>) -> Damping {
    loss_factor.map_or(Damping::OfEquations, Damping::Structural)
}
