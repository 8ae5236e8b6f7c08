//! Systems of bodies that joints tie together.
//!
//! Each body keeps its conservative form, Eqs. (C1)–(C7); the rows of the joints hold markers of the bodies together by
//! multipliers, Eqs. (J1)–(J8) of `docs/method/systems.md`.

pub(crate) mod collocation;
pub(crate) mod connections;
pub(crate) mod constraints;
pub(crate) mod description;
pub(crate) mod element;
pub(crate) mod elimination;
mod frame;
pub(crate) mod geometry;
mod invariants;
pub(crate) mod joint;
pub(crate) mod marker;
pub(crate) mod radau;
mod reactions;
pub(crate) mod relaxed;
pub(crate) mod run;
mod saved;
pub(crate) mod stage;
