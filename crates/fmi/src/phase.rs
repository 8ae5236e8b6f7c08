//! The phases of an instance that the standard has.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Where an instance is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    Instantiated,
    Initialization,
    Stepping,
    Terminated,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "before fmi2EnterInitializationMode",
            Self::Initialization => "before fmi2ExitInitializationMode",
            Self::Stepping => "after fmi2ExitInitializationMode",
            Self::Terminated => "after fmi2Terminate",
        })
    }
}
