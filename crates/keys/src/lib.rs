#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod hash;
mod key;

pub use hash::{Digest, Hash, HashedReader};
pub use key::{Key, Keyed};
