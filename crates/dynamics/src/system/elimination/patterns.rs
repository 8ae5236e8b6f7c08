//! The two patterns of a system.

use crate::system::constraints::Constraints;
use crate::system::description::System;
use crate::system::elimination::joint_matrix::Pattern;

/// Patterns of the matrices of a system.
#[derive(Debug, Clone)]
pub(in crate::system) struct Patterns {
    /// Pattern of the rows of joints and couplings.
    pub rows: Pattern,
    /// With the compliant rows.
    pub newton: Pattern,
}

impl Patterns {
    /// The patterns of the rows of `constraints`.
    pub fn new(system: &System, constraints: &Constraints) -> Self {
        let rows = || system.connections.groups();
        let pattern = |groups: Vec<usize>| Pattern::new(&groups, &constraints.ends, system.bodies.len());
        Self {
            rows: pattern(rows().collect()),
            newton: pattern(rows().chain(system.connections.compliant_groups()).collect()),
        }
    }
}
