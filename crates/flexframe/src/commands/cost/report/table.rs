//! The price list for people.

use std::fmt;

use super::CostReport;
use crate::commands::cost::body::CostBody;
use crate::commands::cost::ladder::{LadderRun, Line, Outcome};
use crate::commands::cost::modes::modes_warning;
use crate::commands::cost::short::{duration, setting};
use crate::commands::modes::frequency_unit;

/// The answer to the target, or, without one, the whole list.
impl fmt::Display for CostReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.answer {
            Some(answer) => writeln!(f, "{answer}")?,
            None => self.write_list(f)?,
        }
        write!(f, "\n  wrote     ")?;
        self.files.iter().try_for_each(|file| write!(f, " {}", file.display()))
    }
}

impl CostReport {
    fn write_list(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = &self.time_unit;
        writeln!(f, "{}", self.title)?;
        let in_words = |body: &CostBody| {
            let to = |highest| format!(" to {highest:.2} {}", frequency_unit(time));
            let to = body.highest_frequency.map_or_else(String::new, to);
            (format!("{} flexible modes{to}", body.flexible), format!("{} points", body.points))
        };
        match &self.bodies[..] {
            [body] => {
                let (modes, points) = in_words(body);
                writeln!(f, "  scene      {modes}, {} {time}, {points}", self.end)?;
            }
            several => {
                writeln!(f, "  scene      {} bodies, {} {time}", several.len(), self.end)?;
                for body in several {
                    let (modes, points) = in_words(body);
                    writeln!(f, "  {:<10} {modes}, {points}", body.name)?;
                }
            }
        }
        writeln!(f, "  machine    {}", self.machine)?;
        let reference = &self.reference;
        let parts: Vec<String> =
            reference.own_error.named().map(|(name, error)| format!("{name} {error:.1e}")).collect();
        writeln!(
            f,
            "  reference  conservative, exponential, {} steps of {:.3e} {time}; its own error: {}",
            reference.steps,
            reference.step,
            parts.join(", ")
        )?;
        if let Some(errors) = self.paper_limit.as_ref().and_then(|limit| limit.errors) {
            writeln!(
                f,
                "  paper      however short its steps, the paper's formulation stays {:.1e} from the reference",
                errors.largest()
            )?;
        }
        if let Some(why) = &self.paper_limit_failure {
            writeln!(f, "  paper      no limit for short steps, {why}")?;
        }
        writeln!(
            f,
            "\n     {:<17} {:>9}  {:>9} {:>9} {:>9} {:>9} {:>9}  {:>9} {:>9}  {:>8} {:>9}  {:>10} {:>6}",
            "",
            "error",
            "attitude",
            "modal",
            "displac.",
            "velocity",
            "accel.",
            "energy",
            "ang.mom.",
            "steps",
            "evals",
            "time",
            "spread"
        )?;
        for line in &self.lines {
            writeln!(f, "  {}", heading(line))?;
            for row in &line.rows {
                writeln!(f, "{}", RowText(row))?;
            }
        }
        writeln!(
            f,
            "  * nothing tried is both closer and faster    < the scene's own setting    ≤ the reference cannot tell\n  \
             error: largest of attitude (rad), modal coordinates, displacement, velocity and acceleration of the points \
             (of their peaks)"
        )?;
        self.bodies.iter().try_for_each(|body| self.write_modes(f, body))
    }

    fn write_modes(&self, f: &mut fmt::Formatter<'_>, body: &CostBody) -> fmt::Result {
        let of = if self.bodies.len() == 1 { String::new() } else { format!(" of body {}", body.name) };
        if let Some(why) = &body.modes_failure {
            return writeln!(f, "\n  Numbers of modes{of} are not compared: {why}");
        }
        let (Some(first), Some(most)) = (body.modes.first(), body.modes.last()) else { return Ok(()) };
        if !of.is_empty() {
            write!(f, "\n  body {}", body.name)?;
        }
        writeln!(
            f,
            "\n  modes   to, {:<6} {:>9}  {:>9} {:>9} {:>9} {:>9} {:>9}  {:>9}",
            frequency_unit(&self.time_unit),
            "error",
            "attitude",
            "modal",
            "displac.",
            "velocity",
            "accel.",
            "time/step"
        )?;
        for row in &body.modes {
            write!(f, "  {:>5}  {:>9.2}  ", row.flexible, row.highest_frequency)?;
            match row.errors {
                Some(e) => write!(
                    f,
                    "{:>9.1e}  {:>9.1e} {} {} {} {}",
                    e.largest(),
                    e.attitude,
                    optional(e.modal),
                    optional(e.displacement),
                    optional(e.velocity),
                    optional(e.acceleration)
                )?,
                None => write!(f, "{:>60}", "what the others are compared with")?,
            }
            writeln!(f, "  {:>6.2} µs", 1e6 * row.seconds_per_step)?;
        }
        writeln!(
            f,
            "  the same motion with {} to {} modes; the steps leave an error of {:.0e}",
            first.flexible, most.flexible, most.step_error
        )?;
        match modes_warning(&body.modes, body.flexible, 0.0) {
            Some(words) => writeln!(f, "  {words}"),
            None => Ok(()),
        }
    }
}

fn heading(line: &Line) -> String {
    let form = if line.scheme == "paper" { "" } else { &format!("{} formulation, ", line.formulation) };
    let control = if line.controlled { ", step control" } else { "" };
    let measured = line.measured_order.map_or_else(String::new, |order| format!(", measured {order:.2}"));
    format!("{form}scheme {}{control}: order {}{measured}", line.scheme, line.order)
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| format!("{:>9}", "-"), |value| format!("{value:>9.1e}"))
}

struct RowText<'a>(&'a LadderRun);

impl fmt::Display for RowText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(row) = self;
        let mark = |set: bool, sign: char| if set { sign } else { ' ' };
        write!(f, "  {}{} {:<17}", mark(row.on_front, '*'), mark(row.of_scene, '<'), setting(row.setting))?;
        match &row.outcome {
            Outcome::Ran(m) => {
                let error = format!("{}{:.1e}", if m.at_reference { "≤" } else { "" }, m.error);
                let e = &m.errors;
                write!(
                    f,
                    " {error:>9}  {:>9.1e} {} {} {} {}  {:>9.1e} {:>9.1e}  {:>8} {:>9}  {:>10} {:>6.2}",
                    e.attitude,
                    optional(e.modal),
                    optional(e.displacement),
                    optional(e.velocity),
                    optional(e.acceleration),
                    m.energy,
                    m.angular_momentum,
                    m.steps,
                    m.evaluations,
                    duration(m.seconds),
                    m.spread
                )
            }
            Outcome::Failed(failure) => write!(f, " failed: {failure}"),
            Outcome::OutOfPatience(stopped) => write!(f, " {stopped}"),
        }
    }
}
