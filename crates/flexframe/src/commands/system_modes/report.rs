//! Report of the vibrations of a system.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use dynamics::{Effect, Spring, SteadyState, SystemMode, Vibrations};
use report::{Form, Report, Value};
use scene::{Body, Choice, Damping, Scene};
use serde::Serialize;

use super::assembled::TiedMotion;
use super::rotors::{Rotors, SpinningRotor};
use crate::commands::modes::{Carried, frequency_unit, table_of_modes};
use crate::files::json;
use crate::report::{counted, quantity};

/// Part of a mode's energy from which a body or a joint is named.
const NAMED: f64 = 0.005;
/// An acceleration, as a part of the size of the system and the square of its lowest frequency, from which it is told.
const TOLD: f64 = 1e-9;
/// Part of the elastic energy above which a vibration is that of a body.
const ITS_OWN: f64 = 0.9;
/// A damping ratio over that of the modes of the body, below which it is told.
const LESS: f64 = 0.5;

/// The vibrations of bodies that are tied together.
#[derive(Debug, Clone)]
pub struct SystemModes {
    /// Numbers of the bodies in the scene.
    pub bodies: Vec<usize>,
    /// The states of the bodies.
    pub states: Vec<dynamics::MotionState>,
    /// Their vibrations.
    pub vibrations: Vibrations,
    /// Who takes part in them, and the system as a whole.
    pub report: SystemModesReport,
}

/// Who takes part in the vibrations of bodies that are tied together, and the system as a whole.
#[derive(Debug, Clone)]
pub struct SystemModesReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// Label of the unit of time.
    pub time_unit: String,
    /// Time of the run at which the system stands so.
    pub time: f64,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Names of springs and bushings.
    pub elements: Vec<String>,
    /// Rows of joints and couplings.
    pub rows: usize,
    /// Joints with rows that others imply where bodies are rigid, and how many.
    pub redundant: Vec<(String, usize)>,
    /// Independent coordinates.
    pub degrees_of_freedom: usize,
    /// Motions that deform no body.
    pub mechanisms: usize,
    /// Motions that nothing resists, whose frequency is zero.
    pub rigid_modes: usize,
    /// Rotors that spin, of which the vibrations have the gyroscopic moments.
    pub rotors: Vec<SpinningRotor>,
    /// Sentences about a state that is not at rest, and about vibrations that grow.
    pub warnings: Vec<String>,
    /// Vibrations, slowest first.
    pub modes: Vec<SystemModeReport>,
}

/// One vibration.
#[derive(Debug, Clone)]
pub struct SystemModeReport {
    /// Frequency of the motion, cycles per time.
    pub frequency: f64,
    /// Damping ratio: −growth over the magnitude of the eigenvalue.
    pub damping_ratio: f64,
    /// Rate at which it grows; negative where it decays.
    pub growth: f64,
    /// Parts of the kinetic energy by bodies: who moves.
    pub moves: Vec<Share>,
    /// Parts of the elastic energy by bodies, joints and springs: who is strained. Empty where nothing is.
    pub strained: Vec<Share>,
}

/// A part of the energy of a vibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// Name of the body, joint, spring or bushing.
    pub name: String,
    /// Its part.
    #[serde(serialize_with = "json::number")]
    pub part: f64,
}

