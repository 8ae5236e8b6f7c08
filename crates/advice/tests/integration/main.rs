//! Advice against what happens.

mod completed;
mod influence;
mod limits;
mod plate;
mod review;
mod rows;
