//! The run of a live page: its data, and what may be changed.

use std::f64::consts::PI;
use std::path::Path;

use diagnostic::{Failure, Kind};
use dynamics::{DescribedBody, DrivenMotion, JointForce, RunDescription};
use live::Change;
use model::{BuildProgress, Builder, Model};
use report::{Control, Live, LiveBody};
use results::Results;
use scene::Load;

use crate::commands::run::{bodies, metadata, system_of};
use crate::motion::StartSettings;
use crate::motion::described::{Described, describe};
use crate::rows::units::UnitLabels;

/// Greatest factor that is offered.
const GREATEST_FACTOR: f64 = 3.0;
/// Greatest damping ratio that is offered.
const GREATEST_DAMPING: f64 = 0.2;
/// Number of the change that the page has for the spin of a body, after those of [`Change`].
const SPIN: usize = 7;

/// The run of a results file, with its bodies built again.
pub(super) fn led_on(
    file: &Path,
    results: &Results,
    builder: &Builder,
    progress: impl FnMut(BuildProgress),
) -> Result<Live, Failure> {
    let changed = |what| {
        let help = "run its scene again with --overwrite, then make its live page";
        Kind::Input.of(file).help(help).says(format!("{what} has changed since this run"))
    };
    let system = system_of(results)?.ok_or_else(|| changed("the list of bodies"))?;
    let models = builder.models(&system, progress)?;
    let now = metadata(&system, &bodies(&system.bodies, &models));
    for (now, then) in now.bodies.iter().zip(&results.metadata.bodies) {
        let mut then = then.model.clone();
        then.mesh = None;
        if now.model != then {
            return Err(changed("the body"));
        }
    }
    let of_models: Vec<&Model> = models.iter().collect();
    let beginning = StartSettings::of(&system, &of_models);
    let Described { run, elements } = describe(&system, &of_models, &beginning)?;
    let names: Vec<&str> = results.metadata.bodies.iter().map(|body| &*body.name).collect();
    let mut controls = Vec::new();
    for (number, motion) in run.motions.iter().enumerate() {
        for (own, body) in motion.bodies.iter().enumerate() {
            let described = &motion.run.bodies[own];
            let group = if names.len() > 1 { names[*body] } else { "" };
            controls.extend(of_body(group, *body, described, &system.bodies[*body].loads));
            let (spin, end) = (motion.run.states[own].omega_body.norm(), motion.run.end);
            if turns(described) {
                let greatest = if spin > 0.0 { GREATEST_FACTOR * spin } else { 8.0 * PI / end };
                let unit = format!("rad/{}", results.metadata.units.time);
                let (name, change) = ("spin".to_owned(), [SPIN, *body, 0]);
                let range = [0.0, greatest];
                controls.push(Control { group: group.to_owned(), name, unit, change, range, recorded: spin });
            }
        }
        controls.extend(of_system(number, &motion.run, &elements[number]));
    }
    let results::Units { length, mass, time } = &results.metadata.units;
    let units = UnitLabels { length, mass, time };
    Ok(Live {
        run: run
            .to_bytes()
            .map_err(|error| Kind::Usage.of(file).says(format!("no live page can be made of this run: {error}")))?,
        bodies: models.iter().map(|model| LiveBody { mass: model.body.mass }).collect(),
        controls,
        units: [units.force(), units.energy(), units.momentum(), units.angular_momentum()],
    })
}

fn factor(group: &str, name: String, change: Change) -> Control {
    let range = [0.0, GREATEST_FACTOR];
    Control { group: group.to_owned(), name, unit: String::new(), change: change.numbers(), range, recorded: 1.0 }
}

/// Controls of a body.
fn of_body(group: &str, body: usize, described: &DescribedBody, loads: &[Load]) -> Vec<Control> {
    let mut controls = Vec::new();
    for load in 0..described.loads.len() {
        // Gravity that is left out is not among the loads of the run.
        let kind =
            loads.get(load).filter(|_| loads.len() == described.loads.len()).map_or("load", |load| load.kind.name());
        let kind = kind.replace('-', " ");
        let name = if described.loads.len() > 1 { format!("{kind} (load {})", load + 1) } else { kind };
        controls.push(factor(group, name, Change::Load { body, load }));
    }
    if described.physics.drive.is_some() {
        controls.push(factor(group, "driven speed".to_owned(), Change::Drive { body }));
    }
    if described.body.flexible() > 0 {
        let (name, change) = ("damping ratio, added".to_owned(), Change::Damping { body }.numbers());
        let range = [0.0, GREATEST_DAMPING];
        controls.push(Control { group: group.to_owned(), name, unit: String::new(), change, range, recorded: 0.0 });
    }
    controls
}

/// True if a body may turn by itself.
fn turns(described: &DescribedBody) -> bool {
    let is_turned =
        described.physics.drive.as_ref().is_some_and(|drive| matches!(drive.motion, DrivenMotion::Turn { .. }));
    !described.body.motion.rotations().is_empty() && !is_turned
}

/// Controls of the joints, springs and bushings of a system.
fn of_system(motion: usize, run: &RunDescription, elements: &[String]) -> Vec<Control> {
    let mut controls = Vec::new();
    for (number, joint) in run.joints.iter().enumerate() {
        let forces = || joint.turn_force.iter().chain(&joint.slide_force);
        let has = |is: &dyn Fn(&JointForce) -> bool| forces().any(is);
        let (group, joint) = (format!("joint {}", joint.name), number);
        if has(&|force| force.stiffness != 0.0) {
            controls.push(factor(&group, "stiffness".to_owned(), Change::JointStiffness { motion, joint }));
        }
        if has(&|force| force.damping != 0.0 || force.friction.is_some()) {
            controls.push(factor(&group, "damping and friction".to_owned(), Change::JointDamping { motion, joint }));
        }
        if has(&|force| force.motor.is_some()) {
            controls.push(factor(&group, "motor".to_owned(), Change::JointMotor { motion, joint }));
        }
    }
    for (element, name) in elements.iter().enumerate() {
        let name = format!("spring or bushing {name}");
        controls.push(factor(&name, "stiffness and damping".to_owned(), Change::Element { motion, element }));
    }
    controls
}
