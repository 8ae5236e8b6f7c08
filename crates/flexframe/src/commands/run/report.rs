//! Report of `flexframe run`.

use std::f64::consts::{PI, TAU};
use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

use super::balances::Balances;
use super::estimate::Estimate;
use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::report::{BodyReport, MeshReport, Times, quantity, size_and_mass};
use crate::rows::effects;
use crate::rows::peak_stress::PeakStress;
use crate::rows::units::UnitLabels;

/// Report of `flexframe run`.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
    /// Title of the scene.
    pub title: String,
    /// Labels of length, mass and time.
    pub units: [String; 3],
    /// The results file.
    #[serde(serialize_with = "json::path")]
    pub results: PathBuf,
    /// Rows in it.
    pub rows: u64,
    /// The estimate before it.
    pub estimate: Estimate,
    /// Formulation.
    pub formulation: String,
    /// Scheme.
    pub scheme: String,
    /// Tolerance, under step control.
    pub tolerance: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Steps that step control tried in vain.
    pub rejected_steps: u64,
    /// Lengths of the shortest and the longest step.
    #[serde(serialize_with = "json::numbers")]
    pub step_lengths: [f64; 2],
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Steps per second of computing, writing included.
    #[serde(serialize_with = "json::number")]
    pub steps_per_second: f64,
    /// The finite-element model.
    pub mesh: Option<MeshReport>,
    /// Mass properties and modes.
    pub body: BodyReport,
    /// Angle that the body has turned by, rad: of a hinge about its axis, with its sign; else along its way, ∫|ω| dt.
    pub turned: f64,
    /// Angle between first and last attitude, rad (0 to π).
    pub turned_from_start: f64,
    /// Displacement of the centre of mass, global.
    pub moved: [f64; 3],
    /// Largest strain energy among the rows.
    #[serde(serialize_with = "json::number")]
    pub peak_strain_energy: f64,
    /// Largest von Mises stress among the rows, where the scene asks for it.
    pub peak_stress: Option<PeakStress>,
    /// Kinetic plus strain energy of the last row.
    #[serde(serialize_with = "json::number")]
    pub final_energy: f64,
    /// How far the balances are from closed.
    pub balances: Balances,
    /// True if the balance of energy is open though the motion is right: modes faster than the steps follow themselves
    /// exactly, but the work on them and their dissipation are summed by the stages.
    pub right_unsummed: bool,
    /// The effects of this body and whether each was computed; none of the paper's formulation, which has its own.
    #[serde(serialize_with = "json::object")]
    pub effects: Vec<(&'static str, bool)>,
    /// The modes that bent the body far; none without large deflection. Numbered from 1.
    pub large_modes: Vec<usize>,
    /// The most that the orders beyond the fourth, which are left out, come to of the forces on these modes, about.
    pub left_out: Option<f64>,
    /// Assumptions that did not hold.
    pub warnings: Vec<String>,
    /// Where the time went, seconds.
    pub times: Times,
}

impl RunReport {
    /// Method and steps, such as "conservative form, scheme exponential, 5000 steps of 1e-4 s".
    pub(crate) fn steps_in_words(&self) -> String {
        let time = &self.units[2];
        let form = match self.formulation.as_str() {
            "paper" => "paper's",
            _ => "conservative",
        };
        let [shortest, longest] = self.step_lengths;
        let lengths = if longest - shortest <= 1e-9 * longest {
            format!("of {longest:.6e} {time}")
        } else {
            format!("from {shortest:.3e} to {longest:.3e} {time}")
        };
        let control = match self.tolerance {
            Some(tolerance) => format!(" ({} rejected, tolerance {tolerance:e})", self.rejected_steps),
            None => String::new(),
        };
        format!("{form} form, scheme {}, {} steps{control} {lengths}", self.scheme, self.steps)
    }
}

impl RunReport {
    /// "turned by 300 rad (47.7 turns), to an attitude 1.59 rad from the first".
    fn turned_in_words(&self) -> String {
        let Self { turned, turned_from_start: from_start, .. } = *self;
        let turned_by = format!("turned by {} rad", quantity(turned));
        if turned.abs() <= PI {
            return turned_by;
        }
        let turns = quantity(format!("{:.3e}", turned / TAU).parse().unwrap_or(turned / TAU));
        let from_start = quantity(format!("{from_start:.3e}").parse().unwrap_or(from_start));
        format!("{turned_by} ({turns} turns), to an attitude {from_start} rad from the first")
    }
}

impl fmt::Display for RunReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [length, mass, time] = &self.units;
        let units = UnitLabels { length, mass, time };
        writeln!(f, "{}", self.title)?;
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
        if let Some(left_out) = self.left_out {
            let modes: Vec<String> = self.large_modes.iter().map(ToString::to_string).collect();
            let s = if modes.len() == 1 { "" } else { "s" };
            writeln!(
                f,
                "  large    mode{s} {}; orders beyond the fourth left out, about {left_out:.1e} of the forces",
                modes.join(", ")
            )?;
        }
        writeln!(f, "  motion   {}, {:.0} steps per second", self.steps_in_words(), self.steps_per_second)?;
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
        writeln!(f, "  time     {}", self.times)?;
        write!(f, "  results  {} ({} rows)", self.results.display(), self.rows)?;
        for warning in &self.warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}
