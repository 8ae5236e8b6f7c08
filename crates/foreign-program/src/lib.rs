#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod error;
mod guard;
mod lines;
mod ordinary;
mod program;
mod running;
mod shell;

pub use error::ProgramError;
pub use lines::Stream;
pub use ordinary::{open_ordinary, read_at_most};
pub use program::{ForeignProgram, Limits, named};
pub use shell::shell_word;
