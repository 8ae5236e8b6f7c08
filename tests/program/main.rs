//! The program and its library as users meet them. One program, so that it is linked once and no core waits for the last
//! test of each file.

mod commands;
mod documentation;
mod examples;
mod golden;
mod inputs;
mod library;
mod linear;
mod program;
mod runs;
mod slepc;
