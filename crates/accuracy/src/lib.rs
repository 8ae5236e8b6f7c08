//! `docs/evidence/accuracy.md`: what accuracy costs on some scenes, from measured runs.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod page;
mod spin;

pub use page::accuracy_page;