impl SystemModesReport {
    pub(super) fn new(
        scene: &Scene,
        motion: &TiedMotion,
        steady: &SteadyState,
        found: &Vibrations,
        rotors: Rotors,
    ) -> Self {
        let of_motion = motion.run.motion().system();
        let bodies = body_names(scene, &motion.bodies);
        let joints: Vec<String> = of_motion.joints().iter().map(|joint| joint.name.clone()).collect();
        let springs = steady.linear.springs().map(|spring| match spring {
            Spring::Joint(joint) => joints[joint].clone(),
            Spring::Element(element) => motion.elements[element].clone(),
        });
        let names: Vec<String> = bodies.iter().cloned().chain(springs).collect();
        let [of_bodies, of_all] = [&bodies, &names].map(|names| Names::new(names));
        let mode = |mode: &SystemMode| SystemModeReport {
            frequency: mode.circular_frequency() / TAU,
            damping_ratio: mode.damping_ratio(),
            growth: mode.growth(),
            moves: shares(&of_bodies, &mode.kinetic),
            strained: shares(&of_all, &mode.elastic),
        };
        let rigid_modes = found.rigid.ncols() + found.zeros / 2;
        let time = &scene.units.time;
        let mut report = Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(time),
            time_unit: time.clone(),
            time: motion.run.motion().time(),
            rows: steady.multipliers().len(),
            redundant: motion.run.redundant().to_vec(),
            degrees_of_freedom: steady.linear.size(),
            mechanisms: steady.linear.rigid,
            rigid_modes,
            warnings: rotors.warnings(found.modes.iter().map(SystemMode::circular_frequency)),
            rotors: rotors.found,
            modes: found.modes.iter().map(mode).collect(),
            elements: motion.elements.clone(),
            bodies,
            joints,
        };
        report.warnings.extend(report.unbalance(steady, motion.run.size(), &scene.units.length));
        report.warnings.extend(report.growth());
        let scenes = motion.bodies.iter().map(|body| &scene.bodies[*body]);
        let damping = scenes.zip(&report.bodies).filter_map(|(given, name)| report.damping(given, name));
        let damping: Vec<String> = damping.collect();
        report.warnings.extend(damping);
        report
    }

    /// Tells of a body that does not stay where it is.
    fn unbalance(&self, steady: &SteadyState, size: f64, length: &str) -> Option<String> {
        let unbalance = &steady.unbalance;
        let accelerations = unbalance.accelerations.iter().zip(&unbalance.angular_accelerations);
        let sizes = accelerations.map(|(a, alpha)| a.norm() / size + alpha.norm());
        let (body, largest) = sizes.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let lowest = self.modes.iter().map(|mode| mode.frequency).find(|frequency| *frequency > 0.0).unwrap_or(1.0);
        (largest > TOLD * (TAU * lowest).powi(2)).then(|| {
            let time = &self.time_unit;
            format!(
                "the system is not at rest where it stands: body {} is free to go with {} {length}/{time}² and {} rad/{time}²; the \
                 vibrations are those about this accelerated motion, at its instant. Place it where its forces balance, or \
                 take out what moves it",
                self.bodies[body],
                quantity(unbalance.accelerations[body].norm()),
                quantity(unbalance.angular_accelerations[body].norm()),
            )
        })
    }

    /// Tells of a body that damps a vibration of the whole less than its modes.
    fn damping(&self, given: &Body, body: &str) -> Option<String> {
        let ratio = match &given.modes.damping {
            Damping::Uniform(ratio) => *ratio,
            Damping::List(ratios) => ratios.iter().copied().fold(f64::INFINITY, f64::min),
            Damping::Table(_) | Damping::Rayleigh(_) => return None,
        };
        let is_its_own = |mode: &SystemModeReport| {
            mode.frequency > 0.0 && mode.strained.iter().any(|share| share.name == body && share.part > ITS_OWN)
        };
        let (k, mode) = self.modes.iter().enumerate().find(|(_, mode)| is_its_own(mode))?;
        let is_less = given.effects.choices[Effect::Damping] != Choice::Off
            && mode.growth <= 0.0
            && mode.damping_ratio < LESS * ratio;
        is_less.then(|| {
            let (damped, frequency, unit) = (mode.damping_ratio, quantity(mode.frequency), &self.frequency_unit);
            let beta = quantity(ratio / (PI * mode.frequency));
            format!(
                "mode {} has the damping ratio {damped:.1e}, where body {body} has {ratio}: that is the ratio of its modes without joints and of the \
                 shapes of its markers, all of which are faster. With rayleigh = {{ alpha = 0.0, beta = {beta} }} in the place of it, the body damps \
                 {frequency} {unit} by {ratio} however it is held",
                k + 1
            )
        })
    }

    /// The report, with the mass that each vibration carries in a motion of the ground, if that holds the system.
    pub(super) fn report(&self, carried: Option<Carried>) -> Report {
        let (time, unit) = (&self.time_unit, &self.frequency_unit);
        let mut report = Report::new(&self.title);
        report.put("frequency_unit", unit);
        report.put("time_unit", time);
        report.put("time", self.time);
        report.put("bodies", &self.bodies[..]);
        report.put("joints", &self.joints[..]);
        report.put("elements", &self.elements[..]);
        report.put("rows", self.rows);
        report.put("redundant", Value::of(&self.redundant));
        report.put("degrees_of_freedom", self.degrees_of_freedom);
        report.put("mechanisms", self.mechanisms);
        report.put("rigid_modes", self.rigid_modes);
        if !self.rotors.is_empty() {
            report.put("rotors", Value::of(&self.rotors));
        }
        let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        report.line("bodies", list(&self.bodies));
        if self.time > 0.0 {
            let at = quantity(self.time);
            report.line("place", format!("at the time {at} {time} of a run, at rest there"));
        }
        let elements = if self.elements.is_empty() { String::new() } else { format!("; {}", self.elements.join(", ")) };
        report.line("joints", format!("{}{elements}: {} rows", list(&self.joints), self.rows));
        for (name, rows) in &self.redundant {
            let rows = counted(*rows, ["row is", "rows are"]);
            report.line("", format!("{rows} implied by others at {name}, where bodies are rigid"));
        }
        self.rotors.iter().for_each(|rotor| report.line("rotor", rotor.words(time)));
        let deform = counted(self.mechanisms, ["deforms", "deform"]);
        let coordinates = counted(self.degrees_of_freedom, ["independent coordinate", "independent coordinates"]);
        let free = if self.rigid_modes == 0 { "none".to_owned() } else { self.rigid_modes.to_string() };
        report.line("motions", format!("{coordinates}, of which {deform} no body; nothing resists {free}"));
        let each = || self.modes.iter();
        let growth = each().map(|mode| match (mode.growth > 0.0, mode.frequency > 0.0) {
            (true, _) => format!("grows by {} per {time}", quantity(mode.growth)),
            (false, true) => String::new(),
            (false, false) => format!("decays by {} per {time}", quantity(-mode.growth)),
        });
        let table = table_of_modes(Some("modes"), unit, each().map(|mode| (mode.frequency, mode.damping_ratio)));
        report.table(
            table
                .column("growth", each().map(|mode| mode.growth))
                .column("moves", each().map(|mode| Value::of(&mode.moves)))
                .column("strained", each().map(|mode| Value::of(&mode.strained)))
                .text_only("who moves", Form::Plain, each().map(|mode| words(&mode.moves)))
                .text_only("who is strained", Form::Plain, each().map(|mode| words(&mode.strained)))
                .text_only("", Form::Plain, growth),
        );
        carried.into_iter().for_each(|carried| carried.add_to(&mut report));
        report.warnings.clone_from(&self.warnings);
        report
    }

    fn growth(&self) -> Option<String> {
        let grows = self.modes.iter().position(|mode| mode.growth > 0.0)?;
        Some(format!(
            "mode {} grows by a rate of {} per {}: the system does not stay in this state",
            grows + 1,
            quantity(self.modes[grows].growth),
            self.time_unit
        ))
    }
}

