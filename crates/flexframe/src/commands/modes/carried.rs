//! The mass that each mode carries in motions of the base, for people and for scripts.

use std::f64::consts::TAU;
use std::fmt;

use dynamics::SystemParticipation;
use model::Model;
use nalgebra::Vector3;
use reduced_body::{OfBase, Participation};
use serde::Serialize;

use crate::report::quantity;

/// Rigid motions of a free body.
const FREE: usize = 6;
/// A part of the mass that is not worth a word.
const NOTHING: f64 = 5e-4;
/// Names of the motions of the base.
pub const MOTIONS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Participation factors and effective masses of the flexible modes of a body, or of the vibrations of a system without damping. Lists
/// of six are translations of the base along the axes of the mesh, or of the ground along the global axes, then rotations about them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CarriedReport {
    /// The point that the base turns about, mesh axes; of a system, global.
    pub about: [f64; 3],
    /// Name of the point: "the support", "the center of mass", "the point asked for", "the first place on the ground".
    pub point: &'static str,
    /// Frequencies of a system without damping, cycles per time, in the order of the lists; a body has them apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequencies: Option<Vec<f64>>,
    /// Unit of these frequencies.
    #[serde(skip)]
    unit: String,
    /// Motions of the base, in words.
    pub motions: [&'static str; 6],
    /// Mass of the whole, three times, and its moments of inertia about the point.
    pub whole: OfBase,
    /// Effective masses of the rigid motions that the support leaves, together; of a system, of those that nothing resists or that fall.
    pub rigid: OfBase,
    /// Participation factors of each mode, whose modal mass is 1.
    pub factors: Vec<OfBase>,
    /// Effective masses of each mode.
    pub effective_masses: Vec<OfBase>,
    /// Parts of the whole of the rigid motions and the modes up to each one.
    pub cumulated: Vec<OfBase>,
    /// Parts of the whole that nothing of these carries.
    pub missed: OfBase,
    /// True if the body is free: its rigid motions carry all of it. A system is never: without a ground it has no report.
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
        Self::of(body.participation(&about), point, None, is_free)
    }

    /// The report of a system; `is_asked`: the point is that of a user.
    pub fn of_system(found: SystemParticipation, is_asked: bool, unit: &str) -> Self {
        let point = if is_asked { "the point asked for" } else { "the first place on the ground" };
        let frequencies = found.circular_frequencies.iter().map(|omega| omega / TAU).collect();
        Self { unit: unit.to_owned(), ..Self::of(found.participation, point, Some(frequencies), false) }
    }

    fn of(participation: Participation, point: &'static str, frequencies: Option<Vec<f64>>, is_free: bool) -> Self {
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
            frequencies,
            unit: String::new(),
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

    /// The largest radius of gyration about the point.
    fn radius(&self) -> f64 {
        let largest = self.whole[3..].iter().copied().fold(0.0, f64::max);
        if self.whole[0] > 0.0 { (largest / self.whole[0]).sqrt() } else { 0.0 }
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
        let (mass, inertia) = (words("mass", missed(0..3)), words("inertia", missed(3..6)));
        match self.frequencies {
            None => format!("in a motion of the base, the modes that are kept miss {mass}; {inertia}"),
            Some(_) => format!("what the ground takes along, and what the modes of the bodies miss: {mass}; {inertia}"),
        }
    }
}

/// Parts of the whole; 0 where there is none.
fn parts(carried: &OfBase, whole: &OfBase) -> OfBase {
    std::array::from_fn(|i| if whole[i] > 0.0 { carried[i] / whole[i] } else { 0.0 })
}

impl fmt::Display for CarriedReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_free {
            // What is zero but for rounding is shown as zero.
            let size = self.about.iter().fold(self.radius(), |most: f64, x| most.max(x.abs()));
            let [x, y, z] = self.about.map(|x| quantity(if x.abs() < 1e-12 * size { 0.0 } else { x }));
            let (whole, head, width) = match self.frequencies {
                None => ("body's", "mode".to_owned(), 5),
                Some(_) => ("system's, without damping", format!("frequency, {}", self.unit), 14),
            };
            writeln!(f, "\n  effective mass, % of the {whole}; rotations about {} at [{x}, {y}, {z}]", self.point)?;
            let row = |f: &mut fmt::Formatter<'_>, name: &str, of: &OfBase| {
                write!(f, "  {name:>width$}")?;
                // What is zero but for rounding is shown as zero.
                of.iter().try_for_each(|part| write!(f, "  {:>7.2}", if *part < 5e-5 { 0.0 } else { 100.0 * part }))?;
                writeln!(f)
            };
            write!(f, "  {head:>width$}")?;
            MOTIONS.iter().try_for_each(|motion| write!(f, "  {motion:>7}"))?;
            writeln!(f)?;
            let rigid = parts(&self.rigid, &self.whole);
            if rigid.iter().any(|part| *part > 0.0) {
                row(f, "rigid", &rigid)?;
            }
            for (k, masses) in self.effective_masses.iter().enumerate() {
                let parts = parts(masses, &self.whole);
                match &self.frequencies {
                    None => row(f, &(k + 1).to_string(), &parts)?,
                    Some(frequencies) if parts.iter().any(|part| *part >= NOTHING) => {
                        row(f, &quantity(frequencies[k]), &parts)?;
                    }
                    // Most shapes of markers are fast and carry nothing.
                    Some(_) => {}
                }
            }
            if let Some(last) = self.cumulated.last() {
                row(f, "sum", last)?;
            }
        }
        writeln!(f, "  {}", self.missed_in_words())
    }
}
