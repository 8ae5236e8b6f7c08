//! The full body against closed forms, and what a check says of states that are wrong by a known amount.

mod check;
mod fixtures;
mod rest;
