//! The part of the report of `flexframe run` that is of one body.

use serde::Serialize;

use super::balances::Balances;
use crate::files::json;
use crate::report::{BodyReport, MeshReport};
use crate::rows::peak_stress::PeakStress;

/// Report of the run of one body.
#[derive(Debug, Clone, Serialize)]
pub struct BodyRunReport {
    /// Its name.
    pub name: String,
    /// Formulation and scheme, in words.
    pub scheme: String,
    /// Steps taken.
    pub steps: u64,
    /// Steps that step control tried in vain.
    pub rejected_steps: u64,
    /// Lengths of the shortest and the longest step.
    #[serde(serialize_with = "json::numbers")]
    pub step_lengths: [f64; 2],
    /// Evaluations of the rates.
    pub evaluations: u64,
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
    /// True if the balance of energy tells of the motion: its steps resolve all modes, so that work and dissipation are summed closely, and it is
    /// not closed for all bodies together where that of one is open.
    pub energy_tells: bool,
    /// Expected error of fixed steps, relative to the largest motion; under step control the sum of the estimates of all steps. `None` where
    /// it was not estimated.
    #[serde(serialize_with = "json::optional")]
    pub step_error: Option<f64>,
    /// Vibration that steps under control did not resolve and so damped, over the largest deformation of a body.
    #[serde(serialize_with = "json::number")]
    pub forgotten_vibration: f64,
    /// The effects of this body and whether each was computed; none of the paper's formulation, which has its own.
    #[serde(serialize_with = "json::object")]
    pub effects: Vec<(&'static str, bool)>,
    /// The modes that bent the body far; none without large deflection. Numbered from 1.
    pub large_modes: Vec<usize>,
    /// The one of these that is no mode, but what the static answer to the moments has beside the others.
    pub static_answer: Option<usize>,
}
