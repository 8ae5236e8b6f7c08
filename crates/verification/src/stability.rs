//! Hard cases: why they are hard, what every scheme makes of them, and the bound that a test holds it to.
//!
//! A [`HardCase`] is run by the tests at [`Extent::Test`] and by the study, which writes `docs/evidence/stability.md`, at
//! [`Extent::Study`]: the same bounds, longer runs.

pub mod bodies;
mod case;
pub mod mesh;
pub mod meshes;
pub mod motion;
pub mod page;
pub mod structure;
pub mod systems;
pub mod time;
pub mod trial;

pub use case::{BOUNDED, BodyFigure, Bound, Extent, HardCase, TrialOutcome};

/// The cases with their headings.
pub fn sections() -> [(&'static str, Vec<HardCase>); 4] {
    [
        ("Motion", motion::cases()),
        ("Time", time::cases()),
        ("Structure", structure::cases()),
        ("Mesh and material", mesh::cases()),
    ]
}
