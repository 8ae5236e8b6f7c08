//! Hashes of a set-up, so that a checkpoint of another run is not taken up.

use keys::{Key, Keyed};
use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::CheckpointError;
use crate::simulation::setup::Setup;

/// Parts of a set-up before its loads.
const PARTS: [&str; 5] = ["the body", "the damping", "an effect or the drive", "the start", "the scheme or its steps"];

/// The first bytes of the key of each part of a set-up, its loads last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fingerprint(Vec<[u8; 8]>);

impl Fingerprint {
    pub(crate) fn of(setup: &Setup) -> Self {
        let Setup { body, damping_ratios, loads, physics, initial, method, control, end, rows, points: _ } = setup;
        let key = Key::new;
        let parts: [Key; PARTS.len()] = [
            body.key(key()),
            damping_ratios.key(key()),
            physics.key(key()),
            initial.key(key()),
            method.key(key()).with("control", control).with("end", end).with("rows", rows),
        ];
        let parts = parts.into_iter().chain(loads.iter().map(|load| load.key(key())));
        let first = |key: Key| {
            let hash = key.finish();
            std::array::from_fn(|i| hash.as_bytes()[i])
        };
        Self(parts.map(first).collect())
    }

    /// Refuses another one, and says in what it differs.
    pub(crate) fn check(&self, found: &Self) -> Result<(), CheckpointError> {
        let Some(part) = self.0.iter().zip(&found.0).position(|(a, b)| a != b) else {
            return match self.0.len() == found.0.len() {
                true => Ok(()),
                false => Err(CheckpointError::Changed { what: "the number of loads".to_owned() }),
            };
        };
        let what = PARTS.get(part).map_or_else(|| format!("load {}", part - PARTS.len() + 1), ToString::to_string);
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
