//! The mass that each mode carries in motions of the base, for people and for scripts.

use std::fmt;

use modal::{OfBase, Participation};
use model::Model;
use nalgebra::Vector3;
use serde::Serialize;

/// Rigid motions of a free body.
const FREE: usize = 6;
/// A part of the mass that is not worth a word.
const NOTHING: f64 = 5e-4;
/// Names of the motions of the base.
pub const MOTIONS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Participation factors and effective masses of the flexible modes. Lists of six are translations of the base along the axes of the
/// mesh, then its rotations about them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CarriedReport {
    /// The point that the base turns about, mesh axes.
    pub about: [f64; 3],
    /// Name of the point: "the support", "the center of mass", "the point asked for".
    pub point: &'static str,
    /// Motions of the base, in words.
    pub motions: [&'static str; 6],
    /// Mass of the body, three times, and its moments of inertia about the point.
    pub whole: OfBase,
    /// Effective masses of the rigid motions that the support leaves, together.
    pub rigid: OfBase,
    /// Participation factors of each mode, whose modal mass is 1.
    pub factors: Vec<OfBase>,
    /// Effective masses of each mode.
    pub effective_masses: Vec<OfBase>,
    /// Parts of the whole of the rigid motions and the modes up to each one.
    pub cumulated: Vec<OfBase>,
    /// Parts of the whole that nothing of these carries.
    pub missed: OfBase,
    /// True if the body is free: its rigid motions carry all of it.
    pub is_free: bool,
}

impl CarriedReport {
    /// The report of a model; `about` is a point in the frame of the mesh in the place of the support or the center of mass.
    pub fn new(model: &Model, about: Option<[f64; 3]>) -> Self {
        let body = &model.body;
        let is_free = body.motion.count() == FREE;
        let (about, point) = match (about, is_free) {
            (Some(about), _) => (Vector3::from(about), "the point asked for"),
            (None, true) => (body.center_of_mass, "the center of mass"),
            (None, false) => (body.origin, "the support"),
        };
        let participation = body.participation(&about);
        let (effective_masses, missed) = (participation.effective_masses(), participation.missed());
        let Participation { about, whole, rigid, factors } = participation;
        let mut sum = rigid;
        let cumulated = effective_masses.iter().map(|of_mode| {
            sum.iter_mut().zip(of_mode).for_each(|(sum, mass)| *sum += mass);
            parts(&sum, &whole)
        });
        Self {
            about: about.into(),
            point,
            motions: MOTIONS,
            whole,
            rigid,
            cumulated: cumulated.collect(),
            factors,
            effective_masses,
            missed,
            is_free,
        }
    }

    /// The sentence on what the modes that are kept miss.
    fn missed_in_words(&self) -> String {
        if self.is_free {
            return "the body is free: its rigid motions carry all of its mass, apart from the modes".to_owned();
        }
        let missed = |motions: std::ops::Range<usize>| {
            let of = motions.filter(|i| self.missed[*i] > NOTHING);
            of.map(|i| format!("{:.1} % {}", 100.0 * self.missed[i], MOTIONS[i])).collect::<Vec<_>>().join(", ")
        };
        let words = |what: &str, parts: String| {
            if parts.is_empty() { format!("none of the {what}") } else { format!("of the {what} {parts}") }
        };
        format!(
            "in a motion of the base, the modes that are kept miss {}; {}",
            words("mass", missed(0..3)),
            words("inertia", missed(3..6))
        )
    }
}

/// Parts of the whole; 0 where there is none.
fn parts(carried: &OfBase, whole: &OfBase) -> OfBase {
    std::array::from_fn(|i| if whole[i] > 0.0 { carried[i] / whole[i] } else { 0.0 })
}

impl fmt::Display for CarriedReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_free {
            let [x, y, z] = self.about.map(crate::report::quantity);
            writeln!(f, "\n  effective mass, % of the body's; rotations about {} at [{x}, {y}, {z}]", self.point)?;
            let row = |f: &mut fmt::Formatter<'_>, name: &str, of: &OfBase| {
                write!(f, "  {name:>5}")?;
                // What is zero but for rounding is shown as zero.
                of.iter().try_for_each(|part| write!(f, "  {:>7.2}", if *part < 5e-5 { 0.0 } else { 100.0 * part }))?;
                writeln!(f)
            };
            write!(f, "   mode")?;
            MOTIONS.iter().try_for_each(|motion| write!(f, "  {motion:>7}"))?;
            writeln!(f)?;
            let rigid = parts(&self.rigid, &self.whole);
            if rigid.iter().any(|part| *part > 0.0) {
                row(f, "rigid", &rigid)?;
            }
            for (k, masses) in self.effective_masses.iter().enumerate() {
                row(f, &(k + 1).to_string(), &parts(masses, &self.whole))?;
            }
            if let Some(last) = self.cumulated.last() {
                row(f, "sum", last)?;
            }
        }
        writeln!(f, "  {}", self.missed_in_words())
    }
}
