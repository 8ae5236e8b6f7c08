//! Check sums of a set-up, so that a checkpoint of another run is not taken up.

use std::fmt::{self, Write};

use crc32fast::Hasher;
use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::CheckpointError;
use crate::simulation::setup::Setup;

/// Parts of a set-up before its loads.
const PARTS: [&str; 5] = ["the body", "the damping", "an effect or the drive", "the start", "the scheme or its steps"];

/// A check sum (CRC-32) of each part of a set-up, its loads last: of what [`fmt::Debug`] prints, which of a built-in load
/// is its data, and of a [`LoadFn`](crate::LoadFn) its name, discontinuities and longest step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fingerprint(Vec<[u8; 4]>);

impl Fingerprint {
    pub(crate) fn of(setup: &Setup) -> Self {
        let Setup { body, damping_ratios, loads, physics, initial, .. } = setup;
        let steps = (setup.method, setup.control, setup.end, setup.rows);
        let parts: [&dyn fmt::Debug; PARTS.len()] = [body, damping_ratios, physics, initial, &steps];
        let loads = loads.iter().map(|load| load as &dyn fmt::Debug);
        Self(parts.into_iter().chain(loads).map(check_sum).collect())
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

fn check_sum(value: &dyn fmt::Debug) -> [u8; 4] {
    struct Sum(Hasher);
    impl Write for Sum {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut sum = Sum(Hasher::new());
    // It fails only where the value's own Debug does; what was printed until then counts.
    let _ = write!(sum, "{value:?}");
    sum.0.finalize().to_le_bytes()
}
