//! Hashes of a set-up, so that a checkpoint of another run is not taken up.

use keys::{Key, Keyed};
use serde::{Deserialize, Serialize};

use crate::load::SharedLoad;
use crate::simulation::checkpoint::{CheckpointError, encode, to_words};
use crate::simulation::setup::Setup;
use crate::system::element::data::data as element_data;
use crate::system::run::setup::SystemSetup;

/// The first bytes of the key of each part of a set-up.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Fingerprint {
    keys: Vec<[u8; 8]>,
    /// Names of the parts, for messages.
    #[serde(skip)]
    names: Vec<String>,
    /// The things whose number may differ.
    #[serde(skip)]
    counted: &'static str,
}

impl Fingerprint {
    pub(crate) fn of(setup: &Setup) -> Self {
        let Setup { body, damping_ratios, loads, physics, initial, method, control, end, rows, points: _ } = setup;
        let (mut parts, key) = (Self { counted: "loads", ..Self::default() }, Key::new);
        parts.add("the body", body.key(key()));
        parts.add("the damping", damping_ratios.key(key()));
        parts.add("an effect or the drive", physics.key(key()));
        parts.add("the start", initial.key(key()));
        let method = method.key(key());
        parts.add("the scheme or its steps", method.with("control", control).with("end", end).with("rows", rows));
        parts.add_loads("", loads);
        parts
    }

    /// The parts of bodies in joints. Laws, elements and equations from outside have nothing to compare.
    pub(crate) fn of_system(setup: &SystemSetup) -> Self {
        let SystemSetup { system, states, start, scheme, control, end, rows, points: _ } = setup;
        let (mut parts, key) = (Self { counted: "bodies, loads or joints", ..Self::default() }, Key::new);
        let data = |what, bytes: Result<Vec<u8>, CheckpointError>| {
            key().of(what, 1).with("data", &to_words(&bytes.unwrap_or_default()))
        };
        let method = key().of("method of systems", 2).with("scheme", scheme.name()).with("start", start.name());
        parts.add("the scheme or its steps", method.with("control", control).with("end", end).with("rows", rows));
        parts.add("the start", data("states", encode(states)));
        for (number, body) in system.bodies().iter().enumerate() {
            let name = system.named(number).to_string();
            parts.add(&name, body.key(key()));
            parts.add_loads(&format!(" of {name}"), body.loads());
        }
        for joint in system.joints() {
            parts.add(&format!("the joint \"{}\"", joint.name), data("joint", encode(joint)));
        }
        for coupling in system.couplings() {
            parts.add("a coupling", data("coupling", encode(coupling)));
        }
        for element in system.elements() {
            parts.add("a spring or a bushing", data("element", encode(&element_data(&**element))));
        }
        parts
    }

    fn add(&mut self, name: &str, key: Key) {
        let hash = key.finish();
        self.keys.push(std::array::from_fn(|i| hash.as_bytes()[i]));
        self.names.push(name.to_owned());
    }

    fn add_loads(&mut self, of: &str, loads: &[SharedLoad]) {
        for (number, load) in loads.iter().enumerate() {
            self.add(&format!("load {}{of}", number + 1), load.key(Key::new()));
        }
    }

    /// Refuses another one, and says in what it differs.
    pub(crate) fn check(&self, found: &Self) -> Result<(), CheckpointError> {
        let mut parts = self.names.iter().zip(self.keys.iter().zip(&found.keys));
        let what = match parts.find(|(_, (own, found))| own != found) {
            Some((name, _)) => name.clone(),
            None if self.keys.len() == found.keys.len() => return Ok(()),
            None => format!("the number of {}", self.counted),
        };
        Err(CheckpointError::Changed { what })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Vector3;

    use super::*;
    use crate::{
        Begin, Drive, DrivenMotion, DrivenSpeed, Expression, History, Initial, LoadFn, Method, Physics, Rows,
        SharedLoad, StepControl, Table,
    };

    /// Regression only: checkpoints of users have these keys. Who gives a field another name changes none of them;
    /// who changes what a part means raises its version and writes down another.
    const KNOWN: [&str; 4] = ["f7b305f6253577a0", "9014f39bdcbb152b", "9686e52d64aa21ea", "00a4d3ccdc0f6198"];

    #[test]
    fn the_keys_of_a_set_up_stay() {
        let hash = |key: Key| key.finish().to_string()[..16].to_owned();
        let factors = vec![
            History::Constant,
            History::Step { at: 0.5 },
            History::Ramp { start: 0.0, duration: 2.0 },
            History::HalfSine { start: 0.0, duration: 1.0 },
            History::Sine { frequency: 3.0, phase: 0.1, start: 0.0, duration: None },
            History::Sweep { from: 1.0, to: 2.0, start: 0.0, duration: 4.0 },
            History::Table(Table::new(vec![0.0, 1.0, 3.0], vec![0.0, 1.0, -1.0]).unwrap()),
            History::Expression(Expression::new("sin(t)", vec![1.5]).unwrap()),
        ];
        let history = History::Product { factors };
        let motion = DrivenMotion::Turn { axis: Vector3::z() };
        let drive = Drive { motion, speed: DrivenSpeed { amplitude: 7.0, history }, added: None };
        let physics = Physics { drive: Some(drive), ..Physics::default() };
        let load: SharedLoad = Arc::new(LoadFn::new("drag", |_, _| ()).with_longest_step(0.25));
        let steps = Begin::key(&Method::EXPONENTIAL, Key::new()).with("control", &StepControl::Fixed(0.01));
        let found = [
            physics.key(Key::new()),
            Initial::at_rest(2).key(Key::new()),
            steps.with("rows", &Rows::EverySteps(3)),
            load.key(Key::new()),
        ];
        assert_eq!(found.map(hash), KNOWN);
    }
}
