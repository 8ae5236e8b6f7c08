//! Abilities of a formulation of the equations of motion.

/// The parts of the physics that a formulation has. What a scene asks for and a formulation lacks is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Abilities {
    /// Effects can be switched one by one; otherwise the formulation has some always, and never the others.
    pub switches_effects: bool,
    /// Geometric stiffening by loads, drives and spin.
    pub geometric_stiffening: bool,
    /// Large deflection, on a manifold of modes.
    pub large_deflection: bool,
    /// Drives: motions that are prescribed.
    pub drives: bool,
    /// Reactions of what holds the body.
    pub reactions: bool,
    /// Mass matrices that are no scalar for each node, such as those of rotations of nodes.
    pub any_mass: bool,
    /// Its exact solution keeps energy and momenta; otherwise it has a limit of its own.
    pub keeps_energy: bool,
}

impl Abilities {
    /// All of them.
    pub const ALL: Self = Self {
        switches_effects: true,
        geometric_stiffening: true,
        large_deflection: true,
        drives: true,
        reactions: true,
        any_mass: true,
        keeps_energy: true,
    };
    /// None of them.
    pub const NONE: Self = Self {
        switches_effects: false,
        geometric_stiffening: false,
        large_deflection: false,
        drives: false,
        reactions: false,
        any_mass: false,
        keeps_energy: false,
    };
}
