#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod answers;
mod binary;
mod engine;
mod error;
mod folder;
mod help;
mod json;
mod run;
mod stop;

pub use engine::Slepc;
pub use folder::{files_of_folder, write_folder};
pub use stop::Stop;
