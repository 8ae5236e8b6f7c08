//! Readers of our own: decks of Abaqus, CalculiX and Nastran, universal files, and what they share.

pub(crate) mod abaqus;
pub(crate) mod deck;
pub(crate) mod nastran;
pub(crate) mod notes;
mod systems;
mod tetrahedra;
mod texts;
pub(crate) mod universal;
