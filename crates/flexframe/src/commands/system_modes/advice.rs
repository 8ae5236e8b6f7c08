//! `flexframe advise` of bodies that joints tie together: what their vibrations say, in sentences.

use ::report::{Report, Value};
use dynamics::SteadyError;
use scene::Units;

use super::report::{SystemModeReport, SystemModesReport};
use super::stiffening::StiffenedBody;
use crate::report::quantity;

/// Part of the elastic energy of a mode below which a body is as good as rigid in it.
const RIGID: f64 = 0.01;

/// Advice on bodies that are tied together, by their vibrations; `flexible` are the names of its bodies that have modes, `stiffening` is
/// the effect of the forces of the start on each of these.
pub(super) fn advice(
    modes: &SystemModesReport,
    flexible: &[String],
    stiffening: Result<Vec<StiffenedBody>, SteadyError>,
    units: &Units,
) -> Report {
    let mut sentences = by_vibrations(modes, flexible);
    match &stiffening {
        Ok(found) => {
            let sentence = |body: &StiffenedBody| body.sentence(units.into(), &modes.frequency_unit);
            sentences.extend(found.iter().map(sentence));
        }
        Err(error) => sentences.push(format!("what the forces of the start do to stiffness is not known: {error}")),
    }
    let mut report = Report::default();
    report.put("bodies", &modes.bodies[..]);
    report.put("sentences", &sentences[..]);
    report.put("stiffening", stiffening.ok().as_ref().map(Value::of));
    report.words(format!("system of {}", modes.bodies.join(", ")));
    sentences.iter().for_each(|sentence| report.words(format!("  {sentence}")));
    report
}

fn by_vibrations(report: &SystemModesReport, flexible: &[String]) -> Vec<String> {
    let mut sentences = Vec::new();
    let unit = &report.frequency_unit;
    for body in flexible {
        let strained = |mode: &&SystemModeReport| {
            mode.frequency > 0.0 && mode.strained.iter().any(|share| share.name == *body && share.part >= RIGID)
        };
        sentences.push(match report.modes.iter().find(strained) {
                Some(mode) => format!(
                    "{body} bends in motions of {} {unit} and faster: where loads, drives and what is asked for are well below that, it may be \
                     rigid (`flexible = 0` in its [modes])",
                    quantity(mode.frequency)
                ),
                None => format!("{body} has no part in any vibration of the system: it may be rigid (`flexible = 0` in its [modes])"),
            });
    }
    if let Some(slowest) = report.modes.iter().find(|mode| mode.frequency > 0.0) {
        let who = slowest.strained.first().map_or("forces of loads and joints alone", |share| share.name.as_str());
        sentences.push(format!(
            "the slowest vibration has {} {unit}; what holds it most is {who}",
            quantity(slowest.frequency)
        ));
    }
    match report.rigid_modes {
        0 => {}
        count => sentences.push(format!(
            "nothing resists {count} motion{}: loads and drives move the system along them as if it were rigid",
            if count == 1 { "" } else { "s" }
        )),
    }
    for (joint, rows) in &report.redundant {
        sentences.push(format!(
                "{rows} of the rows of joint {joint} are implied by others where bodies are rigid: its reactions are those of flexible \
                 bodies only, and not determined by rigid ones"
            ));
    }
    sentences.extend(report.warnings.iter().cloned());
    sentences
}
