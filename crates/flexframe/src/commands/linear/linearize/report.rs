//! Report of `flexframe linearize`.

use std::f64::consts::TAU;
use std::path::Path;

use faer::c64;
use linear::{Channel, StateSpace};
use report::{Form, Report, Table, Value};
use scene::Shared;

use super::at_once::AtOnce;
use super::space::LinearSpace;
use crate::commands::modes::frequency_unit;
use crate::report::counted;

/// Poles that are shown.
const POLES: usize = 20;

/// The report of a state space with its poles, which is written to a file.
pub(super) fn report(scene: &Shared, space: &LinearSpace, poles: &[c64], file: &Path) -> Report {
    let LinearSpace { whole, state, .. } = space;
    let (written, balanced) = (space.model(), space.balanced());
    let unit = frequency_unit(&scene.units.time);
    let names = |list: &[Channel]| list.iter().map(|channel| channel.name.clone()).collect::<Vec<String>>();
    let [inputs, outputs] = [&written.inputs, &written.outputs].map(|list| names(list));
    let [size, whole] = [written.states.len(), whole.states.len()];
    let mut report = Report::new(&scene.title);
    report.put("frequency_unit", &unit);
    report.put("time", state.time);
    report.put("omega_global", state.omega_global);
    report.say("about", "about", state.to_string());
    let counts = [
        counted(size, ["state", "states"]),
        counted(inputs.len(), ["input", "inputs"]),
        counted(outputs.len(), ["output", "outputs"]),
    ];
    let reduced = match balanced {
        Some((bound, _)) => format!("; of {whole} states, no response wrong by more than {bound:.3e}"),
        None if size < whole => format!("; of {whole} states, exact at frequency 0"),
        None => String::new(),
    };
    report.line("model", format!("{}{reduced}", counts.join(", ")));
    report.put("states", size);
    report.put("whole", whole);
    report.put("error_bound", balanced.map(|(bound, _)| *bound));
    report.put("hankel_values", balanced.map_or_else(Vec::new, |(_, values)| values.clone()));
    report.line("inputs", inputs.join(", "));
    report.put("inputs", inputs);
    report.line("outputs", outputs.join(", "));
    report.put("outputs", outputs);
    let at_once = AtOnce::of(written);
    report.put("at_once", at_once.as_ref().map(Value::of));
    at_once.iter().filter_map(AtOnce::in_words).for_each(|words| report.line("D", words));
    report.say("file", "file", file.display().to_string());
    // One of each conjugate pair, slowest first.
    let poles: Vec<&c64> = poles.iter().filter(|pole| pole.im >= 0.0).collect();
    let ratio = |pole: &&c64| if pole.norm() > 0.0 { -pole.re / pole.norm() } else { 0.0 };
    report.table(
        Table::new("poles", "poles")
            .most(POLES)
            .shown("frequency", format!("poles, {unit}"), Form::Fixed(6), poles.iter().map(|pole| pole.im / TAU))
            .shown("damping_ratio", "damping", Form::Power(4), poles.iter().map(ratio))
            .shown("growth", "growth", Form::Power(4), poles.iter().map(|pole| pole.re))
            .column("shape", poles.iter().map(|pole| shape(written, **pole))),
    );
    report.warnings.clone_from(&state.warnings);
    report
}

/// The outputs in the complex mode of a pole, in the scale of the largest of one unit.
fn shape(model: &StateSpace, pole: c64) -> Vec<[f64; 2]> {
    let outputs = model.complex_mode(pole);
    let unit = model.outputs.first().map(|channel| &channel.unit);
    let of_unit = outputs.iter().zip(&model.outputs).filter(|(_, channel)| Some(&channel.unit) == unit);
    let largest = of_unit.map(|(output, _)| *output).max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let scale = largest.filter(|largest| largest.norm() > 0.0).unwrap_or(c64::ONE);
    outputs.into_iter().map(|output| output / scale).map(|output| [output.re, output.im]).collect()
}
