//! The text of a scene: its files, the places in it, and how structs are filled from it.

pub(crate) mod assign;
pub(crate) mod deserialize;
pub(crate) mod example;
pub(crate) mod files;
pub(crate) mod name;
pub(crate) mod ordinary_file;
pub(crate) mod place;
pub(crate) mod points;
pub(crate) mod shape;
pub(crate) mod shorten;
pub(crate) mod suggest;
