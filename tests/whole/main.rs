//! The program and its library as users meet them. One program, so that it is linked once and no core waits for the last
//! test of each file.

mod advise;
mod alone;
mod bodies;
mod body;
mod campbell;
mod children;
mod command_line;
mod cost;
mod examples;
mod export;
mod failures;
mod fmu;
mod html_report;
mod import;
mod library;
mod matrices;
mod memory;
mod new_scene;
mod newcomer;
mod outputs;
mod peak_memory;
mod reactions;
mod rows;
mod scene_input;
mod slepc;
mod spin_up;
mod sweep;
mod threads;
mod warnings;