/// Names of bodies by their numbers.
pub(crate) fn body_names(scene: &Scene, numbers: &[usize]) -> Vec<String> {
    let name = |number: &usize| scene.bodies[*number].name.clone().unwrap_or_else(|| "body".to_owned());
    numbers.iter().map(name).collect()
}

/// The largest shares.
fn words(shares: &[Share]) -> String {
    let each = shares.iter().take(4).map(|share| format!("{} {:.0} %", share.name, 100.0 * share.part));
    if shares.is_empty() { "nothing".to_owned() } else { each.collect::<Vec<_>>().join(", ") }
}

/// Names, some of them of several parts.
struct Names {
    each: Vec<String>,
    /// The name of each part.
    of_parts: Vec<usize>,
}

impl Names {
    fn new(names: &[String]) -> Self {
        let mut places = HashMap::new();
        let mut each = Vec::new();
        let of_name = |name: &String| {
            *places.entry(name.clone()).or_insert_with(|| {
                each.push(name.clone());
                each.len() - 1
            })
        };
        let of_parts = names.iter().map(of_name).collect();
        Self { each, of_parts }
    }
}

/// Sums of the parts by names, largest first, without the smallest.
fn shares(names: &Names, parts: &[f64]) -> Vec<Share> {
    let mut sums = vec![0.0; names.each.len()];
    names.of_parts.iter().zip(parts).for_each(|(place, part)| sums[*place] += part);
    let named = names.each.iter().zip(sums).filter(|(_, part)| part.abs() >= NAMED);
    let mut shares: Vec<Share> = named.map(|(name, part)| Share { name: name.clone(), part }).collect();
    shares.sort_by(|a, b| b.part.abs().total_cmp(&a.part.abs()));
    shares
}
