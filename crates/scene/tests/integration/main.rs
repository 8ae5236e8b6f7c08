//! The scene file: what is read, what is refused, and what becomes of damaged and hostile ones. One program, so that it is
//! linked once and no core waits for the last test of each file.

mod common;
mod damage;
mod parts;
mod reading;
mod refusals;
mod robustness;
mod schema;
mod systems;
mod tables;
mod ties;
