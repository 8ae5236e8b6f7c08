//! `flexframe advise` of bodies that joints tie together: what their vibrations say, in sentences.

use std::fmt;

use dynamics::SteadyError;
use scene::Units;
use serde::Serialize;

use super::report::{SystemModeReport, SystemModesReport};
use super::stiffening::StiffenedBody;
use crate::report::quantity;

/// Part of the elastic energy of a mode below which a body is as good as rigid in it.
const RIGID: f64 = 0.01;

/// Advice on bodies that are tied together.
#[derive(Debug, Clone, Serialize)]
pub struct SystemAdvice {
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Sentences about them.
    pub sentences: Vec<String>,
    /// The flexible bodies in the motion that they start with; `None` where their forces find no rest.
    pub stiffening: Option<Vec<StiffenedBody>>,
}

/// Reports on each body of a scene, and advice on its systems.
#[derive(Debug, Serialize)]
pub struct AdviceOnSystems<R: Serialize> {
    /// Advice on each body, with its name.
    #[serde(serialize_with = "crate::report::list_of_named")]
    pub bodies: Vec<(Option<String>, R)>,
    /// Advice on bodies that are tied together.
    pub systems: Vec<SystemAdvice>,
}

impl<R: Serialize + fmt::Display> fmt::Display for AdviceOnSystems<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, report) in &self.bodies {
            writeln!(f, "body {}\n{report}\n", name.as_deref().unwrap_or("body"))?;
        }
        for (i, system) in self.systems.iter().enumerate() {
            if i > 0 {
                f.write_str("\n\n")?;
            }
            write!(f, "{system}")?;
        }
        Ok(())
    }
}

impl SystemAdvice {
    /// By the vibrations of a system; `flexible` are the names of its bodies that have modes.
    pub fn new(report: &SystemModesReport, flexible: &[String]) -> Self {
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
        Self { bodies: report.bodies.clone(), sentences, stiffening: None }
    }

    /// The same with what the forces of the start do to each body.
    pub(super) fn with_stiffening(
        mut self,
        found: Result<Vec<StiffenedBody>, SteadyError>,
        units: &Units,
        frequency_unit: &str,
    ) -> Self {
        match found {
            Ok(found) => {
                let sentence = |body: &StiffenedBody| body.sentence(units.into(), frequency_unit);
                self.sentences.extend(found.iter().map(sentence));
                self.stiffening = Some(found);
            }
            Err(error) => {
                self.sentences.push(format!("what the forces of the start do to stiffness is not known: {error}"))
            }
        }
        self
    }
}

impl fmt::Display for SystemAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "system of {}", self.bodies.join(", "))?;
        self.sentences.iter().try_for_each(|sentence| write!(f, "\n  {sentence}"))
    }
}
