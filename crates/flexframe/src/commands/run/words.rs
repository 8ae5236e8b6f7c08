//! The report of `flexframe run` in words.

use std::f64::consts::{PI, TAU};
use std::fmt;

use super::balances::Balances;
use super::body_report::BodyRunReport;
use super::report::RunReport;
use crate::commands::check::report::CheckReport;
use crate::commands::modes::frequency_unit;
use crate::report::{quantity, rounded, size_and_mass};
use crate::rows::effects;
use crate::rows::units::UnitLabels;

/// Part by which a body may have turned further than the angle to its first attitude, and still have turned one way.
const SAME_TURN: f64 = 0.01;
/// Turn that is rounding.
const ROUNDED_TURN: f64 = 1e-9;

impl fmt::Display for RunReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [length, mass, time] = &self.units;
        let units = UnitLabels { length, mass, time };
        writeln!(f, "{}", self.title)?;
        let is_single = self.bodies.len() == 1;
        for body in &self.bodies {
            if !is_single {
                writeln!(f, "body {}", body.name)?;
            }
            body.write(f, self, is_single)?;
        }
        if is_single {
            self.tied.iter().try_for_each(|tied| write!(f, "{tied}"))?;
        }
        if !is_single {
            writeln!(f, "all {} bodies", self.bodies.len())?;
            self.tied.iter().try_for_each(|tied| write!(f, "{tied}"))?;
            writeln!(f, "  motion   {} steps, {:.0} steps per second", self.steps, self.steps_per_second)?;
            writeln!(f, "  energy   {} {} at the end", quantity(self.system.final_energy), units.energy())?;
        }
        for table in &self.tables {
            writeln!(f, "  table    {table}")?;
        }
        if let Some(check) = &self.check {
            check.write_in_run(f)?;
        }
        if let Some(trust) = &self.trust {
            writeln!(f, "{trust}")?;
        }
        if let Some(accuracy) = &self.accuracy {
            writeln!(f, "{accuracy}")?;
        }
        writeln!(f, "  time     {}", self.times)?;
        write!(f, "  results  {} ({} rows)", self.results.display(), self.rows)?;
        for warning in &self.warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        for warning in self.check.iter().flat_map(CheckReport::instabilities) {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}

impl BodyRunReport {
    /// Method and steps, such as "conservative form, scheme exponential, 5000 steps of 1e-4 s".
    pub(crate) fn steps_in_words(&self, run: &RunReport) -> String {
        let time = &run.units[2];
        let form = match run.formulation.as_str() {
            "paper" => "paper's",
            _ => "conservative",
        };
        let [shortest, longest] = self.step_lengths;
        let lengths = if longest - shortest <= 1e-9 * longest {
            format!("of {longest:.6e} {time}")
        } else {
            format!("from {shortest:.3e} to {longest:.3e} {time}")
        };
        let control = match run.tolerance {
            Some(tolerance) => format!(" ({} rejected, tolerance {tolerance:e})", self.rejected_steps),
            None => String::new(),
        };
        format!("{form} form, scheme {}, {} steps{control} {lengths}", self.scheme, self.steps)
    }

    /// "turned by 0.3 rad"; "turned by 0.3 rad in all, to an attitude 0.1 rad from the first"; "turned by 300 rad (47.7 turns), to an attitude 1.59 rad from the first".
    fn turned_in_words(&self) -> String {
        let Self { turned, turned_from_start: from_start, .. } = *self;
        let turned_by = format!("turned by {} rad", quantity(turned));
        if turned.abs() <= PI {
            if turned.abs() <= (1.0 + SAME_TURN) * from_start + ROUNDED_TURN {
                return turned_by;
            }
            let from_start = quantity(rounded(from_start, 4));
            return format!("{turned_by} in all, to an attitude {from_start} rad from the first");
        }
        let turns = quantity(rounded(turned / TAU, 4));
        let from_start = quantity(rounded(from_start, 4));
        format!("{turned_by} ({turns} turns), to an attitude {from_start} rad from the first")
    }

    /// Writes its lines in the summary of the run.
    fn write(&self, f: &mut fmt::Formatter<'_>, run: &RunReport, is_single: bool) -> fmt::Result {
        let [length, mass, time] = &run.units;
        let units = UnitLabels { length, mass, time };
        if let Some(mesh) = &self.mesh {
            writeln!(f, "  mesh     {mesh}")?;
            if let Some(matrices) = &mesh.matrices {
                writeln!(f, "  K, M     {matrices}")?;
            }
        }
        write!(f, "  body     {}, ", size_and_mass(self.mesh.as_ref(), &self.body, length, mass))?;
        writeln!(f, "{}", self.body.modes_in_words(&frequency_unit(time)))?;
        if !self.effects.is_empty() {
            writeln!(f, "  effects  {}", effects::in_words(&self.effects))?;
        }
        if !self.large_modes.is_empty() {
            let modes: Vec<String> = self.large_modes.iter().map(ToString::to_string).collect();
            let s = if modes.len() == 1 { "" } else { "s" };
            let answer = match self.static_answer {
                Some(k) => format!(" ({k} is the static answer to the moments beside the others)"),
                None => String::new(),
            };
            let chosen = run.large_choice.as_ref().filter(|_| run.large_is_chosen);
            let chosen = chosen.map_or_else(String::new, |choice| format!(", {}", choice.reason()));
            writeln!(f, "  large    mode{s} {}{answer}{chosen}", modes.join(", "))?;
        }
        write!(f, "  motion   {}", self.steps_in_words(run))?;
        match is_single {
            true => writeln!(f, ", {:.0} steps per second", run.steps_per_second)?,
            false => writeln!(f)?,
        }
        let [x, y, z] = self.moved.map(quantity);
        writeln!(f, "  end      {}, centre of mass moved by ({x}, {y}, {z}) {length}", self.turned_in_words())?;
        writeln!(
            f,
            "  energy   {} {unit} at the end, largest strain energy {} {unit}",
            quantity(self.final_energy),
            quantity(self.peak_strain_energy),
            unit = units.energy()
        )?;
        if let Some(stress) = &self.peak_stress {
            writeln!(f, "  stress   {}", stress.in_words(&units))?;
        }
        let Balances { energy, linear_momentum, angular_momentum } = self.balances;
        let closed = if self.right_unsummed {
            format!("summed to {energy:.1e} only, by modes faster than the steps (the motion itself is right)")
        } else {
            format!("closed to {energy:.1e}")
        };
        writeln!(
            f,
            "  balance  energy {closed}, linear momentum to {linear_momentum:.1e}, angular momentum to \
             {angular_momentum:.1e}"
        )?;
        Ok(())
    }
}
