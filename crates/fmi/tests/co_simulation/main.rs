//! FMUs as an importing program meets them, by the functions of the standard.

mod bad_input;
mod forked;
mod importer;
mod runs;
mod scenes;
mod states;
