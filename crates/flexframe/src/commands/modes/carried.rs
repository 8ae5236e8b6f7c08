//! The mass that each mode carries in motions of the base, for people and for scripts.

use std::f64::consts::TAU;

use dynamics::SystemParticipation;
use model::Model;
use nalgebra::Vector3;
use reduced_body::{OfBase, Participation};
use report::{Form, Report, Table};

use crate::report::quantity;

/// Rigid motions of a free body.
const FREE: usize = 6;
/// A part of the mass that is not worth a word.
const NOTHING: f64 = 5e-4;
/// Names of the motions of the base.
pub const MOTIONS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Participation factors and effective masses of the flexible modes of a body, or of the vibrations of a system without damping. Lists
/// of six are translations of the base along the axes of the mesh, or of the ground along the global axes, then rotations about them.
pub(crate) struct Carried {
    participation: Participation,
    /// Name of the point that the base turns about.
    point: &'static str,
    /// Frequencies of a system without damping, cycles per time, in the order of the lists, and their unit; a body has them apart.
    frequencies: Option<(Vec<f64>, String)>,
    /// True if the body is free: its rigid motions carry all of it. A system is never: without a ground it has no report.
    is_free: bool,
}

impl Carried {
    /// The masses of a model; `about` is a point in the frame of the mesh in the place of the support or the center of mass.
    pub(super) fn of_body(model: &Model, about: Option<[f64; 3]>) -> Self {
        let body = &model.body;
        let is_free = body.motion.count() == FREE;
        let (about, point) = match (about, is_free) {
            (Some(about), _) => (Vector3::from(about), "the point asked for"),
            (None, true) => (body.center_of_mass, "the center of mass"),
            (None, false) => (body.origin, "the support"),
        };
        Self { participation: body.participation(&about), point, frequencies: None, is_free }
    }

    /// The masses of a system; `is_asked`: a user has named the point.
    pub(crate) fn of_system(found: SystemParticipation, is_asked: bool, unit: &str) -> Self {
        let point = if is_asked { "the point asked for" } else { "the first place on the ground" };
        let frequencies = found.circular_frequencies.iter().map(|omega| omega / TAU).collect();
        let frequencies = Some((frequencies, unit.to_owned()));
        Self { participation: found.participation, point, frequencies, is_free: false }
    }

    /// Adds them to a report.
    pub(crate) fn add_to(self, report: &mut Report) {
        let (effective_masses, missed) = (self.participation.effective_masses(), self.participation.missed());
        let Self { participation: Participation { about, whole, rigid, factors }, point, frequencies, is_free } = self;
        let parts = |carried: &OfBase| -> OfBase {
            std::array::from_fn(|i| if whole[i] > 0.0 { carried[i] / whole[i] } else { 0.0 })
        };
        let mut sum = rigid;
        let cumulated = effective_masses.iter().map(|of_mode| {
            sum.iter_mut().zip(of_mode).for_each(|(sum, mass)| *sum += mass);
            parts(&sum)
        });
        let cumulated: Vec<OfBase> = cumulated.collect();
        report.put("carried.about", <[f64; 3]>::from(about));
        report.put("carried.point", point);
        if let Some((frequencies, _)) = &frequencies {
            report.put("carried.frequencies", &frequencies[..]);
        }
        report.put("carried.motions", MOTIONS);
        report.put("carried.whole", whole);
        report.put("carried.rigid", rigid);
        report.put("carried.factors", factors);
        report.put("carried.effective_masses", &effective_masses[..]);
        report.put("carried.cumulated", &cumulated[..]);
        report.put("carried.missed", missed);
        report.put("carried.is_free", is_free);
        if is_free {
            report.words("  the body is free: its rigid motions carry all of its mass, apart from the modes");
            return;
        }
        let mut rows = vec![("rigid".to_owned(), parts(&rigid))];
        rows.retain(|(_, parts)| parts.iter().any(|part| *part > 0.0));
        let of_modes = effective_masses.iter().map(parts).enumerate();
        rows.extend(of_modes.filter_map(|(k, parts)| match &frequencies {
            None => Some(((k + 1).to_string(), parts)),
            // Most shapes of markers are fast and carry nothing.
            Some((of, _)) => parts.iter().any(|part| *part >= NOTHING).then(|| (quantity(of[k]), parts)),
        }));
        rows.extend(cumulated.last().map(|last| ("sum".to_owned(), *last)));
        let (of, head) = match &frequencies {
            None => ("body's", "mode".to_owned()),
            Some((_, unit)) => ("system's, without damping", format!("frequency, {unit}")),
        };
        // A coordinate that is zero but for rounding is shown as zero.
        let radius =
            if whole[0] > 0.0 { (whole[3..].iter().copied().fold(0.0, f64::max) / whole[0]).sqrt() } else { 0.0 };
        let size = about.iter().fold(radius, |most: f64, x| most.max(x.abs()));
        let [x, y, z] = <[f64; 3]>::from(about).map(|x| quantity(if x.abs() < 1e-12 * size { 0.0 } else { x }));
        let mut table = Table::new("carried", None)
            .titled(format!("effective mass, % of the {of}; rotations about {point} at [{x}, {y}, {z}]"))
            .all()
            .text_only(head, Form::Plain, rows.iter().map(|(name, _)| name));
        for (i, motion) in MOTIONS.into_iter().enumerate() {
            table = table.text_only(motion, Form::Fixed(2), rows.iter().map(|(_, parts)| 100.0 * parts[i]));
        }
        report.table(table);
        let [mass, inertia] = [words("mass", 0..3, &missed), words("inertia", 3..6, &missed)];
        report.words(match frequencies {
            None => format!("  in a motion of the base, the modes that are kept miss {mass}; {inertia}"),
            Some(_) => {
                format!("  what the ground takes along, and what the modes of the bodies miss: {mass}; {inertia}")
            }
        });
    }
}

/// A sentence on the parts of the mass or the inertia that the modes that are kept miss.
fn words(of: &str, motions: std::ops::Range<usize>, missed: &OfBase) -> String {
    let parts = motions.filter(|i| missed[*i] > NOTHING);
    let parts: Vec<String> = parts.map(|i| format!("{:.1} % {}", 100.0 * missed[i], MOTIONS[i])).collect();
    if parts.is_empty() { format!("none of the {of}") } else { format!("of the {of} {}", parts.join(", ")) }
}
