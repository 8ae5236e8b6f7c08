//! The conservative form and its schemes, the limit of the paper's scheme, and step control, through [`Simulation`].
//!
//! [`Simulation`]: dynamics::Simulation

#[allow(dead_code)] // shared with the other test programs, which use all of it
#[path = "../common/mod.rs"]
mod common;

mod balance;
mod checkpoint;
mod control;
mod dalembert;
mod limits;
mod modes;
mod order;
mod own_loads;
mod pulse;
mod reaction;
mod rigid;
mod rows;
mod run;
mod table;
