//! Constants of a motion, and its part of the account of the energy.

use crate::observation::energies::Energies;

/// How the steps of a motion are controlled, and where they may end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepping {
    /// Steps end at rows. Under a tolerance steps are tried in pairs, whose length is the time to the next row over a power of two,
    /// so that what belongs to a length is found once.
    Pairs,
    /// Steps end where they like: rows are found within them. Under a tolerance each is as long as its error allows.
    Free {
        /// Longest step under a tolerance that the scheme allows.
        longest: f64,
        /// Error of a step that is rounding.
        rounding: f64,
    },
}

/// Constants of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionFacts {
    /// Number of flexible modes of each body.
    pub flexible: Vec<usize>,
    /// Number of joints.
    pub joints: usize,
    /// Number of force elements.
    pub elements: usize,
    /// Largest of ω_k and 2 ζ_k ω_k, by which the account of the energy knows whether steps see the modes.
    pub fastest_rate: f64,
    /// How it is stepped.
    pub stepping: Stepping,
}

impl MotionFacts {
    /// Constants of a body that nothing ties.
    pub fn of_body(flexible: usize, fastest_rate: f64) -> Self {
        Self { flexible: vec![flexible], joints: 0, elements: 0, fastest_rate, stepping: Stepping::Pairs }
    }

    /// True if rows are found within steps.
    pub(crate) fn is_free(&self) -> bool {
        self.stepping != Stepping::Pairs
    }
}

/// Energies at a row, and how well they are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// The energies.
    pub energies: Energies,
    /// Energy that has been in the motion, by which errors are measured; the account knows more by itself.
    pub scale: f64,
    /// Energy that steps may miss or add.
    pub unseen: f64,
}

impl Balance {
    /// Energies of which the account knows all by itself.
    pub fn of(energies: Energies) -> Self {
        Self { energies, scale: 0.0, unseen: 0.0 }
    }
}
