//! Advice against what happens.

mod influence;
mod limits;
mod plate;
mod review;
mod rows;
