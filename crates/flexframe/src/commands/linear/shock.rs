//! `flexframe shock`: the largest answers of a scene to a shock of its base or of a load, summed over its modes, Eqs. (R4) to (R7), (R8) and (R9) of
//! `docs/method/shock.md`.

mod peaks;

use std::path::Path;

use diagnostic::{Diagnostic, Failure, Kind};
use model::{BuildProgress, Builder};
use report::{Form, Report, Table, Value};
use scene::{Interpolation, Scene};
use shock::{Following, ShockError};

use crate::commands::linear::linearize::{LinearSettings, linear_model};
use crate::commands::linear::srs::table;
use crate::commands::modes::frequency_unit;
use peaks::{ModePeaks, ShockOutput};

/// Most modes in the summary.
const SHOWN: usize = 12;
/// Damping between modes above this part of their own is told.
const COUPLED: f64 = 0.02;

/// Sums the peaks of the modes of a scene where its input in the settings, which is one, follows the CSV file.
///
/// # Errors
/// [`Failure`].
pub fn shock(
    scene: &Scene,
    builder: &Builder,
    (table, interpolation): (&Path, Interpolation),
    settings: &LinearSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let motion = table::read(table, interpolation)?;
    let model = linear_model(scene, builder, settings, progress)?;
    let inputs: Vec<String> = model.equations.inputs.iter().map(|input| input.name.clone()).collect();
    let [input] = &inputs[..] else {
        let wrong = Kind::Usage.of(&scene.path).found(format!("the inputs {}", inputs.join(", ")));
        let help = "name it whole, such as --input base.acceleration.z";
        return Err(wrong.expected("one, which follows the table").help(help).into());
    };
    let modes = model.equations.real_modes().map_err(|source| source.in_file(&scene.path))?;
    // The model gives frequencies and damping: no argument of the command is at fault.
    let failed = |source: ShockError| Kind::Input.of(table).says(source.to_string());
    let peaks = ModePeaks::new(&model.equations, &modes, &motion).map_err(failed)?;
    let mut warnings = model.state.warnings.clone();
    if modes.coupling > COUPLED {
        let part = 100.0 * modes.coupling;
        warnings.push(format!(
            "the damping couples modes by up to {part:.1} % of their own; each mode is taken with its own damping alone: compare with a run"
        ));
    }
    let outputs = peaks.outputs(&model.equations, motion.peak()).map_err(failed)?;
    if outputs.is_empty() {
        let help = "ask for displacements, accelerations, coordinates of joints or stresses, or for reactions of joints where nothing is damped";
        let none = "velocities and rates alone, of which a shock has no sums";
        return Err(Kind::Usage.of(&scene.path).found(none).expected("an output with a sum").help(help).into());
    }
    let mixed = peaks::mixed(&model.equations);
    if !mixed.is_empty() {
        warnings.push(format!(
            "left out are {}: with damping they go with velocities, too, of which a shock has no sums; take a run with the table as the \
             history of the load, or no damping",
            mixed.join(", ")
        ));
    }

    let unit = frequency_unit(&scene.units.time);
    let [duration, peak] = [motion.duration(), motion.peak()];
    let mut report = Report::new(&scene.title);
    let between = interpolation.words();
    report.line("shock", format!("{input} for {duration:.6}, at most {peak:.6e}, {between} between rows of the table"));
    report.put("frequency_unit", &unit);
    report.put("input", input);
    report.put("interpolation", Value::of(&interpolation));
    report.put("duration", duration);
    report.put("peak", peak);
    let count = peaks.frequencies.len();
    let following = |value: fn(&Following) -> f64| peaks.following.iter().map(value);
    report.table(
        Table::new("modes", "modes")
            .most(SHOWN)
            .text_only("mode", Form::Plain, 1..=count)
            .shown("frequency", unit, Form::Fixed(6), peaks.frequencies.iter().copied())
            .shown("damping_ratio", "damping", Form::Fixed(4), peaks.damping_ratios.iter().copied())
            .shown("factor", "factor", Form::Power(4), peaks.factors.iter().copied())
            .shown("displacement", "displacement", Form::Power(4), following(|of| of.peaks.displacement))
            .shown("acceleration", "acceleration", Form::Power(4), following(|of| of.peaks.acceleration()))
            .shown("follows", "follows", Form::Fixed(4), following(|of| of.correlation)),
    );
    let by = |of: &ShockOutput| of.largest_mode.map_or_else(|| "rigid".to_owned(), |mode| format!("mode {mode}"));
    report.table(
        Table::new("outputs", "outputs")
            .titled("largest values")
            .all()
            .shown("output", "output", Form::Plain, outputs.iter().map(|of| &of.output))
            .shown("absolute", "absolute", Form::Power(4), outputs.iter().map(|of| of.absolute))
            .shown("srss", "SRSS", Form::Power(4), outputs.iter().map(|of| of.srss))
            .shown("cqc", "CQC", Form::Power(4), outputs.iter().map(|of| of.cqc))
            .shown("unit", "", Form::Plain, outputs.iter().map(|of| &of.unit))
            .column("rigid", outputs.iter().map(|of| of.rigid))
            .column("largest_mode", outputs.iter().map(|of| of.largest_mode))
            .text_only("most by", Form::Plain, outputs.iter().map(by)),
    );
    report.warnings = warnings;
    Ok(report)
}
